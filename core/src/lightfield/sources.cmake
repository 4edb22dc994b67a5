list(APPEND core_sources src/lightfield/develop.cpp src/lightfield/micro_images.cpp src/lightfield/refocus.cpp
  src/lightfield/view_resampling.cpp src/lightfield/views.cpp)
