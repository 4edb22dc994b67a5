list(APPEND core_sources src/film/compare.cpp)
