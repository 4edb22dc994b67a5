list(APPEND core_sources src/film/compare.cpp src/film/film.cpp src/film/checkpoint.cpp src/film/error_bound.cpp src/film/image_sums.cpp src/film/reopened.cpp)
