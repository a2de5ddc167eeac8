#include "cli/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>

namespace castray::cli {

namespace {

ssize_t write_or_drop(void*, const char* text, std::size_t size) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t written = ::write(STDERR_FILENO, text + done, size - done);
    if (written < 0 && errno != EINTR) break;
    if (written > 0) done += static_cast<std::size_t>(written);
  }
  return static_cast<ssize_t>(size);
}

void fill_closed() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF)  // what is asked for on stdout must still fail
      if (::open("/dev/null", stream == STDOUT_FILENO ? O_RDONLY : O_RDWR) < 0) std::_Exit(2);
}

}  // namespace

void guard_standard_streams() {
  fill_closed();
  std::signal(SIGPIPE, [](int) {});  // no SIG_IGN, which the programs that are started would inherit
  if (FILE* const messages = fopencookie(nullptr, "w", {nullptr, write_or_drop, nullptr, nullptr})) {
    std::setvbuf(messages, nullptr, _IONBF, 0);
    stderr = messages;
  }
}

void end_by_closed_pipe() {
  std::signal(SIGPIPE, SIG_DFL);
  std::raise(SIGPIPE);
  std::abort();
}

}  // namespace castray::cli
