// Everything by which kinds of lens surfaces differ: a row of functions for each.
#include "optics/surface_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <type_traits>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/units.h"
#include "plenoflame/optics/surface_shape.h"

namespace plenoflame {
namespace {

using Fault = std::optional<SurfaceFault>;

struct SurfaceKind {
  bool round;  ///< rotationally symmetric: pupil tables and first-order designs know it
  bool (*is)(const SurfaceSpec&);
  double (*sag)(const SurfaceSpec&, Vec2);
  double (*greatest_height)(const SurfaceSpec&);
  double (*paraxial_radius)(const SurfaceSpec&);
  Fault (*fault)(const SurfaceSpec&);
  std::string (*radii)(const SurfaceSpec&);
  KernelShape<float> (*single_shape)(const SurfaceSpec&, bool to_scene);
  KernelShape<double> (*double_shape)(const SurfaceSpec&, bool to_scene);
};

std::string length_in_words(double value) {
  return readable_quantity(value, Dimension::length);
}

/// The square of the height in which heights count: that of the rim.
double rim_square(const SurfaceSpec& surface) {
  const bool bounded = surface.diameter > 0 && surface.diameter < kInfinity;
  return bounded ? 0.25 * surface.diameter * surface.diameter : 1;
}

/// The number under the root of a sag; rounding may put the rim of a hemisphere beyond its edge.
double held_inside(double inside) {
  return inside < 0 && inside > -1e-12 ? 0 : inside;
}

// ---- spheres, planes, and conics with even aspheric terms ---------------------------------------

bool always(const SurfaceSpec&) {
  return true;
}

bool is_even_asphere(const SurfaceSpec& surface) {
  return (surface.conic != 0 && std::isfinite(surface.radius)) ||
         std::any_of(surface.aspheric.begin(), surface.aspheric.end(),
                     [](double term) { return term != 0; });
}

double round_sag(const SurfaceSpec& surface, Vec2 place) {
  const double h2 = dot(place, place);
  double sag = 0;
  for (std::size_t i = surface.aspheric.size(); i-- > 0;) sag = sag * h2 + surface.aspheric[i];
  const double c = 1 / surface.radius;
  const double inside = held_inside(1 - (1 + surface.conic) * c * c * h2);
  return sag * h2 * h2 + c * h2 / (1 + std::sqrt(inside));
}

double conic_height(const SurfaceSpec& surface) {
  if (!(surface.conic > -1)) return kInfinity;
  return std::fabs(surface.radius) / std::sqrt(1 + surface.conic);
}

double own_radius(const SurfaceSpec& surface) {
  return surface.radius;
}

Fault round_fault(const SurfaceSpec& surface) {
  if (surface.conic != 0 && surface.diameter > 2 * conic_height(surface))
    return SurfaceFault{"diameter", fmt::format("has a diameter of {}, but its conic ends at {}",
                                                length_in_words(surface.diameter),
                                                length_in_words(2 * conic_height(surface)))};
  if (surface.conic == 0 && surface.diameter > 2 * std::fabs(surface.radius))
    return SurfaceFault{
        "diameter",
        fmt::format("has a diameter of {}, but a sphere of radius {} allows at most {}",
                    length_in_words(surface.diameter), length_in_words(std::fabs(surface.radius)),
                    length_in_words(2 * std::fabs(surface.radius)))};
  return std::nullopt;
}

std::string no_words(const SurfaceSpec&) {
  return {};
}

template <class Real>
KernelShape<Real> sphere_shape(const SurfaceSpec&, bool) {
  return {};
}

template <class Real>
KernelShape<Real> even_asphere_shape(const SurfaceSpec& surface, bool to_scene) {
  const double rim2 = rim_square(surface);
  KernelShape<Real> shape{};
  shape.kind = ShapeKind::even_asphere;
  KernelEvenAsphere<Real>& asphere = shape.even_asphere;
  asphere.curvature = static_cast<Real>((to_scene ? -1.0 : 1.0) / surface.radius);
  asphere.conic = static_cast<Real>(surface.conic);
  asphere.inverse_height2 = static_cast<Real>(1 / rim2);
  double scale = rim2 * rim2;
  for (std::size_t i = 0; i < surface.aspheric.size() && i < kAsphericTerms; ++i, scale *= rim2)
    asphere.terms[i] =
        static_cast<Real>(scale * (to_scene ? -surface.aspheric[i] : surface.aspheric[i]));
  return shape;
}

// ---- biconics: cylinders, and surfaces of two radii ---------------------------------------------

bool is_biconic(const SurfaceSpec& surface) {
  return surface.radius_x != 0 || surface.radius_y != 0;
}

double biconic_sag(const SurfaceSpec& surface, Vec2 place) {
  const double ax = place.x / surface.radius_x, ay = place.y / surface.radius_y;
  const double inside =
      held_inside(1 - (1 + surface.conic_x) * ax * ax - (1 + surface.conic_y) * ay * ay);
  return (ax * place.x + ay * place.y) / (1 + std::sqrt(inside));
}

double section_height(double radius, double conic) {
  return conic > -1 ? std::fabs(radius) / std::sqrt(1 + conic) : kInfinity;
}

double biconic_height(const SurfaceSpec& surface) {
  return std::min(section_height(surface.radius_x, surface.conic_x),
                  section_height(surface.radius_y, surface.conic_y));
}

double mean_radius(const SurfaceSpec& surface) {
  return 2 / (1 / surface.radius_x + 1 / surface.radius_y);
}

Fault biconic_fault(const SurfaceSpec& surface) {
  for (const char axis : {'x', 'y'})
    if ((axis == 'x' ? surface.radius_x : surface.radius_y) == 0)
      return SurfaceFault{
          fmt::format("radius_{}", axis),
          fmt::format("is biconic, but has no radius_{}; a cylinder has radius_{} = inf there",
                      axis, axis)};
  if (std::isfinite(surface.radius) || surface.conic != 0 || !surface.aspheric.empty())
    return SurfaceFault{std::isfinite(surface.radius) ? "radius"
                        : surface.conic != 0          ? "conic"
                                                      : "aspheric",
                        "is biconic: radius, conic and aspheric are of round surfaces; leave them "
                        "out, or radius_x and radius_y"};
  if (surface.diameter > 2 * biconic_height(surface))
    return SurfaceFault{"diameter", fmt::format("has a diameter of {}, but its biconic ends at {}",
                                                length_in_words(surface.diameter),
                                                length_in_words(2 * biconic_height(surface)))};
  return std::nullopt;
}

std::string biconic_radii(const SurfaceSpec& surface) {
  return "x " + length_in_words(surface.radius_x) + ", y " + length_in_words(surface.radius_y);
}

template <class Real>
KernelShape<Real> biconic_shape(const SurfaceSpec& surface, bool to_scene) {
  const double sign = to_scene ? -1 : 1;
  KernelShape<Real> shape{};
  shape.kind = ShapeKind::biconic;
  shape.biconic = {static_cast<Real>(sign / surface.radius_x),
                   static_cast<Real>(sign / surface.radius_y), static_cast<Real>(surface.conic_x),
                   static_cast<Real>(surface.conic_y), static_cast<Real>(1 / rim_square(surface))};
  return shape;
}

// ---- the rows: a surface is of the first kind that it is one of ---------------------------------

constexpr SurfaceKind kKinds[]{
    {false, is_biconic, biconic_sag, biconic_height, mean_radius, biconic_fault, biconic_radii,
     biconic_shape<float>, biconic_shape<double>},
    {true, is_even_asphere, round_sag, conic_height, own_radius, round_fault, no_words,
     even_asphere_shape<float>, even_asphere_shape<double>},
    {true, always, round_sag, conic_height, own_radius, round_fault, no_words, sphere_shape<float>,
     sphere_shape<double>},
};
constexpr const SurfaceKind& kSphere = kKinds[std::size(kKinds) - 1];

const SurfaceKind& kind_of(const SurfaceSpec& surface) {
  return *std::find_if(std::begin(kKinds), std::end(kKinds),
                       [&](const SurfaceKind& kind) { return kind.is(surface); });
}

}  // namespace

bool is_aspheric(const SurfaceSpec& surface) {
  return &kind_of(surface) != &kSphere;
}

bool is_round(const SurfaceSpec& surface) {
  return kind_of(surface).round;
}

bool is_round(const MainLensSpec& lens) {
  return std::all_of(lens.surfaces.begin(), lens.surfaces.end(),
                     [](const SurfaceSpec& surface) { return is_round(surface); });
}

double surface_sag(const SurfaceSpec& surface, Vec2 place) {
  return kind_of(surface).sag(surface, place);
}

double greatest_height(const SurfaceSpec& surface) {
  return kind_of(surface).greatest_height(surface);
}

double paraxial_radius(const SurfaceSpec& surface) {
  return kind_of(surface).paraxial_radius(surface);
}

std::vector<Vec2> places_on(bool round, double height, int steps) {
  constexpr int kAround = 48;
  std::vector<Vec2> places;
  for (int i = 0; i < steps + (round ? 0 : 1); ++i)
    for (int k = 0; k < (round || i == 0 ? 1 : kAround); ++k) {
      const double h = height * i / steps, angle = 2 * constants::pi * k / kAround;
      places.push_back(k == 0 ? Vec2{h, 0} : Vec2{h * std::cos(angle), h * std::sin(angle)});
    }
  return places;
}

double reach_to_scene(const SurfaceSpec& surface) {
  constexpr int kSteps = 256;
  const double height = std::min(0.5 * surface.diameter, greatest_height(surface));
  double reach = std::max(0.0, -surface_sag(surface, {height, 0}));
  if (is_aspheric(surface))
    for (const Vec2 place : places_on(is_round(surface), height, kSteps))
      reach = std::max(reach, -surface_sag(surface, place));
  return reach;
}

std::optional<SurfaceFault> surface_fault(const SurfaceSpec& surface) {
  return kind_of(surface).fault(surface);
}

std::string radii_in_words(const SurfaceSpec& surface) {
  return kind_of(surface).radii(surface);
}

MainLensSpec round_counterpart(MainLensSpec lens) {
  for (SurfaceSpec& surface : lens.surfaces) {
    if (is_round(surface)) continue;
    SurfaceSpec round;
    round.radius = paraxial_radius(surface);
    round.conic = -1;
    round.thickness = surface.thickness;
    round.index = surface.index;
    round.diameter = surface.diameter;
    round.stop = surface.stop;
    round.glass = surface.glass;
    surface = round;
  }
  return lens;
}

template <class Real>
KernelShape<Real> kernel_shape(const SurfaceSpec& surface, bool to_scene) {
  const SurfaceKind& kind = kind_of(surface);
  if constexpr (std::is_same_v<Real, float>)
    return kind.single_shape(surface, to_scene);
  else
    return kind.double_shape(surface, to_scene);
}

template KernelShape<float> kernel_shape(const SurfaceSpec&, bool);
template KernelShape<double> kernel_shape(const SurfaceSpec&, bool);

}  // namespace plenoflame
