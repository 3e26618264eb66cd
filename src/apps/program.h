// What every command-line program of the package does alike: an error is one line on stderr and
// exit code 1.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <string>

namespace racecar_mcl {

inline int reportError(const std::string& program, std::string what) {
  std::replace(what.begin(), what.end(), '\n', ' ');
  std::cerr << program << ": error: " << what << std::endl;
  return 1;
}

/// Parses the command line and runs `run()`.
template <typename Run>
int runProgram(CLI::App& app, int argc, char** argv, Run&& run) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    return reportError(app.get_name(), std::string(error.what()) + "; see --help");
  }
  try {
    run();
  } catch (const std::exception& error) {
    return reportError(app.get_name(), error.what());
  }
  return 0;
}

}  // namespace racecar_mcl
