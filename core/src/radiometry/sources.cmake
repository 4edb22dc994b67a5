list(APPEND core_sources src/radiometry/gauss_legendre.cpp src/radiometry/source_function.cpp)
