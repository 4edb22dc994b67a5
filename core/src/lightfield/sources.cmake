list(APPEND core_sources src/lightfield/colour.cpp src/lightfield/develop.cpp src/lightfield/geometry.cpp src/lightfield/ground_truth.cpp src/lightfield/micro_images.cpp src/lightfield/micro_image_pixels.cpp src/lightfield/micro_image_white.cpp
  src/lightfield/pyrometry.cpp src/lightfield/pixel_bins.cpp src/lightfield/refocus.cpp src/lightfield/refocus_sums.cpp src/lightfield/sensor.cpp src/lightfield/smoothed_error.cpp src/lightfield/view_resampling.cpp src/lightfield/view_grid.cpp src/lightfield/pupil_views.cpp src/lightfield/views.cpp
  src/lightfield/export/array_formats.cpp src/lightfield/export/export.cpp src/lightfield/export/hdf5_file.cpp
  src/lightfield/export/json_formats.cpp src/lightfield/export/npz_file.cpp
  src/lightfield/export/view_formats.cpp src/lightfield/export/xml_formats.cpp)
list(APPEND core_kernels src/lightfield/micro_image_kernel.inl.h)
