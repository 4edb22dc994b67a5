list(APPEND core_kernels src/render/backward_kernel.inl.h src/render/pixel_row_kernel.inl.h
  src/render/radiance_table_kernel.inl.h)
list(APPEND core_sources src/render/backward.cpp src/render/backward_tile.cpp src/render/backward_rows.cpp src/render/backward_pairs.cpp src/render/render.cpp
  src/render/beam_bounds.cpp src/render/channel_sum.cpp src/render/bundle_collisions.cpp src/render/phase_function.cpp src/render/scatter_walk.cpp src/render/lit_region.cpp
  src/render/pixel_beams.cpp src/render/microlens_patch.cpp
  src/render/scene_beams.cpp src/render/radiance_table.cpp src/render/rounds.cpp src/render/sample_plan.cpp src/render/run_control.cpp src/render/aperture_cone.cpp
  src/render/ground_truth.cpp
  src/render/emission_proposal.cpp src/render/forward.cpp src/render/ray_paths.cpp
  src/render/ray_path_file.cpp src/render/describe.cpp src/render/ray_path_tracer.cpp
  src/render/ray_selection.cpp
  src/render/benchmark.cpp src/render/benchmark_reference.cpp
  src/render/scene_medium.cpp src/render/medium_segments.cpp src/render/surface_light.cpp
  src/render/worth_levels.cpp
  src/render/backward_surfaces.cpp src/render/forward_surfaces.cpp src/render/forward_scatter.cpp
  src/render/endless_planes.cpp
  src/render/pattern_images.cpp)
