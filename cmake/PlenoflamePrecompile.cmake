# Most of the processor time of a build from nothing goes into headers that nearly every file includes. A target with precompiled
# headers reads them once. `./test.sh --all` builds without them, since they hide a missing include.
option(PLENOFLAME_PRECOMPILE "Precompile the headers that most files include" ON)

# plenoflame_precompile(TARGET HEADER...): headers of the standard library, and the given ones. Sources whose options differ from those
# of TARGET need the property SKIP_PRECOMPILE_HEADERS.
# plenoflame_precompile(TARGET REUSE_FROM OTHER): those of another target, whose options are the same.
function(plenoflame_precompile target)
  if(NOT PLENOFLAME_PRECOMPILE)
    return()
  endif()
  set(headers ${ARGN})
  if(NOT ARGV1 STREQUAL "REUSE_FROM")
    list(PREPEND headers PRIVATE <algorithm> <array> <cmath> <cstdint> <functional> <limits> <map> <memory> <mutex> <numeric>
      <optional> <set> <span> <sstream> <stdexcept> <string> <string_view> <thread> <tuple> <utility> <variant> <vector>)
  endif()
  target_precompile_headers(${target} ${headers})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # The compiler cache wants the first; GCC 12 takes inlined std::string of a precompiled header for an overflow.
    target_compile_options(${target} PRIVATE -fpch-preprocess -Wno-array-bounds -Wno-stringop-overread)
    if(NOT PLENOFLAME_COMPILE_TOGETHER)
      target_compile_options(${target} PRIVATE -Wno-stringop-overflow -Wno-restrict)  # the same, file by file
    endif()
  endif()
endfunction()
