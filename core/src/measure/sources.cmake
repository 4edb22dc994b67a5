list(APPEND core_sources src/measure/pupil_pyrometry.cpp src/measure/sensor_frames.cpp src/measure/temperatures.cpp
  src/measure/two_colour_light.cpp)
