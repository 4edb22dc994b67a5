list(APPEND core_sources src/media/voxel_lattice.cpp src/media/voxel_medium.cpp)
list(APPEND core_kernels src/media/voxel_kernel.inl.h)
