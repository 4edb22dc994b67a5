list(APPEND core_sources src/optics/f_number.cpp src/optics/first_order.cpp src/optics/lens_system.cpp
  src/optics/aspheric_terms.cpp src/optics/surface_kinds.cpp src/optics/glass.cpp src/optics/reflection.cpp
  src/optics/window_body.cpp src/optics/window_set.cpp)
