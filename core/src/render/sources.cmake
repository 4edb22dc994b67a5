list(APPEND core_kernels src/render/sampling/backward_kernel.inl.h src/render/visibility/pixel_row_kernel.inl.h
  src/render/tracer/radiance_table_kernel.inl.h src/render/transport/window_wall_kernel.inl.h)
list(APPEND core_sources src/render/estimators/backward.cpp src/render/tracer/pixel_sampler.cpp src/render/tracer/radiance_integrator.cpp src/render/tracer/path_integrator.cpp src/render/transport/camera_aim.cpp src/render/transport/world_paths.cpp src/render/visibility/window_displacement.cpp src/render/transport/medium_behind_windows.cpp src/render/merge.cpp src/render/merge_plan.cpp src/render/tracer/film_sums.cpp src/render/paths/ray_stream.cpp
  src/render/visibility/camera_front.cpp src/render/run/check_settings.cpp src/render/tracer/ray_generator.cpp src/render/tracer/camera_tracer.cpp src/render/sampling/sensor_blur.cpp
  src/render/forward/forward_pixels.cpp src/render/estimators/render.cpp
  src/render/visibility/beam_bounds.cpp src/render/transport/channel_sum.cpp src/render/forward/bundle_collisions.cpp src/render/transport/phase_function.cpp src/render/transport/scatter_walk.cpp src/render/visibility/occupied_region.cpp
  src/render/visibility/pixel_beams.cpp src/render/sampling/microlens_frame.cpp
  src/render/visibility/scene_beams.cpp src/render/tracer/radiance_table.cpp src/render/estimators/rounds.cpp src/render/estimators/rank_tiles.cpp src/render/serve_render.cpp src/render/run/sample_plan.cpp src/render/run/run_control.cpp src/render/run/run_progress.cpp src/render/estimators/render_request.cpp src/render/visibility/aperture_cone.cpp
  src/render/paths/ground_truth.cpp
  src/render/transport/emission_proposal.cpp src/render/estimators/exposure.cpp src/render/forward/forward.cpp src/render/paths/ray_paths.cpp
  src/render/paths/ray_path_file.cpp src/render/paths/ray_path_npz.cpp src/render/paths/point_images.cpp src/render/paths/projections.cpp src/render/estimators/describe.cpp src/render/paths/ray_path_tracer.cpp
  src/render/paths/ray_selection.cpp src/render/paths/ray_path_request.cpp
  src/render/estimators/benchmark.cpp src/render/estimators/benchmark_reference.cpp
  src/render/transport/scene_medium.cpp src/render/transport/medium_segments.cpp src/render/transport/surface_light.cpp
  src/render/sampling/worth_levels.cpp src/render/work_counters.cpp
  src/render/tracer/backward_surfaces.cpp src/render/forward/forward_surfaces.cpp src/render/forward/forward_scatter.cpp
  src/render/visibility/endless_planes.cpp
  src/render/paths/pattern_images.cpp)
