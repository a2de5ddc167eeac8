#include "cli/interrupt.h"

#include <signal.h>

namespace castray::cli {

namespace {

volatile sig_atomic_t noted = 0;

extern "C" void note_signal(int) { noted = 1; }

}  // namespace

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = note_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return noted != 0; }

}  // namespace castray::cli
