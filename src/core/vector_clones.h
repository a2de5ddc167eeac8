#pragma once

// For loops over plain arrays, outside the kernels, that are worth wide vectors. Nothing is contracted or
// reordered (castray_flags of CMakeLists.txt), so that every instruction set makes the same bytes.

/// Before a function: it is compiled for several instruction sets, with all that it can inline, and the best
/// one that the processor has is called. Not where sanitizers need functions that are found without a choice.
#if defined(__clang__) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CASTRAY_VECTOR_CLONES
#else
#define CASTRAY_VECTOR_CLONES \
  [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), gnu::flatten]]
#endif
