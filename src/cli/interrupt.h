#pragma once

namespace castray::cli {

/// From here on SIGINT, SIGTERM and SIGHUP are only noted; a second one ends the program at once. A SIGHUP
/// that is ignored, as under nohup, stays ignored.
void catch_interrupts();

/// What the second signal writes to stderr before it ends the program: `text`, of static storage, or null.
void write_when_killed(const char* text);

/// Whether one came.
bool interrupted();

/// From here on SIGUSR1 is only noted.
void catch_snapshot_requests();

/// Whether one came since the last call.
bool snapshot_requested();

}  // namespace castray::cli
