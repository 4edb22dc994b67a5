# plenoflame_kernels(TARGET a_kernel.inl.h ...) compiles each kernel once per instruction set, in
# namespace plenoflame::PLENOFLAME_ISA (baseline, avx2, avx512), so that no inline function built
# for one processor can be linked into code for another. A kernel file includes only
# <cmath>-free headers of its own (see docs/developer/architecture.md).
function(plenoflame_kernels target)
  set(common -O3 -fno-trapping-math -fopenmp-simd)
  if(PLENOFLAME_SANITIZE)
    list(TRANSFORM common REPLACE -O3 -O1)  # minutes of optimising checks
  endif()
  set(flags_baseline "")
  set(flags_avx2 -march=x86-64-v3)
  set(flags_avx512 -march=x86-64-v4 -mprefer-vector-width=512)
  set(isas baseline)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    list(APPEND isas avx2 avx512)
  endif()
  foreach(kernel ${ARGN})
    get_filename_component(path "${kernel}" ABSOLUTE)
    get_filename_component(stem "${kernel}" NAME)
    string(REPLACE ".inl.h" "" stem "${stem}")
    foreach(isa ${isas})
      set(wrapper "${CMAKE_CURRENT_BINARY_DIR}/kernels/${stem}_${isa}.cpp")
      file(CONFIGURE OUTPUT "${wrapper}" CONTENT
        "#define PLENOFLAME_ISA ${isa}\n#include \"${path}\"\n")
      set_source_files_properties("${wrapper}" PROPERTIES
        COMPILE_OPTIONS "${common};${flags_${isa}}" OBJECT_DEPENDS "${path}"
        SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
      target_sources(${target} PRIVATE "${wrapper}")
    endforeach()
  endforeach()
endfunction()
