#pragma once
#include <string>
#include <string_view>
#include <vector>
#include "plenoflame/scene/main_lens_spec.h"

namespace plenoflame {

/// Tells whether a surface is anything but a sphere or a plane.
bool is_aspheric(const SurfaceSpec& surface);

/// Depth of a surface behind its vertex (towards the sensor) at a height [m]; NaN where a conic has
/// none any more.
double surface_sag(const SurfaceSpec& surface, double height);

/// Height up to which the surface exists [m]; infinite for planes, paraboloids and hyperboloids.
double greatest_height(const SurfaceSpec& surface);

/// Aspheric terms as text, "1.2e-7 1/mm^3, 0, -3e-12 1/mm^7": coefficients of h^4, h^6, h^8, ...;
/// and back. Units: 1/mm^n or 1/m^n with the n that belongs there; 0 needs none.
/// @throws InputError for a missing or wrong unit, or more than 7 terms
std::vector<double> parse_aspheric(std::string_view text);
std::string format_aspheric(const std::vector<double>& terms);

}  // namespace plenoflame
