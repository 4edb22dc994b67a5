list(APPEND core_sources src/optics/first_order.cpp src/optics/lens_system.cpp
  src/optics/asphere.cpp src/optics/glass.cpp src/optics/reflection.cpp)
