list(APPEND core_kernels src/camera/camera_kernel.inl.h)
list(APPEND core_sources src/camera/microlens_lattice.cpp src/camera/camera.cpp src/camera/trace_from_scene.cpp
  src/camera/design.cpp src/camera/focus.cpp src/camera/pupil_sampling.cpp src/camera/pupil_field.cpp
  src/camera/bare_pupil.cpp src/camera/passing_edge.cpp src/camera/resolution.cpp
  src/camera/array_solver.cpp src/camera/block_tracing.cpp src/camera/pupil_cut.cpp
  src/camera/pupil_tracer.cpp src/camera/pupil_outline.cpp src/camera/widen_cuts.cpp src/camera/stop_landing.cpp
  src/camera/camera_merit.cpp src/camera/lens_design.cpp)
