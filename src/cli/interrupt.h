#pragma once

namespace castray::cli {

/// From now on SIGINT and SIGTERM are only noted; a second one ends the program at once.
void catch_interrupts();

/// Whether one came.
bool interrupted();

}  // namespace castray::cli
