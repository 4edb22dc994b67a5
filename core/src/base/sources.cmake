list(APPEND core_sources src/base/available_memory.cpp src/base/error.cpp src/base/execution.cpp)
list(APPEND core_sources src/base/isa.cpp src/base/part.cpp src/base/printable.cpp src/base/progress_share.cpp src/base/report.cpp src/base/setting_names.cpp src/base/units.cpp)
list(APPEND core_sources src/base/version.cpp)
set_source_files_properties(src/base/version.cpp PROPERTIES
  COMPILE_DEFINITIONS "PLENOFLAME_VERSION=\"${PROJECT_VERSION}\"")
