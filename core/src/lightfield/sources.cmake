list(APPEND core_sources src/lightfield/develop.cpp)
