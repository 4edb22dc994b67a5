# The desktop application's files: read by the program's own CMakeLists.txt and by tests/desktop_qt6.
set(desktop_model_sources
  model/jobs/coarse_picture.cpp
  model/jobs/design_job.cpp
  model/document.cpp
  model/example_flames.cpp
  model/eye_view.cpp
  model/jobs/flame_cache.cpp
  model/flame_glow.cpp
  model/flame_look.cpp
  model/jobs/flame_sampler.cpp
  model/image_display.cpp
  model/key_relevance.cpp
  model/jobs/latest_task.cpp
  model/jobs/lens_job.cpp
  model/jobs/light_field_jobs.cpp
  model/jobs/measured_picture.cpp
  model/parameter_model.cpp
  model/jobs/ray_selector.cpp
  model/jobs/reconstruct_job.cpp
  model/recovery.cpp
  model/jobs/render_job.cpp
  model/scene_changes.cpp
  model/jobs/scene_compiler.cpp
  model/scene_target.cpp
  model/scene_values.cpp
  model/schematic.cpp
  model/session.cpp
  model/undo_history.cpp)
set(desktop_widget_sources
  widgets/window/beside_window.cpp
  widgets/image/axes_frame.cpp
  widgets/scene/camera_body.cpp
  widgets/image/colour_bar.cpp
  widgets/window/compare_window.cpp
  widgets/panels/design_panel.cpp
  widgets/window/file_tasks.cpp
  widgets/window/film_dialog.cpp
  widgets/flame/flame_dialogs.cpp
  widgets/flame/flame_look_editor.cpp
  widgets/flame/flame_opacity.cpp
  widgets/flame/flame_panel.cpp
  widgets/controls/file_chooser.cpp
  widgets/controls/flow_layout.cpp
  widgets/controls/glyphs.cpp
  widgets/window/help_window.cpp
  widgets/image/image_panel.cpp
  widgets/image/image_panel_measured.cpp
  widgets/image/image_view.cpp
  widgets/window/import_dialog.cpp
  widgets/window/lens_window.cpp
  widgets/image/light_field_panel.cpp
  widgets/window/main_window.cpp
  widgets/window/main_window_files.cpp
  widgets/window/main_window_menus.cpp
  widgets/window/main_window_session.cpp
  widgets/window/main_window_tour.cpp
  widgets/controls/notice.cpp
  widgets/flame/opacity_curve.cpp
  widgets/controls/plot_widget.cpp
  widgets/controls/side_panel.cpp
  widgets/window/poster_dialog.cpp
  widgets/window/preferences_dialog.cpp
  widgets/scene/eye_layer.cpp
  widgets/scene/ray_lines.cpp
  widgets/panels/rays_panel.cpp
  widgets/panels/reconstruct_panel.cpp
  widgets/panels/render_panel.cpp
  widgets/image/ruler.cpp
  widgets/image/scale_bar.cpp
  widgets/scene/lens_detail.cpp
  widgets/scene/scene_geometry.cpp
  widgets/scene/scene_labels.cpp
  widgets/panels/scene_panel.cpp
  widgets/panels/slices_page.cpp
  widgets/scene/scene_view.cpp
  widgets/scene/scene_view_aim.cpp
  widgets/scene/scene_view_light.cpp
  widgets/scene/scene_view_move.cpp
  widgets/scene/scene_view_tools.cpp
  widgets/scene/section_view.cpp
  widgets/controls/theme.cpp
  widgets/controls/time_bar.cpp
  widgets/controls/tool_row.cpp
  widgets/window/tour_dialog.cpp
  widgets/window/view_commands.cpp
  widgets/window/welcome_page.cpp)
# With macros of VTK in them.
set(desktop_vtk_sources widgets/window/beside_window.cpp widgets/flame/flame_opacity.cpp widgets/image/image_view.cpp widgets/window/main_window_menus.cpp widgets/scene/camera_body.cpp widgets/scene/eye_layer.cpp widgets/scene/ray_lines.cpp
  widgets/image/ruler.cpp widgets/scene/lens_detail.cpp widgets/scene/scene_geometry.cpp widgets/scene/scene_view.cpp
  widgets/image/scale_bar.cpp widgets/scene/scene_labels.cpp widgets/scene/scene_view_aim.cpp widgets/scene/scene_view_light.cpp widgets/scene/scene_view_move.cpp widgets/scene/scene_view_tools.cpp)
set(desktop_vtk_folders "${PROJECT_SOURCE_DIR}/app/vtk/module" "${PROJECT_SOURCE_DIR}/app/vtk/views")
set(desktop_vtk_libraries Plenoflame::Views Plenoflame::VTK VTK::FiltersCore VTK::InteractionStyle VTK::InteractionWidgets
  VTK::RenderingAnnotation VTK::RenderingCore VTK::RenderingOpenGL2)
set(desktop_definitions PLENOFLAME_DOC_FOLDER="../${CMAKE_INSTALL_DATAROOTDIR}/doc/plenoflame-doc/docs"
  PLENOFLAME_SOURCE_DOCS="${PROJECT_SOURCE_DIR}/docs")
