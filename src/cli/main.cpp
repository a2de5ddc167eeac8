#include <fmt/core.h>

#include <csignal>
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
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond `ulimit -f` fails as on a full disk
  try {
    return castray::cli::parse_command_line(argc, argv)();
  } catch (const std::bad_alloc&) {
    return fail("out of memory; a smaller image or scene is needed");
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}
