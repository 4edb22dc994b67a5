list(APPEND core_sources src/calibration/count_frames.cpp src/calibration/raw_import.cpp src/calibration/even_factors.cpp src/calibration/radiometry_table.cpp src/calibration/radiometry_fit.cpp
  src/calibration/lattice_guess.cpp src/calibration/micro_image_fit.cpp src/calibration/lattice_model.cpp
  src/calibration/white_lattice.cpp src/calibration/array_fit.cpp)
list(APPEND core_sources src/calibration/geometry_calibration.cpp src/calibration/geometry_fit.cpp
  src/calibration/geometry_start.cpp src/calibration/white_radii.cpp
  src/calibration/geometry_errors.cpp src/calibration/geometry_known.cpp src/calibration/free_values.cpp src/calibration/registration.cpp
  src/calibration/board_marks.cpp src/calibration/board_views.cpp src/calibration/board_plane.cpp
  src/calibration/board_corners.cpp src/calibration/camera_rig.cpp)
