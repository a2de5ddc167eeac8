#include <fmt/core.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "cli/command_line.h"
#include "cli/stack_size.h"
#include "cli/standard_streams.h"
#include "core/text.h"

namespace {

constexpr const char* out_of_memory =
    "out of memory; a smaller image or scene, or a higher --memory-limit is needed";

/// Threads may run out of memory where no exception can leave them.
[[noreturn]] void terminate() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "castray: error: %s\n", out_of_memory);
    std::_Exit(2);
  } catch (...) {
  }
  std::abort();
}

}  // namespace

int main(int argc, char** argv) {
  const auto fail = [](const char* message) {
    fmt::print(stderr, "castray: error: {}\n", castray::printable(message, std::string::npos));
    return 2;
  };
  const auto fail_output = [&] {
    if (errno == EPIPE) castray::cli::end_by_closed_pipe();
    return fail(("standard output: cannot be written: " + std::string(std::strerror(errno))).c_str());
  };
  castray::cli::guard_standard_streams();
  std::set_terminate(terminate);
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond `ulimit -f` fails as on a full disk
  try {
    castray::cli::check_stack_size();
    const int code = castray::cli::parse_command_line(argc, argv)();
    if (std::fflush(stdout) != 0 || std::ferror(stdout)) return fail_output();
    return code;
  } catch (const std::bad_alloc&) {
    return fail(out_of_memory);
  } catch (const std::exception& error) {
    if (std::ferror(stdout)) return fail_output();
    return fail(error.what());
  }
}
