#pragma once

namespace castray::cli {

/// Makes messages and closed streams harmless, before anything is written: what stderr cannot take, as on a
/// full disk or behind a closed pipe, is dropped, for that is no reason to lose an image; a stream that is
/// closed gets /dev/null, so that no output file takes its number; and a closed pipe is an error of the write
/// to it.
void guard_standard_streams();

/// Ends the process as a closed pipe at its standard output does by default: silently.
[[noreturn]] void end_by_closed_pipe();

}  // namespace castray::cli
