list(APPEND core_sources src/optics/first_order.cpp src/optics/lens_system.cpp)
