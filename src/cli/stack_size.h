#pragma once

namespace castray::cli {

/// Throws InputError if the stacks of threads, of which `ulimit -s` and OMP_STACKSIZE decide, are too small
/// to render with: a crash would be the only other sign.
void check_stack_size();

}  // namespace castray::cli
