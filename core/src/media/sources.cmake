list(APPEND core_sources src/media/absorption_factors.cpp src/media/brightened_medium.cpp src/media/composite_medium.cpp src/media/field_reader.cpp
  src/media/layered_medium.cpp src/media/voxels/lattice_walk.cpp src/media/voxels/majorant_grid.cpp
  src/media/medium.cpp src/media/medium_samples.cpp src/media/source_fit.cpp src/media/transfer.cpp src/media/uniform_medium.cpp
  src/media/voxels/voxel_lattice.cpp src/media/voxels/voxel_medium.cpp src/media/voxels/voxel_steps.cpp)
list(APPEND core_kernels src/media/layered_kernel.inl.h src/media/voxels/voxel_kernel.inl.h src/media/voxels/interval_kernel.inl.h)
