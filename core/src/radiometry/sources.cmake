list(APPEND core_sources
  src/radiometry/channel_mix.cpp src/radiometry/absorption_spectrum.cpp
  src/radiometry/emission_line.cpp
  src/radiometry/gauss_legendre.cpp
  src/radiometry/gauss_rule.cpp
  src/radiometry/source_function.cpp
  src/radiometry/spectral_nodes.cpp
  src/radiometry/spectral_points.cpp
  src/radiometry/spectral_response.cpp
  src/radiometry/two_colour.cpp)
