#pragma once

#include <string>

namespace castray::cli {

/// What a command that has ended left behind.
struct ProcessResult {
  int exit_code = 0;       ///< 128 + signal if one ended it
  double seconds = 0;      ///< from start to end
  std::string output;      ///< all of its standard output
  std::string last_error;  ///< the last line of its standard error that is not blank
};

/// The exit code in a status of `wait`: 128 + signal if one ended the process.
int exit_code_of(int status);

/// Runs `command` by the shell and waits for it.
ProcessResult run_command(const std::string& command);

}  // namespace castray::cli
