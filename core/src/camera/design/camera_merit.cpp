#include "plenoflame/camera/camera_merit.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/camera/resolution.h"

namespace plenoflame {
namespace {

constexpr int kDepthSteps = 600;

double depth_merit(const Camera& camera, const MeritSpec& spec) {
  const auto types = design_types(camera);
  const double pixel = camera.spec().sensor.pixel_pitch, diameter = camera.spec().array.diameter;
  const double from = 1 / spec.array_far, to = 1 / spec.array_near;
  double sum = 0;
  for (int i = 0; i < kDepthSteps; ++i) {
    const double vergence = from + (to - from) * (i + 0.5) / kDepthSteps;
    double least = kInfinity;
    for (const TypeDesign& type : types)
      least = std::min(
          least,
          diameter * std::fabs(type.sensor_distance * (1 / type.focal_length - vergence) - 1));
    const double beyond = std::max(0.0, least / pixel - 1);
    sum += beyond * beyond;
  }
  return -sum / kDepthSteps;
}

/// Effective resolution of the best type at one object distance.
class Resolution {
 public:
  Resolution(const Camera& camera, bool traced) : camera_(camera), types_(design_types(camera)) {
    if (traced)
      for (std::size_t k = 0; k < types_.size(); ++k) tracers_.emplace_back(camera, k);
  }
  double operator()(double distance) const {
    const double pixel = camera_.spec().sensor.pixel_pitch;
    const double diameter = camera_.spec().array.diameter;
    const double image = paraxial_image_distance(camera_.lens_first_order(), distance);
    double best = 0;
    for (std::size_t k = 0; k < types_.size(); ++k) {
      const double a = camera_.rear_vertex() - image - camera_.microlenses()[k].front_principal;
      double ratio = effective_resolution(types_[k], diameter, pixel, a);
      if (!tracers_.empty()) {
        const double traced = traced_resolution(tracers_[k](distance), pixel);
        ratio = std::isnan(traced) ? 0 : traced;
      }
      // Nearer than the total covering plane, some types do not see every point.
      const double depth = std::fabs(a) / types_[k].sensor_distance;
      best = std::max(best, ratio * std::min(1.0, depth / 2));
    }
    return best;
  }

 private:
  const Camera& camera_;
  std::vector<TypeDesign> types_;
  std::vector<BlurTracer> tracers_;
};

}  // namespace

double merit(const Camera& camera, const MeritSpec& spec, bool traced) {
  if (!camera.has_array()) throw InputError("a camera without microlens array has no such merit");
  if (spec.kind == MeritKind::depth) return depth_merit(camera, spec);
  if (spec.kind == MeritKind::light) {
    const FirstOrder& lens = camera.lens_first_order();
    const double number =
        std::isfinite(lens.exit_pupil)
            ? (camera.exit_pupil() - camera.array_front()) / lens.exit_pupil_diameter
            : lens.focal_length / lens.entrance_pupil_diameter;
    return 3.14159265358979323846 / (4 * number * number + 1);
  }
  const Resolution resolution(camera, traced);
  const SensorSpec& sensor = camera.spec().sensor;
  double least = kInfinity;
  for (int i = 0; i < spec.depths; ++i) {
    const double share = spec.depths > 1 ? static_cast<double>(i) / (spec.depths - 1) : 0.5;
    const double distance = spec.near + (spec.far - spec.near) * share;
    double value = resolution(distance);
    if (spec.kind == MeritKind::volume) {
      const double image =
          spec.height * std::fabs(paraxial_magnification(camera.lens_first_order(), distance));
      // The flame may stand along the longer side.
      const double room = std::max(sensor.size().x, sensor.size().y);
      const double seen = std::min(1.0, room / image);
      value *= image * seen / sensor.pixel_pitch * seen * seen;
    }
    least = std::min(least, value);
  }
  return least;
}

double overlap_pixels(const Camera& camera) {
  const double pupil = camera.exit_pupil();
  const double scale =
      std::isfinite(pupil) ? (pupil - camera.sensor()) / (pupil - camera.array_back()) : 1;
  double widest = 0;
  for (const TypeDesign& type : design_types(camera))
    widest = std::max(widest, type.image_diameter);
  return (widest - camera.spec().array.pitch * scale) / camera.spec().sensor.pixel_pitch;
}

CameraSpec changed_camera(const CameraSpec& camera, const CameraChange& change) {
  CameraSpec result = camera;
  ArraySpec& array = result.array;
  array.pitch *= change.pitch;
  array.diameter *= change.pitch;
  array.pitch_y *= change.pitch;
  array.diameter_y *= change.pitch;
  array.sensor_distance *= change.sensor_distance;
  result.lens.diameter *= change.aperture;
  for (SurfaceSpec& surface : result.lens.surfaces)
    if (surface.stop) surface.diameter *= change.aperture;
  result.focus.object_distance *= change.object_distance;
  result.focus.lens_distance *= change.object_distance;
  for (std::size_t k = 0; k < change.focal_lengths.size() && k < array.types.size(); ++k) {
    MicrolensSpec& type = array.types[k];
    if (type.focal_length != 0) {
      type.focal_length = change.focal_lengths[k];
      continue;
    }
    const MicrolensShape shape =
        solve_microlens({type.radius_front, type.radius_back, type.index, array.thickness},
                        change.focal_lengths[k], array.diameter, change.freedom, change.limits);
    type.radius_front = shape.radius_front;
    type.radius_back = shape.radius_back;
    if (type.index != shape.index) type.glass.clear();
    type.index = shape.index;
    if (change.freedom == MicrolensFreedom::thickness)
      throw InputError("all microlens types have the same thickness: free is index or radius");
  }
  return result;
}

}  // namespace plenoflame
