list(APPEND core_sources src/sampling/sobol.cpp)
