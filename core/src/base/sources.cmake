list(APPEND core_sources src/base/error.cpp src/base/execution.cpp src/base/isa.cpp)
