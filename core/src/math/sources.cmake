list(APPEND core_sources src/math/vector.cpp)
