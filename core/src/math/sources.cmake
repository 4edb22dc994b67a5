list(APPEND core_sources src/math/ray_span.cpp src/math/readable.cpp src/math/vector.cpp)
