#include "cli/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cstring>

namespace castray::cli {

namespace {

volatile sig_atomic_t interrupt_noted = 0, snapshot_noted = 0;

std::atomic<const char*> last_words = nullptr;
static_assert(std::atomic<const char*>::is_always_lock_free);

extern "C" void note_interrupt(int signal) {
  if (interrupt_noted) {
    const char* text = last_words;
    if (text && write(STDERR_FILENO, text, std::strlen(text)) < 0) _exit(128 + signal);
    ::signal(signal, SIG_DFL);
    raise(signal);
  }
  interrupt_noted = 1;
}
extern "C" void note_snapshot(int) { snapshot_noted = 1; }

void handle(int signal, void (*note)(int)) {
  struct sigaction action = {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

bool is_ignored(int signal) {
  struct sigaction action = {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

void catch_interrupts() {
  handle(SIGINT, note_interrupt);
  handle(SIGTERM, note_interrupt);
  if (!is_ignored(SIGHUP)) handle(SIGHUP, note_interrupt);
}

void write_when_killed(const char* text) { last_words = text; }

bool interrupted() { return interrupt_noted != 0; }

void catch_snapshot_requests() { handle(SIGUSR1, note_snapshot); }

bool snapshot_requested() {
  const bool noted = snapshot_noted != 0;
  snapshot_noted = 0;
  return noted;
}

}  // namespace castray::cli
