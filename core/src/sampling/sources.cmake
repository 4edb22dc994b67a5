list(APPEND core_sources src/sampling/directions.cpp src/sampling/noise.cpp src/sampling/sobol.cpp)
