list(APPEND core_kernels src/camera/camera_kernel.inl.h)
list(APPEND core_sources src/camera/pupil/aperture_discs.cpp src/camera/pupil/aperture_sides.cpp src/camera/pupil/explored_pupil.cpp src/camera/microlens_aperture.cpp src/camera/pupil/pupil_filters.cpp src/camera/microlens_lattice.cpp src/camera/camera.cpp src/camera/trace_from_scene.cpp src/camera/lens_distortion.cpp
  src/camera/design/design.cpp src/camera/design/focus.cpp src/camera/pupil/pupil_sampling.cpp src/camera/pupil/pupil_field.cpp
  src/camera/pupil/bare_pupil.cpp src/camera/pupil/passing_edge.cpp src/camera/design/resolution.cpp
  src/camera/design/array_solver.cpp src/camera/block_tracing.cpp src/camera/pupil/pupil_cut.cpp
  src/camera/pupil/pupil_tracer.cpp src/camera/pupil/pupil_outline.cpp src/camera/pupil/widen_cuts.cpp src/camera/pupil/stop_landing.cpp
  src/camera/design/camera_merit.cpp src/camera/design/lens_design.cpp src/camera/sensor_levels.cpp
  src/camera/design/window_design.cpp)
list(APPEND core_sources src/camera/import/camera_import.cpp src/camera/import/grid_import.cpp
  src/camera/import/libpleno_import.cpp src/camera/import/optics_import.cpp src/camera/import/hdf5_import.cpp)
