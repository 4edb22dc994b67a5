list(APPEND core_sources src/sampling/noise.cpp src/sampling/sobol.cpp)
