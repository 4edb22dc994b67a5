#include "camera/block_tracing.h"

#include <algorithm>
#include <string>

#include "base/isa_dispatch.h"
#include "optics/reflection.h"
#include "optics/surface_kinds.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

template <class Real>
KernelSurface<Real> kernel_surface(double gap, double curvature, double diameter, double before,
                                   double behind) {
  return {static_cast<Real>(gap), static_cast<Real>(curvature),
          static_cast<Real>(0.25 * diameter * diameter), static_cast<Real>(before / behind),
          static_cast<Real>((behind - before) * (behind + before) / (behind * behind))};
}

template <class Real>
KernelCoating<Real> kernel_coating(const Coating& coating) {
  return {static_cast<Real>(coating.before), static_cast<Real>(coating.layer),
          static_cast<Real>(coating.behind), static_cast<Real>(coating.phase)};
}

/// @param last z of the last reference plane
template <class Real>
void set_distortion(const LensDistortion& distortion, double last, KernelDistortion<Real>& out) {
  static_assert(kDistortionSteps == LensDistortion::kSteps);
  if (!distortion.present()) return;
  const DistortionSpec& spec = distortion.spec();
  const double limit = distortion.limit();
  out = {true,
         static_cast<Real>(distortion.pupil() - last),
         static_cast<Real>(distortion.per_distance()),
         static_cast<Real>(spec.k1),
         static_cast<Real>(spec.k2),
         static_cast<Real>(spec.k3),
         static_cast<Real>(spec.p1),
         static_cast<Real>(spec.p2),
         static_cast<Real>(limit * limit)};
}

template <class Real>
void set_main_lens(const Camera& camera, double reference, double anchor_z,
                   KernelCamera<Real>& out) {
  out.ideal_lens = camera.ideal_lens();
  if (out.ideal_lens) {
    const IdealLens& lens = camera.ideal();
    out.ideal = {static_cast<Real>(lens.rear_principal - reference),
                 static_cast<Real>(lens.front_principal - lens.rear_principal),
                 static_cast<Real>(1.0 / lens.focal_length),
                 static_cast<Real>(lens.stop_height),
                 static_cast<Real>(lens.stop_slope),
                 static_cast<Real>(lens.stop_radius * lens.stop_radius)};
    out.exit_gap = static_cast<Real>(anchor_z - lens.rear_principal);
    set_distortion(camera.distortion(), lens.rear_principal, out.distortion);
    out.per_stop_radius = static_cast<Real>(1 / lens.stop_radius);
    return;
  }
  const auto& surfaces = camera.lens().surfaces();
  if (surfaces.size() > kMaxLensSurfaces)
    throw InputError("camera.lens has " + std::to_string(surfaces.size()) + " surfaces; at most " +
                     std::to_string(kMaxLensSurfaces) + " are supported");
  const TransmissionSpec& transmission = camera.spec().transmission;
  out.fresnel = transmission.fresnel;
  const AntiReflection layer{transmission.coating_index, transmission.coating_wavelength,
                             camera.spec().wavelength};
  double z = reference;
  out.surface_count = static_cast<int>(surfaces.size());
  for (int k = 0; k < out.surface_count; ++k) {
    const auto i = surfaces.size() - 1 - static_cast<std::size_t>(k);
    const double vertex = camera.lens().vertices()[i];
    const double before = surfaces[i].index, behind = i > 0 ? surfaces[i - 1].index : 1.0;
    const double curvature = -1.0 / surfaces[i].radius;
    out.surfaces[k] =
        kernel_surface<Real>(vertex - z, curvature, surfaces[i].diameter, before, behind);
    out.shapes[k] = kernel_shape<Real>(surfaces[i], true);
    out.refracts[k] = curvature != 0 || before != behind;
    out.surface_number[k] = static_cast<int>(i);
    if (surfaces[i].stop) {
      out.stop = k;
      out.per_stop_radius = static_cast<Real>(2 / surfaces[i].diameter);
    }
    out.coatings[k] = kernel_coating<Real>(coating_of(layer, before, behind));
    z = vertex;
  }
  out.exit_gap = static_cast<Real>(anchor_z - z);
  set_distortion(camera.distortion(), z, out.distortion);
}

template <class Real>
KernelPolygon<Real> kernel_polygon(const MicrolensAperture& aperture) {
  static_assert(MicrolensAperture::kMostPairs == kMostSidePairs);
  KernelPolygon<Real> polygon{};
  polygon.pairs = aperture.pairs();
  for (int k = 0; k < aperture.pairs(); ++k) {
    polygon.normal_x[k] = static_cast<Real>(aperture.normal(k).x);
    polygon.normal_y[k] = static_cast<Real>(aperture.normal(k).y);
    polygon.half_width[k] = static_cast<Real>(aperture.half_width(k));
  }
  return polygon;
}

template <class Real>
void set_matrix(const Mat3& matrix, Real (&out)[9]) {
  for (std::size_t i = 0; i < 3; ++i) {
    out[3 * i] = static_cast<Real>(matrix.rows[i].x);
    out[3 * i + 1] = static_cast<Real>(matrix.rows[i].y);
    out[3 * i + 2] = static_cast<Real>(matrix.rows[i].z);
  }
}

}  // namespace

template <class Real>
KernelCamera<Real> kernel_camera(const Camera& camera, Vec3 anchor, const RigidTransform& axes) {
  KernelCamera<Real> kernel{};
  const Vec3 reference{0, 0, camera.has_array() ? camera.array_front() : camera.aim_plane(0)};
  Mat3 out = axes.rotation;
  if (camera.lens_moved()) {
    // Rays enter the lens frame in front of the lens. Behind it they leave this frame and the
    // camera frame in one step.
    const RigidTransform to_lens = camera.lens_pose().inverse();
    kernel.moved = true;
    set_matrix(to_lens.rotation, kernel.lens_turn);
    const Vec3 shift = to_lens.point(reference) - reference;
    kernel.lens_shift[0] = static_cast<Real>(shift.x);
    kernel.lens_shift[1] = static_cast<Real>(shift.y);
    kernel.lens_shift[2] = static_cast<Real>(shift.z);
    anchor = to_lens.point(anchor);
    out = out * camera.lens_pose().rotation;
  }
  set_main_lens(camera, reference.z, anchor.z, kernel);
  kernel.anchor_x = static_cast<Real>(anchor.x);
  kernel.anchor_y = static_cast<Real>(anchor.y);
  set_matrix(out, kernel.rotation);
  return kernel;
}

template <class Real>
void set_tilt(const Camera& camera, int type, Vec2 place, KernelMicrolens<Real>& kernel) {
  const Mat3& turn = camera.array_pose().rotation;
  kernel.tilted = true;
  set_matrix(transpose(turn), kernel.turn);
  // The array's aim plane is the image of turn * (x, y, aim - front), about the middle of its
  // front.
  const double back = camera.aim_plane(type) - camera.array_front();
  const Vec3 normal{turn.rows[0].z, turn.rows[1].z, turn.rows[2].z};
  const double depth = (back - normal.x * place.x - normal.y * place.y) / normal.z;
  kernel.distance = static_cast<Real>(camera.array_front() + depth - camera.sensor());
  kernel.front = static_cast<Real>(-back);
  kernel.depth = static_cast<Real>(depth);
}

template <class Real>
void set_lens(const Camera& camera, LensIndex lens, KernelMicrolens<Real>& kernel) {
  const double factor = camera.lattice().focal_factor(lens);
  if (factor != 1) {
    const auto power = static_cast<Real>(1 / factor);
    kernel.ideal.power *= power;
    for (KernelSurface<Real>& surface : kernel.surfaces) surface.curvature *= power;
  }
  const Vec3 place = camera.lens_place(lens);
  if (camera.array_tilted())
    set_tilt(camera, camera.lattice().type(lens), {place.x, place.y}, kernel);
}

template <class Real>
std::vector<KernelMicrolens<Real>> kernel_microlenses(const Camera& camera) {
  std::vector<KernelMicrolens<Real>> lenses;
  const TransmissionSpec& transmission = camera.spec().transmission;
  const auto cover = static_cast<Real>(transmission.cover_index > 1 ? transmission.cover_index : 0);
  if (!camera.has_array()) {
    KernelMicrolens<Real> none{};
    none.distance = static_cast<Real>(camera.aim_plane(0) - camera.sensor());
    none.cover_index = cover;
    lenses.push_back(none);
    return lenses;
  }
  const ArraySpec& array = camera.spec().array;
  const double diameter = 2 * camera.aperture().radius();
  const int main_surfaces = camera.surface_count() - (camera.ideal_array() ? 1 : 2);
  for (std::size_t type = 0; type < camera.microlenses().size(); ++type) {
    const Microlens& lens = camera.microlenses()[type];
    KernelMicrolens<Real> kernel{};
    kernel.aperture = kernel_polygon<Real>(camera.aperture());
    kernel.distance = static_cast<Real>(camera.aim_plane(static_cast<int>(type)) - camera.sensor());
    kernel.cover_index = cover;
    if (camera.ideal_array()) {
      kernel.kind = 2;
      // From here on z counts from the front of the array, as for real microlenses.
      kernel.ideal = {0,
                      static_cast<Real>(lens.front_principal - camera.array_front()),
                      static_cast<Real>(1.0 / lens.first_order.focal_length),
                      1,
                      0,
                      static_cast<Real>(0.25 * diameter * diameter)};
      kernel.surface_number[0] = main_surfaces;
    } else {
      kernel.kind = 1;
      kernel.surfaces[0] =
          kernel_surface<Real>(0, 1.0 / lens.radius_back, diameter, 1.0, lens.index);
      kernel.surfaces[1] = kernel_surface<Real>(array.thickness, -1.0 / lens.radius_front, diameter,
                                                lens.index, 1.0);
      kernel.fresnel = transmission.fresnel;
      kernel.coatings[0] = kernel_coating<Real>(coating_of({}, 1.0, lens.index));
      kernel.coatings[1] = kernel_coating<Real>(coating_of({}, lens.index, 1.0));
      kernel.surface_number[0] = main_surfaces + 1;
      kernel.surface_number[1] = main_surfaces;
    }
    lenses.push_back(kernel);
  }
  return lenses;
}

template <class Real>
CameraKernels<Real> camera_kernels(Isa isa) {
  PLENOFLAME_DISPATCH(isa,
                      return {kernels::pass_microlens, kernels::trace_lens, kernels::count_alive};)
}

template CameraKernels<float> camera_kernels<float>(Isa isa);
template CameraKernels<double> camera_kernels<double>(Isa isa);
template KernelCamera<float> kernel_camera(const Camera&, Vec3, const RigidTransform&);
template KernelCamera<double> kernel_camera(const Camera&, Vec3, const RigidTransform&);
template void set_tilt(const Camera&, int, Vec2, KernelMicrolens<float>&);
template void set_tilt(const Camera&, int, Vec2, KernelMicrolens<double>&);
template void set_lens(const Camera&, LensIndex, KernelMicrolens<float>&);
template void set_lens(const Camera&, LensIndex, KernelMicrolens<double>&);
template std::vector<KernelMicrolens<float>> kernel_microlenses(const Camera&);
template std::vector<KernelMicrolens<double>> kernel_microlenses(const Camera&);

}  // namespace plenoflame
