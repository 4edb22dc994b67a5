#include "plenoflame/optics/first_order.h"

#include <cmath>

#include "plenoflame/optics/surface_shape.h"

namespace plenoflame {
namespace {

/// Acts on (height, index * angle).
struct Abcd {
  double a = 1, b = 0, c = 0, d = 1;
};

Abcd after(const Abcd& first, const Abcd& then) {
  return {then.a * first.a + then.b * first.c, then.a * first.b + then.b * first.d,
          then.c * first.a + then.d * first.c, then.c * first.b + then.d * first.d};
}

Abcd refraction(double before, double behind, double radius) {
  return {1, 0, -(behind - before) / radius, 1};
}

Abcd transfer(double distance, double index) {
  return {1, distance / index, 0, 1};
}

/// From before surface `first` to just behind surface `last` (no transfer behind it).
Abcd matrix(const std::vector<SurfaceSpec>& surfaces, std::size_t first, std::size_t last) {
  Abcd m;
  for (std::size_t i = first; i <= last; ++i) {
    const double before = i > 0 ? surfaces[i - 1].index : 1.0;
    m = after(m, refraction(before, surfaces[i].index, paraxial_radius(surfaces[i])));
    if (i < last) m = after(m, transfer(surfaces[i].thickness, surfaces[i].index));
  }
  return m;
}

void set_cardinal_points(FirstOrder& lens, const Abcd& m) {
  lens.focal_length = -1.0 / m.c;
  lens.back_focal_distance = -m.a / m.c;
  lens.front_focal_distance = m.d / m.c;
  // BFL - EFL would lose digits in thin lenses.
  lens.rear_principal = (1.0 - m.a) / m.c;
  lens.front_principal = (m.d - 1.0) / m.c;
}

}  // namespace

FirstOrder first_order(const std::vector<SurfaceSpec>& surfaces) {
  FirstOrder lens;
  if (surfaces.empty()) return lens;
  const std::size_t last = surfaces.size() - 1;
  set_cardinal_points(lens, matrix(surfaces, 0, last));
  for (std::size_t i = 0; i < last; ++i) lens.length += surfaces[i].thickness;
  for (std::size_t i = 0; i <= last; ++i) {
    if (!surfaces[i].stop) continue;
    lens.stop = static_cast<int>(i);
    Abcd to_stop;  // from the first vertex to the stop
    if (i > 0)
      to_stop = after(matrix(surfaces, 0, i - 1),
                      transfer(surfaces[i - 1].thickness, surfaces[i - 1].index));
    lens.entrance_pupil = to_stop.b / to_stop.a;
    lens.entrance_pupil_diameter = std::fabs(surfaces[i].diameter / to_stop.a);
    const Abcd from_stop = matrix(surfaces, i, last);
    lens.exit_pupil = -from_stop.b / from_stop.d;
    lens.exit_pupil_diameter = std::fabs(surfaces[i].diameter / from_stop.d);
  }
  return lens;
}

FirstOrder first_order(const MainLensSpec& lens) {
  if (!lens.surfaces.empty()) return first_order(lens.surfaces);
  FirstOrder thin;
  thin.focal_length = thin.back_focal_distance = lens.focal_length;
  thin.front_focal_distance = -lens.focal_length;
  thin.entrance_pupil_diameter = thin.exit_pupil_diameter = lens.diameter;
  thin.stop = 0;
  return thin;
}

FirstOrder first_order(const ArraySpec& array, const MicrolensSpec& type) {
  if (array.model == LensModel::ideal && type.focal_length != 0) {
    FirstOrder thin;
    thin.focal_length = thin.back_focal_distance = type.focal_length;
    thin.front_focal_distance = -type.focal_length;
    return thin;
  }
  return first_order(std::vector<SurfaceSpec>{
      {type.radius_front, array.thickness, type.index, array.diameter, false},
      {-type.radius_back, 0, 1, array.diameter, false}});
}

double paraxial_image_distance(const FirstOrder& lens, double object_distance) {
  if (std::isinf(object_distance)) return lens.back_focal_distance;
  // Newton's form, x x' = f^2 with distances from the focal points: no cancellation.
  const double x = object_distance + lens.front_focal_distance;
  return lens.back_focal_distance + lens.focal_length * lens.focal_length / x;
}

double paraxial_magnification(const FirstOrder& lens, double object_distance) {
  return -lens.focal_length / (object_distance + lens.front_focal_distance);
}

}  // namespace plenoflame
