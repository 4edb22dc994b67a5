list(APPEND core_sources src/image/array_set.cpp src/image/atomic_file.cpp src/image/exr_stream.cpp
  src/image/jpeg_picture.cpp src/image/light_field.cpp src/image/open_file.cpp src/image/png_file.cpp src/image/staging_folder.cpp
  src/image/text_file.cpp src/image/tiff_file.cpp src/image/tiff_pages.cpp src/image/raw_picture.cpp src/image/picture_arrays.cpp src/image/hdf5_picture.cpp
  src/image/mat_picture.cpp src/image/lytro_picture.cpp)
