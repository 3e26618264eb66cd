// main() of the command-line programs. Errors are reported in one line on stderr, with exit code 1.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>

#include "racecar_mcl/common/printable.h"

namespace racecar_mcl {

inline int reportError(const std::string& program, std::string what) {
  std::replace(what.begin(), what.end(), '\n', ' ');
  what = withoutControlCharacters(what);
  std::cerr << program << ": error: " << what << std::endl;
  return 1;
}

/// Parses the command line into the options declared by `add_options` and calls run(options).
/// Returns the exit code.
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
    if (!std::cout.flush() || std::fflush(stdout) != 0) {
      throw std::runtime_error("the standard output cannot be written; is the disk full?");
    }
  } catch (const std::exception& error) {
    return reportError(name, error.what());
  }
  return 0;
}

}  // namespace racecar_mcl
