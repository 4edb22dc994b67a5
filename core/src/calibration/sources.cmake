list(APPEND core_sources src/calibration/count_frames.cpp src/calibration/raw_import.cpp)
list(APPEND core_sources src/calibration/radiometry_table.cpp)
