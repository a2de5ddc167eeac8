#include "cli/interrupt.h"

#include <signal.h>

namespace castray::cli {

namespace {

volatile sig_atomic_t interrupt_noted = 0, snapshot_noted = 0;

extern "C" void note_interrupt(int) { interrupt_noted = 1; }
extern "C" void note_snapshot(int) { snapshot_noted = 1; }

void handle(int signal, void (*note)(int), unsigned flags) {
  struct sigaction action = {};
  action.sa_handler = note;
  action.sa_flags = static_cast<int>(flags | SA_RESTART);
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

bool is_ignored(int signal) {
  struct sigaction action = {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

void catch_interrupts() {
  handle(SIGINT, note_interrupt, SA_RESETHAND);
  handle(SIGTERM, note_interrupt, SA_RESETHAND);
  if (!is_ignored(SIGHUP)) handle(SIGHUP, note_interrupt, SA_RESETHAND);
}

bool interrupted() { return interrupt_noted != 0; }

void catch_snapshot_requests() { handle(SIGUSR1, note_snapshot, 0); }

bool snapshot_requested() {
  const bool noted = snapshot_noted != 0;
  snapshot_noted = 0;
  return noted;
}

}  // namespace castray::cli
