#include "plenoflame/camera/array_solver.h"

#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"

namespace plenoflame {
namespace {

constexpr int kRays = 64;

std::string length_words(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g mm", 1e3 * value);
  return text;
}

[[noreturn]] void no_solution(double focal_length, const std::string& why) {
  throw InputError("no microlens of focal length " + length_words(focal_length) + ": " + why);
}

/// Depth of a face at the rim, positive when convex.
double rim_sag(double radius, double height) {
  const double c = height / radius;
  return height * c / (1 + std::sqrt(std::max(0.0, 1 - c * c)));
}

void check_shape(const MicrolensShape& s, double focal_length, double diameter,
                 const MicrolensLimits& limits) {
  const double height = 0.5 * diameter;
  for (const double radius : {s.radius_front, s.radius_back}) {
    if (std::fabs(radius) < height)
      no_solution(focal_length, "a face would need the radius " + length_words(std::fabs(radius)) +
                                    ", less than half the diameter");
    if (std::fabs(radius) < limits.least_radius)
      no_solution(focal_length, "a face would need the radius " + length_words(std::fabs(radius)) +
                                    ", below the limit of " + length_words(limits.least_radius));
  }
  if (s.index > limits.greatest_index) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4f", s.index);
    char limit[32];
    std::snprintf(limit, sizeof limit, "%.4g", limits.greatest_index);
    no_solution(focal_length,
                std::string("it would need the index ") + text + ", above the limit of " + limit);
  }
  if (s.thickness > limits.greatest_thickness)
    no_solution(focal_length, "it would need the thickness " + length_words(s.thickness) +
                                  ", above the limit of " +
                                  length_words(limits.greatest_thickness));
  const double taken = rim_sag(s.radius_front, height) + rim_sag(s.radius_back, height);
  if (s.thickness < taken * (1 - 1e-12))
    no_solution(focal_length, "its faces would cross at the rim, where a thickness of " +
                                  length_words(taken) + " is needed and it has " +
                                  length_words(s.thickness));
}

double solve_index(const MicrolensShape& shape, double power) {
  // With S = 1/R1 + 1/R2 and T = l / (R1 R2), times n: (S - T) n^2 - (S - 2 T + power) n - T = 0.
  const double s = 1 / shape.radius_front + 1 / shape.radius_back;
  const double t = shape.thickness / shape.radius_front / shape.radius_back;
  const double a = s - t, b = s - 2 * t + power;
  const double root = b * b + 4 * a * t;
  if (!(root >= 0) || a == 0) return NAN;
  // The root that becomes n = 1 + power / S for a thin lens.
  return (b + std::copysign(std::sqrt(root), a)) / (2 * a);
}

/// Factor on both radii.
double solve_scale(const MicrolensShape& shape, double power) {
  // u = 1 / factor: (n - 1) S u - (n - 1)^2 T / n u^2 = power.
  const double s = (shape.index - 1) * (1 / shape.radius_front + 1 / shape.radius_back);
  const double t = (shape.index - 1) * (shape.index - 1) / shape.index * shape.thickness /
                   shape.radius_front / shape.radius_back;
  const double root = s * s - 4 * t * power;
  if (!(root >= 0)) return NAN;
  return (s + std::copysign(std::sqrt(root), s)) / (2 * power);
}

double solve_thickness(const MicrolensShape& shape, double power) {
  const double m = shape.index - 1;
  const double s = 1 / shape.radius_front + 1 / shape.radius_back;
  return (s - power / m) * shape.index / m * shape.radius_front * shape.radius_back;
}

/// Squared diameter of a disc with the same RMS radius as the image; NaN when no ray gets through.
class MicrolensBlur {
 public:
  MicrolensBlur(const MicrolensShape& s, double gap, double diameter)
      : surfaces_{{s.radius_front, s.thickness, s.index, diameter, true},
                  {-s.radius_back, 0, 1, diameter, false}},
        system_(surfaces_),
        front_principal_(first_order(surfaces_).front_principal),
        sensor_(-s.thickness - gap),
        radius_(0.5 * diameter) {}

  /// @param vergence 1 / a [1/m]
  double operator()(double vergence) const {
    double n = 0, squares = 0;
    for (int i = 0; i < kRays; ++i) {
      // Rays are aimed at points of the front face. The object is 1 / vergence - front principal
      // plane in front of the vertex; the reciprocal stays finite for distant objects.
      const double height = radius_ * std::sqrt((i + 0.5) / kRays);
      const double depth = rim_sag(surfaces_.front().radius, height);
      const double inverse = vergence / (1 - vergence * (front_principal_ - depth));
      Ray ray{{height, 0, -depth}, normalize({height * inverse, 0, -1})};
      if (system_.trace_to_sensor(ray).status != RayStatus::reached) continue;
      const double x = ray.origin.x + (sensor_ - ray.origin.z) / ray.direction.z * ray.direction.x;
      n += 1, squares += x * x;
    }
    return 8 * squares / n;
  }

 private:
  std::vector<SurfaceSpec> surfaces_;
  LensSystem system_;
  double front_principal_, sensor_, radius_;
};

}  // namespace

double thick_focal_length(const MicrolensShape& s) {
  const double m = s.index - 1;
  return 1 / (m * (1 / s.radius_front + 1 / s.radius_back -
                   m * s.thickness / (s.index * s.radius_front * s.radius_back)));
}

std::vector<double> joined_focal_lengths(double first, double b, double diameter, double pixel,
                                         int count) {
  std::vector<double> lengths;
  for (int k = 0; k < count; ++k) {
    const double power = 1 / first + 2 * k * pixel / (diameter * b);
    if (!(power > 0) || !std::isfinite(power))
      throw InputError("the rule gives microlens type " + std::to_string(k + 1) +
                       " a focal length that is not positive");
    lengths.push_back(1 / power);
  }
  return lengths;
}

MicrolensShape solve_microlens(const MicrolensShape& shape, double focal_length, double diameter,
                               MicrolensFreedom freedom, const MicrolensLimits& limits) {
  if (!(focal_length > 0)) throw InputError("a microlens needs a positive focal length");
  MicrolensShape solved = shape;
  const double power = 1 / focal_length;
  if (freedom == MicrolensFreedom::index) {
    solved.index = solve_index(shape, power);
    if (!(solved.index > 1))
      no_solution(focal_length, "no index above 1 gives it with these faces");
  } else if (freedom == MicrolensFreedom::radius) {
    const double scale = solve_scale(shape, power);
    if (!(scale > 0)) no_solution(focal_length, "no radius gives it with this thickness and index");
    solved.radius_front *= scale, solved.radius_back *= scale;
  } else {
    if (std::isinf(shape.radius_front) || std::isinf(shape.radius_back))
      no_solution(focal_length, "with a plane face the thickness changes nothing");
    solved.thickness = solve_thickness(shape, power);
    if (!(solved.thickness > 0))
      no_solution(focal_length, "it would need the thickness " + length_words(solved.thickness));
  }
  check_shape(solved, focal_length, diameter, limits);
  return solved;
}

std::optional<SharpRange> traced_depth_of_field(const MicrolensShape& shape, double gap,
                                                double diameter, double pixel) {
  const MicrolensBlur blur(shape, gap, diameter);
  const FirstOrder lens = first_order(
      std::vector<SurfaceSpec>{{shape.radius_front, shape.thickness, shape.index, diameter, true},
                               {-shape.radius_back, 0, 1, diameter, false}});
  const double b = gap - lens.rear_principal;
  const double focus = 1 / lens.focal_length - 1 / b, width = 2 * pixel / (diameter * b);
  // The squared blur is nearly quadratic in the vergence; golden section finds its minimum.
  double low = focus - 3 * width, high = focus + 3 * width;
  constexpr double kGolden = 0.61803398874989485;
  for (int i = 0; i < 90; ++i) {
    const double a = high - kGolden * (high - low), c = low + kGolden * (high - low);
    (blur(a) < blur(c) ? high : low) = blur(a) < blur(c) ? c : a;
  }
  const double best = 0.5 * (low + high), limit = pixel * pixel;
  if (!(blur(best) <= limit)) return std::nullopt;
  const auto end = [&](double direction) {
    double inside = best, outside = best + direction * 4 * width;
    if (blur(outside) <= limit) return outside;
    for (int i = 0; i < 80; ++i) {
      const double middle = 0.5 * (inside + outside);
      (blur(middle) <= limit ? inside : outside) = middle;
    }
    return inside;
  };
  return SharpRange{1 / end(1), 1 / best, 1 / end(-1)};
}

std::vector<SolvedType> solve_array(const ArraySpec& array, double pixel, int count,
                                    MicrolensFreedom freedom, const MicrolensLimits& limits) {
  const MicrolensSpec& first = array.types.front();
  const MicrolensShape shape{first.radius_front, first.radius_back, first.index, array.thickness};
  if (std::isinf(first.radius_front) && std::isinf(first.radius_back))
    throw InputError(
        "camera.array.types[0] is a thin lens without faces: there is no index, "
        "radius or thickness to solve for; give it radii");
  const FirstOrder optics = first_order(array, first);
  const bool from_principal = array.measured_from == ArrayReference::principal_plane;
  const double gap = array.sensor_distance + (from_principal ? optics.rear_principal : 0);
  const double b = gap - optics.rear_principal;
  const double f = thick_focal_length(shape);
  if (!(f > 0)) throw InputError("the first microlens type does not converge: nothing to join to");
  std::vector<SolvedType> types;
  for (const double target : joined_focal_lengths(f, b, array.diameter, pixel, count)) {
    SolvedType type;
    type.target = target;
    type.shape =
        types.empty() ? shape : solve_microlens(shape, target, array.diameter, freedom, limits);
    type.rule = depth_of_field(target, b, array.diameter, pixel);
    // A thicker lens grows towards the scene; the sensor does not move.
    type.traced = traced_depth_of_field(type.shape, gap, array.diameter, pixel);
    types.push_back(type);
  }
  return types;
}

}  // namespace plenoflame
