#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/scene/main_lens_spec.h"

/// The shape of a lens surface. Surfaces have kinds, whose differences are rows of functions
/// (optics/surface_kinds.cpp); everything here looks into the row of the surface's own kind.
namespace plenoflame {

/// Tells whether a surface is anything but a sphere or a plane.
bool is_aspheric(const SurfaceSpec& surface);

/// Tells whether a surface is rotationally symmetric about the axis.
bool is_round(const SurfaceSpec& surface);
/// The same of all surfaces of a lens.
bool is_round(const MainLensSpec& lens);

/// Depth of a surface behind its vertex (towards the sensor) at a place beside the axis [m], camera
/// x and y; NaN where a conic has none any more.
double surface_sag(const SurfaceSpec& surface, Vec2 place);

/// Distance from the axis up to which the surface exists in all directions [m]; infinite for
/// planes, paraboloids and hyperboloids.
double greatest_height(const SurfaceSpec& surface);

/// Places at which surfaces are sampled within a height [m], in `steps` steps along a radius from
/// the axis, without the height itself. Surfaces that are not round are sampled along many radii,
/// with their ends.
std::vector<Vec2> places_on(bool round, double height, int steps);

/// Reach of the surface in front of its vertex (towards the scene) within its clear diameter
/// [m], at least 0.
double reach_to_scene(const SurfaceSpec& surface);

/// Radius of paraxial optics [m]. For a surface that is not round it is the radius of the mean
/// curvature, which has the mean power of its two sections.
double paraxial_radius(const SurfaceSpec& surface);

/// The lens with each surface that is not round replaced by a rotationally symmetric one of the
/// same mean curvature. The replacement is a paraboloid, which exists at all heights.
MainLensSpec round_counterpart(MainLensSpec lens);

/// A surface that cannot be.
struct SurfaceFault {
  std::string key;   ///< of the surface, "diameter"
  std::string text;  ///< continues "surface 3 of the main lens "
};
std::optional<SurfaceFault> surface_fault(const SurfaceSpec& surface);

/// The radii in words where `radius` does not say them, "x 40 mm, y inf"; empty otherwise.
std::string radii_in_words(const SurfaceSpec& surface);

/// Aspheric terms as text, "1.2e-7 1/mm^3, 0, -3e-12 1/mm^7": coefficients of h^4, h^6, h^8, ...;
/// and back. Units: 1/mm^n or 1/m^n with the n that belongs there; 0 needs none.
/// @throws InputError for a missing or wrong unit, or more than 7 terms
std::vector<double> parse_aspheric(std::string_view text);
std::string format_aspheric(const std::vector<double>& terms);

}  // namespace plenoflame
