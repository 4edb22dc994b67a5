list(APPEND core_sources
  src/scene/cameras.cpp
  src/scene/channel_kinds.cpp
  src/scene/compile.cpp
  src/scene/files/file_series.cpp
  src/scene/design_report.cpp
  src/scene/glass_indices.cpp
  src/scene/imported_camera.cpp
  src/scene/files/input_files.cpp
  src/scene/files/lens_import.cpp
  src/scene/files/lens_file.cpp
  src/scene/files/zmx_import.cpp
  src/scene/schema/nearest.cpp
  src/scene/files/parse_toml.cpp
  src/scene/files/position_map.cpp
  src/scene/files/presets.cpp
  src/scene/pupil_transmission.cpp
  src/scene/schema/scene_differences.cpp
  src/scene/files/scene_reader.cpp
  src/scene/schema/scene_settings.cpp
  src/scene/schema/scene_schema.cpp
  src/scene/files/scene_writer.cpp
  src/scene/files/settings_file.cpp
  src/scene/schema/schema_markdown.cpp
  src/scene/schema/schema_table.cpp src/scene/schema/schema_tables.cpp
  src/scene/spectral.cpp
  src/scene/files/sweep_rules.cpp src/scene/files/sweep_table.cpp
  src/scene/files/time_table.cpp
  src/scene/timeline.cpp
  src/scene/files/toml_guard.cpp
  src/scene/validation/validate.cpp
  src/scene/validation/validate_camera.cpp
  src/scene/validation/validate_channels.cpp
  src/scene/validation/validate_flames.cpp
  src/scene/validation/validate_lines.cpp
  src/scene/validation/validate_microlenses.cpp
  src/scene/validation/validate_pupil_filters.cpp
  src/scene/validation/validate_surfaces.cpp
  src/scene/validation/validate_time.cpp
  src/scene/validation/validate_windows.cpp)

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
configure_file("${CMAKE_CURRENT_SOURCE_DIR}/src/scene/files/preset_table.cpp.in"
  "${CMAKE_CURRENT_BINARY_DIR}/preset_table.cpp" @ONLY)
list(APPEND core_sources "${CMAKE_CURRENT_BINARY_DIR}/preset_table.cpp")
