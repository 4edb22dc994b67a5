#include "plenoflame/camera/lens_design.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "plenoflame/base/error.h"
#include "plenoflame/camera/design.h"

namespace plenoflame {
namespace {

constexpr int kFanRays = 41, kFigureRings = 24, kFigureSpokes = 36;

/// Rays of one object point through a lens.
class FieldTracer {
 public:
  FieldTracer(const std::vector<SurfaceSpec>& surfaces, const FirstOrder& lens,
              double object_distance, double image_plane, double field)
      : system_(surfaces),
        lens_(lens),
        object_distance_(object_distance),
        image_(system_.vertices().back() - image_plane),
        slope_(std::tan(field)) {
    find_chief();
  }

  struct Arrival {
    Vec2 at;     ///< [m] in the image plane
    Vec2 slope;  ///< per metre towards the sensor
  };

  /// Traces a ray through a point of the plane of the entrance pupil.
  std::optional<Arrival> arrive(Vec2 pupil) const {
    Ray ray = from(pupil);
    if (ray.direction.z >= 0 || system_.trace_to_sensor(ray).status != RayStatus::reached)
      return std::nullopt;
    const Vec2 slope{-ray.direction.x / ray.direction.z, -ray.direction.y / ray.direction.z};
    const double distance = ray.origin.z - image_;
    return Arrival{{ray.origin.x + distance * slope.x, ray.origin.y + distance * slope.y}, slope};
  }

  /// The place where the chief ray crosses the plane of the paraxial entrance pupil.
  double chief() const { return chief_; }
  bool has_chief() const { return arrive({chief_, 0}).has_value(); }

 private:
  Ray from(Vec2 pupil) const {
    const double z = -lens_.entrance_pupil;
    const Vec3 target{pupil.x, pupil.y, z};
    if (!std::isinf(object_distance_)) {
      // Light that is imaged at +x comes from an object at -x.
      const Vec3 object{-slope_ * (object_distance_ - z), 0, object_distance_};
      return {object, normalize(target - object)};
    }
    const Vec3 direction = normalize({slope_, 0, -1});
    const double back = (std::max(0.0, z) + lens_.length + std::fabs(z)) / -direction.z;
    return {target - back * direction, direction};
  }

  /// Height at the stop of the ray through `pupil`, also if the ray is vignetted.
  std::optional<double> at_stop(double pupil) const {
    std::vector<SurfaceSpec> open = system_.surfaces();
    for (SurfaceSpec& surface : open) surface.diameter = kInfinity;
    Ray ray = from({pupil, 0});
    std::vector<Vec3> path;
    const TraceStatus status = LensSystem(open).trace_to_sensor(ray, &path);
    const auto stop = static_cast<std::size_t>(lens_.stop);
    if (path.size() <= stop ||
        (status.status != RayStatus::reached && status.surface <= lens_.stop))
      return std::nullopt;
    return path[stop].x;
  }

  /// Finds the ray through the middle of the stop by the secant method.
  void find_chief() {
    double a = 0, b = 1e-3 * lens_.entrance_pupil_diameter;
    auto at_a = at_stop(a), at_b = at_stop(b);
    for (int i = 0; i < 30 && at_a && at_b && *at_a != *at_b; ++i) {
      const double next = b - *at_b * (b - a) / (*at_b - *at_a);
      a = b, at_a = at_b;
      b = next, at_b = at_stop(b);
      if (at_b && std::fabs(*at_b) < 1e-14 * lens_.entrance_pupil_diameter) break;
    }
    chief_ = at_b ? b : a;
  }

  LensSystem system_;
  const FirstOrder& lens_;
  double object_distance_, image_, slope_, chief_ = 0;
};

/// Area [m^2] of the cells of a square grid over the pupil's plane whose rays pass.
double open_area(const FieldTracer& tracer, double pupil) {
  constexpr int kGrid = 40;
  const double reach = 1.3 * pupil, step = 2 * reach / kGrid;
  int through = 0;
  for (int i = 0; i < kGrid; ++i)
    for (int j = 0; j < kGrid / 2; ++j)  // mirror symmetry
      if (tracer.arrive({tracer.chief() - reach + (i + 0.5) * step, (j + 0.5) * step})) ++through;
  return 2 * through * step * step;
}

LensFieldDesign design_field(const FieldTracer& tracer, const LensDesign& lens, double field,
                             double axis_area) {
  LensFieldDesign result;
  result.field = field;
  const double pupil = 0.5 * lens.lens.entrance_pupil_diameter;
  const auto chief = tracer.arrive({tracer.chief(), 0});
  if (!chief)
    throw InputError("no light gets through the lens at a field angle of " +
                     std::to_string(field * 180 / constants::pi) + " deg; choose a smaller one");
  result.image_height = chief->at.x;
  // The paraxial image in this plane. It gives the chief ray's height at the image and its slope
  // behind the exit pupil.
  const double paraxial = paraxial_image_distance(lens.lens, lens.object_distance);
  const double m = std::isinf(lens.object_distance)
                       ? lens.lens.focal_length
                       : -paraxial_magnification(lens.lens, lens.object_distance) *
                             (lens.object_distance + lens.lens.entrance_pupil);
  const double height = m * std::tan(field);
  const double scaled = std::isfinite(lens.lens.exit_pupil)
                            ? height * (lens.image_distance - lens.lens.exit_pupil) /
                                  (paraxial - lens.lens.exit_pupil)
                            : height;
  result.distortion = field == 0 ? 0 : result.image_height / scaled - 1;
  result.throughput = open_area(tracer, pupil) / axis_area;
  const double narrow = 1e-4 * pupil;
  if (const auto up = tracer.arrive({tracer.chief() + narrow, 0}))
    result.tangential = -(up->at.x - chief->at.x) / (up->slope.x - chief->slope.x);
  if (const auto aside = tracer.arrive({tracer.chief(), narrow}))
    result.sagittal = -aside->at.y / aside->slope.y;
  for (int i = 0; i < kFanRays; ++i) {
    const double p = -1 + 2.0 * i / (kFanRays - 1);
    if (const auto ray = tracer.arrive({tracer.chief() + p * pupil, 0}))
      result.tangential_fan.push_back({p, ray->at.x - chief->at.x});
    if (const auto ray = tracer.arrive({tracer.chief(), p * pupil}))
      result.sagittal_fan.push_back({p, ray->at.y});
  }
  double n = 0;
  Vec2 sum{};
  double squares = 0;
  for (int ring = 0; ring < kFigureRings; ++ring)
    for (int spoke = 0; spoke < kFigureSpokes; ++spoke) {
      const double r = pupil * std::sqrt((ring + 0.5) / kFigureRings);
      const double angle = 2 * constants::pi * (spoke + 0.5 * (ring % 2)) / kFigureSpokes;
      const auto ray = tracer.arrive({tracer.chief() + r * std::cos(angle), r * std::sin(angle)});
      if (!ray) continue;
      const Vec2 at = ray->at - chief->at;
      result.spot.push_back(at);
      n += 1, sum = sum + at, squares += dot(at, at);
    }
  if (n > 0) result.rms = std::sqrt(std::max(0.0, squares - dot(sum, sum) / n) / n);
  return result;
}

}  // namespace

LensDesign design_lens(const std::vector<SurfaceSpec>& surfaces, double object_distance,
                       double field, int fields, double focus) {
  LensDesign design;
  const FirstOrder& lens = design.lens = first_order(surfaces);
  if (!std::isfinite(lens.focal_length) || lens.focal_length <= 0)
    throw InputError("the lens does not converge: its focal length is not positive");
  if (lens.stop < 0) throw InputError("the lens has no aperture stop; mark one surface");
  if (!std::isfinite(lens.entrance_pupil))
    throw InputError("the lens is telecentric on the scene's side; its fields cannot be angles");
  if (object_distance <= -lens.front_focal_distance)
    throw InputError("the object stands inside the front focal point: there is no real image");
  design.object_distance = object_distance;
  const double paraxial = paraxial_image_distance(lens, object_distance);
  design.focus = std::isnan(focus) ? -best_spot(surfaces, object_distance, 0).shift : focus;
  design.image_distance = paraxial + design.focus;
  const double pupil = 0.5 * lens.entrance_pupil_diameter;
  const auto tracer = [&](double angle) {
    return FieldTracer(surfaces, lens, object_distance, design.image_distance, angle);
  };
  const double axis_area = open_area(tracer(0), pupil);
  if (!(axis_area > 0)) throw InputError("no light gets through the lens");
  double low = 0, high = constants::pi / 4;
  const auto open = [&](double angle) {
    const FieldTracer at = tracer(angle);
    return at.has_chief() && open_area(at, pupil) >= 0.1 * axis_area;
  };
  if (open(high)) low = high;
  for (int i = 0; i < 12 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    (open(middle) ? low : high) = middle;
  }
  design.greatest_field = low;
  const double last = field > 0 ? field : low;
  for (int i = 0; i < fields; ++i) {
    const double angle = fields > 1 ? last * i / (fields - 1) : 0;
    design.fields.push_back(design_field(tracer(angle), design, angle, axis_area));
  }
  return design;
}

}  // namespace plenoflame
