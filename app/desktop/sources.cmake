# What the desktop application is made of: read by the program's own CMakeLists.txt and by tests/desktop_qt6.
set(desktop_model_sources
  model/coarse_picture.cpp
  model/colour_map.cpp
  model/design_job.cpp
  model/document.cpp
  model/flame_cache.cpp
  model/flame_glow.cpp
  model/flame_look.cpp
  model/flame_sampler.cpp
  model/image_display.cpp
  model/key_relevance.cpp
  model/latest_task.cpp
  model/lens_job.cpp
  model/light_field_jobs.cpp
  model/measured_picture.cpp
  model/parameter_model.cpp
  model/ray_selector.cpp
  model/reconstruct_job.cpp
  model/recovery.cpp
  model/render_job.cpp
  model/scene_changes.cpp
  model/scene_compiler.cpp
  model/scene_target.cpp
  model/schematic.cpp
  model/session.cpp
  model/undo_history.cpp)
set(desktop_widget_sources
  widgets/beside_window.cpp
  widgets/colour_bar.cpp
  widgets/compare_window.cpp
  widgets/design_panel.cpp
  widgets/file_tasks.cpp
  widgets/film_dialog.cpp
  widgets/flame_dialogs.cpp
  widgets/flame_look_editor.cpp
  widgets/flame_opacity.cpp
  widgets/flame_panel.cpp
  widgets/flow_layout.cpp
  widgets/glyphs.cpp
  widgets/help_window.cpp
  widgets/image_panel.cpp
  widgets/image_panel_measured.cpp
  widgets/image_view.cpp
  widgets/import_dialog.cpp
  widgets/lens_window.cpp
  widgets/light_field_panel.cpp
  widgets/main_window.cpp
  widgets/main_window_files.cpp
  widgets/main_window_menus.cpp
  widgets/main_window_session.cpp
  widgets/main_window_tour.cpp
  widgets/notice.cpp
  widgets/opacity_curve.cpp
  widgets/plot_widget.cpp
  widgets/preferences_dialog.cpp
  widgets/ray_lines.cpp
  widgets/rays_panel.cpp
  widgets/reconstruct_panel.cpp
  widgets/render_panel.cpp
  widgets/ruler.cpp
  widgets/scale_bar.cpp
  widgets/scene_geometry.cpp
  widgets/scene_labels.cpp
  widgets/scene_panel.cpp
  widgets/scene_view.cpp
  widgets/scene_view_aim.cpp
  widgets/scene_view_light.cpp
  widgets/scene_view_move.cpp
  widgets/scene_view_tools.cpp
  widgets/section_view.cpp
  widgets/theme.cpp
  widgets/time_bar.cpp
  widgets/tour_dialog.cpp
  widgets/view_commands.cpp
  widgets/welcome_page.cpp)
# With macros of VTK in them.
set(desktop_vtk_sources widgets/beside_window.cpp widgets/flame_opacity.cpp widgets/image_view.cpp widgets/main_window_menus.cpp widgets/ray_lines.cpp
  widgets/ruler.cpp widgets/scene_geometry.cpp widgets/scene_view.cpp
  widgets/scale_bar.cpp widgets/scene_labels.cpp widgets/scene_view_aim.cpp widgets/scene_view_light.cpp widgets/scene_view_move.cpp widgets/scene_view_tools.cpp)
set(desktop_vtk_folders "${PROJECT_SOURCE_DIR}/app/vtk/module" "${PROJECT_SOURCE_DIR}/app/vtk/views")
set(desktop_vtk_libraries Plenoflame::Views Plenoflame::VTK VTK::FiltersCore VTK::InteractionStyle VTK::InteractionWidgets
  VTK::RenderingAnnotation VTK::RenderingCore)
set(desktop_definitions PLENOFLAME_DOC_FOLDER="../${CMAKE_INSTALL_DATAROOTDIR}/doc/plenoflame-doc/docs"
  PLENOFLAME_SOURCE_DOCS="${PROJECT_SOURCE_DIR}/docs")
