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

/// A program's main(): parses the command line into the options that `add_options` declares, and
/// calls run(options). Returns the exit code.
template <typename Options, typename Run>
int runProgram(int argc, char** argv, const std::string& name, const std::string& description,
               void (*add_options)(Options*, CLI::App*), Run&& run) {
  Options options;
  CLI::App app(description, name);
  add_options(&options, &app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    return reportError(name, std::string(error.what()) + "; see --help");
  }
  try {
    run(options);
  } catch (const std::exception& error) {
    return reportError(name, error.what());
  }
  return 0;
}

}  // namespace racecar_mcl
