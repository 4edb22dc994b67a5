#pragma once
#include "plenoflame/radiometry/spectral_response.h"

namespace plenoflame {

/// parse_spectral_points() of a filter: at most 1, and 0 everywhere where it is opaque.
/// @throws InputError
std::vector<SpectralPoint> parse_filter_points(std::string_view text);
/// True if the points let no light through.
bool is_opaque(const std::vector<SpectralPoint>& points);

}  // namespace plenoflame
