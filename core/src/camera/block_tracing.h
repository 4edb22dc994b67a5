#pragma once
#include <vector>

#include "camera/camera_kernel.h"
#include "plenoflame/base/isa.h"
#include "plenoflame/camera/camera.h"

namespace plenoflame {

/// Entry points of the camera's kernels for one instruction set.
template <class Real>
struct CameraKernels {
  void (*pass_microlens)(const KernelMicrolens<Real>&, Real lens_x, Real lens_y, int first,
                         int count, const KernelBlock<Real>&);
  void (*trace_lens)(const KernelCamera<Real>&, int count, const KernelBlock<Real>&);
  int (*count_alive)(const int* code, const Real* weight, int count);
};

template <class Real>
CameraKernels<Real> camera_kernels(Isa isa);

/// The main lens as the kernels trace it. Rays end in the plane of the anchor. Their positions are
/// relative to it, along axes that result from turning the camera's axes by `axes`.
/// @param anchor [m] camera frame
/// @throws InputError when the lens has more surfaces than the kernels hold
template <class Real>
KernelCamera<Real> kernel_camera(const Camera& camera, Vec3 anchor, const RigidTransform& axes);

/// Tilts the kernel of a type with the array. @param place of its middle in the aim plane, camera
/// x, y
template <class Real>
void set_tilt(const Camera& camera, int type, Vec2 place, KernelMicrolens<Real>& kernel);

/// Turns the kernel of a type into the kernel of one lens of an array with tolerances, with its own
/// focal length, place and tilt.
template <class Real>
void set_lens(const Camera& camera, LensIndex lens, KernelMicrolens<Real>& kernel);

/// One kernel for each type of microlens; without array a single one of kind 0.
template <class Real>
std::vector<KernelMicrolens<Real>> kernel_microlenses(const Camera& camera);

}  // namespace plenoflame
