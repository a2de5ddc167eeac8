# src/*/*_lanes.cpp is compiled once per instruction set, each into a namespace of its own (src/simd/isa_lanes.h).
set(CASTRAY_ISA_scalar "")
set(CASTRAY_ISA_sse4 -msse4.2 -mpopcnt)
set(CASTRAY_ISA_avx2 -mavx2 -mfma -mbmi -mbmi2 -mlzcnt -mpopcnt)
set(CASTRAY_ISA_avx512 ${CASTRAY_ISA_avx2} -mavx512f -mavx512bw -mavx512vl -mavx512dq)

set(CASTRAY_ISAS scalar sse4 avx2 avx512 CACHE STRING
  "Instruction sets to compile the kernels for; native: this machine's best one, and scalar")

# castray_native_isas(RESULT): scalar, and the best set of the processor that builds.
function(castray_native_isas result)
  file(STRINGS /proc/cpuinfo flags LIMIT_COUNT 1 REGEX "^flags")
  set(best "")
  if(flags MATCHES " avx512f" AND flags MATCHES " avx512bw" AND flags MATCHES " avx512vl" AND flags MATCHES " avx512dq")
    set(best avx512)
  elseif(flags MATCHES " avx2" AND flags MATCHES " fma" AND flags MATCHES " bmi2")
    set(best avx2)
  elseif(flags MATCHES " sse4_2")
    set(best sse4)
  endif()
  set(${result} scalar ${best} PARENT_SCOPE)
endfunction()

set(isas ${CASTRAY_ISAS})
if(isas STREQUAL native)
  castray_native_isas(isas)
endif()
message(STATUS "castray: kernels for ${isas}")

file(GLOB CASTRAY_KERNEL_SOURCES CONFIGURE_DEPENDS src/*/*_lanes.cpp)
foreach(isa scalar sse4 avx2 avx512)
  if(NOT isa IN_LIST isas)
    set_property(SOURCE src/wavefront/choose_kernel.cpp APPEND PROPERTY COMPILE_DEFINITIONS CASTRAY_KERNEL_${isa}=nullptr)
    continue()
  endif()
  add_library(castray_kernels_${isa} OBJECT ${CASTRAY_KERNEL_SOURCES})
  target_include_directories(castray_kernels_${isa} PRIVATE include src)
  # GCC 12 takes the undefined operands inside its own AVX-512 header for ours; and vectors that no function here passes
  # to another set have no ABI to keep.
  target_compile_options(castray_kernels_${isa} PRIVATE ${CASTRAY_ISA_${isa}}
    $<$<CONFIG:Release>:-O3> -Wno-psabi $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-uninitialized>)
  target_link_libraries(castray_kernels_${isa} PRIVATE castray_flags)
  target_precompile_headers(castray_kernels_${isa} PRIVATE <immintrin.h>)  # half of what a small kernel takes to compile
  target_sources(castray PRIVATE $<TARGET_OBJECTS:castray_kernels_${isa}>)
  set_property(SOURCE src/wavefront/choose_kernel.cpp APPEND PROPERTY COMPILE_DEFINITIONS
    CASTRAY_KERNEL_${isa}=castray::${isa}::kernel_api)
endforeach()
