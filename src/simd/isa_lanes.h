#pragma once

// Names the instruction set that this translation unit is compiled for. Every src/*/*_lanes.cpp is compiled
// once per set (cmake/kernels.cmake), with all that the _lanes.h headers hold in a namespace of its own: no
// inline function or global is shared, as the linker may keep the copy of a newer set and hand it to an older
// processor.

#if defined(__AVX512F__)
#define CASTRAY_ISA avx512
#define CASTRAY_WIDTH 16
#elif defined(__AVX2__)
#define CASTRAY_ISA avx2
#define CASTRAY_WIDTH 8
#elif defined(__SSE4_2__)
#define CASTRAY_ISA sse4
#define CASTRAY_WIDTH 4
#else
#define CASTRAY_ISA scalar
#define CASTRAY_WIDTH 1
#endif

/// For functions of a few lane vectors.
#define CASTRAY_INLINE inline __attribute__((always_inline))
/// For templates that work on a whole wave or tile: one copy a kernel, however many callers.
#define CASTRAY_STAGE __attribute__((noinline))
