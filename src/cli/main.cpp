#include <fmt/core.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "cli/command_line.h"
#include "core/text.h"

int main(int argc, char** argv) {
  const auto fail = [](const char* message) {
    fmt::print(stderr, "castray: error: {}\n", castray::printable(message, std::string::npos));
    return 2;
  };
  const auto fail_output = [&] {
    return fail(("standard output: cannot be written: " + std::string(std::strerror(errno))).c_str());
  };
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond `ulimit -f` fails as on a full disk
  try {
    const int code = castray::cli::parse_command_line(argc, argv)();
    if (std::fflush(stdout) != 0 || std::ferror(stdout)) return fail_output();
    return code;
  } catch (const std::bad_alloc&) {
    return fail("out of memory; a smaller image or scene is needed");
  } catch (const std::exception& error) {
    if (std::ferror(stdout)) return fail_output();
    return fail(error.what());
  }
}
