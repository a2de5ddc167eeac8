# src/*/*_lanes.cpp is compiled once per instruction set, each into a namespace of its own (src/simd/isa_lanes.h).
# GCC 12 gets vectors of one element wrong from -O2 on: the statistical tests of the scalar kernels fail.
set(CASTRAY_OPTIMISE_scalar -O1)
foreach(isa sse4 avx2 avx512)
  set(CASTRAY_OPTIMISE_${isa} -O3)
endforeach()
set(CASTRAY_ISA_scalar "")
set(CASTRAY_ISA_sse4 -msse4.2 -mpopcnt)
set(CASTRAY_ISA_avx2 -mavx2 -mfma -mbmi -mbmi2 -mlzcnt -mpopcnt)
set(CASTRAY_ISA_avx512 ${CASTRAY_ISA_avx2} -mavx512f -mavx512bw -mavx512vl -mavx512dq)

set(CASTRAY_ISAS scalar sse4 avx2 avx512 CACHE STRING "Instruction sets to compile the kernels for")

file(GLOB CASTRAY_KERNEL_SOURCES CONFIGURE_DEPENDS src/*/*_lanes.cpp)
foreach(isa IN LISTS CASTRAY_ISAS)
  add_library(castray_kernels_${isa} OBJECT ${CASTRAY_KERNEL_SOURCES})
  target_include_directories(castray_kernels_${isa} PRIVATE include src)
  # GCC 12 takes the undefined operands inside its own AVX-512 header for ours; and vectors that no function here passes
  # to another set have no ABI to keep.
  target_compile_options(castray_kernels_${isa} PRIVATE ${CASTRAY_ISA_${isa}}
    $<$<CONFIG:Release>:${CASTRAY_OPTIMISE_${isa}}> -Wno-psabi $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-uninitialized>)
  target_link_libraries(castray_kernels_${isa} PRIVATE castray_flags)
  target_sources(castray PRIVATE $<TARGET_OBJECTS:castray_kernels_${isa}>)
  set_property(SOURCE src/simd/isa.cpp APPEND PROPERTY COMPILE_DEFINITIONS CASTRAY_HAS_${isa})
endforeach()
