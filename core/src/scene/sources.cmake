list(APPEND core_sources
  src/scene/compile.cpp
  src/scene/glass_indices.cpp
  src/scene/input_files.cpp
  src/scene/lens_import.cpp
  src/scene/lens_file.cpp
  src/scene/zmx_import.cpp
  src/scene/nearest.cpp
  src/scene/position_map.cpp
  src/scene/presets.cpp
  src/scene/scene_reader.cpp
  src/scene/scene_schema.cpp
  src/scene/scene_writer.cpp
  src/scene/schema_markdown.cpp
  src/scene/schema_table.cpp src/scene/schema_tables.cpp
  src/scene/spectral.cpp
  src/scene/toml_guard.cpp
  src/scene/validate.cpp
  src/scene/validate_camera.cpp
  src/scene/validate_channels.cpp
  src/scene/validate_flames.cpp
  src/scene/validate_lines.cpp
  src/scene/validate_surfaces.cpp)

# The presets stay readable as scene files and are compiled in as text.
set(preset_rows)
foreach(kind camera flame lens)
  set(plural s)
  if(kind STREQUAL lens)
    set(plural es)
  endif()
  file(GLOB preset_files CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/presets/${kind}${plural}/*.toml")
  foreach(preset_file ${preset_files})
    get_filename_component(preset_name "${preset_file}" NAME_WE)
    file(READ "${preset_file}" preset_text)
    string(APPEND preset_rows
      "    {PresetKind::${kind}, \"${preset_name}\", R\"PRESET(${preset_text})PRESET\"},\n")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${preset_file}")
  endforeach()
endforeach()
configure_file("${CMAKE_CURRENT_SOURCE_DIR}/src/scene/preset_table.cpp.in"
  "${CMAKE_CURRENT_BINARY_DIR}/preset_table.cpp" @ONLY)
list(APPEND core_sources "${CMAKE_CURRENT_BINARY_DIR}/preset_table.cpp")
