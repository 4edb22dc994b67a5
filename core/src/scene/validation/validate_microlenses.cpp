#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plenoflame/base/units.h"
#include "plenoflame/camera/microlens_aperture.h"
#include "plenoflame/camera/microlens_lattice.h"
#include "scene/validation/issues.h"

namespace plenoflame {
namespace {

/// Lenses that touch may overlap by this much of the pitch: rounding.
constexpr double kLensesTouch = 1e-12;
constexpr int kNeighbours = 2;  ///< lattice steps to the farthest lens that could be met

/// Half the gap between the apertures of two lenses that are `way` apart. Two equal convex figures
/// with a centre of symmetry are separate under one condition. Along the normal of one of their
/// sides, half the way exceeds half their width.
double half_gap(const MicrolensAperture& aperture, Vec2 way) {
  if (aperture.pairs() == 0) return 0.5 * length(way) - aperture.radius();
  double gap = -kInfinity;
  for (int k = 0; k < aperture.pairs(); ++k)
    gap = std::max(gap, 0.5 * std::fabs(dot(aperture.normal(k), way)) - aperture.half_width(k));
  return gap;
}

}  // namespace

double room_of_microlenses(const ArraySpec& array) {
  if (array.aperture == ApertureShape::circular && is_regular(array))
    return 0.5 * (array.pitch - array.diameter);
  ArraySpec endless = array;
  endless.centre_jitter = 0;
  endless.columns = endless.rows = 0;
  const MicrolensLattice lattice(endless);
  const MicrolensAperture aperture(array);
  double room = kInfinity;
  for (int r = -kNeighbours; r <= kNeighbours; ++r)
    for (int q = -kNeighbours; q <= kNeighbours; ++q)
      if (q != 0 || r != 0)
        room = std::min(room, half_gap(aperture, lattice.centre({q, r}) - lattice.centre({0, 0})));
  // Apertures that leave no gap touch.
  return room < 0 && room > -kLensesTouch * array.pitch ? 0 : room;
}

void check_microlens_shape(const ArraySpec& array, Issues& issues) {
  if (array.pitch_y > 0 && array.lattice == Lattice::hexagonal)
    issues.error("camera.array.pitch_y",
                 "camera.array.pitch_y is for square lattices: the rows of a hexagonal one are "
                 "cos 30 of the pitch apart");
  if (array.diameter_y > 0 && array.aperture != ApertureShape::square)
    issues.error("camera.array.diameter_y",
                 "camera.array.diameter_y is for square microlenses, which it makes rectangular; "
                 "give aperture = \"square\"");
  const double room = room_of_microlenses(array);
  if (!(room < 0)) return;
  const std::string pitch = is_regular(array)
                                ? short_length(array.pitch)
                                : short_length(array.pitch) + " and " + short_length(array.pitch_y);
  if (array.aperture == ApertureShape::circular)
    issues.error_among(
        {"camera.array.diameter", "camera.array.pitch", "camera.array.pitch_y"},
        fmt::format("the microlenses have a diameter of {} at a pitch of {}, so they "
                    "overlap; make the diameter at "
                    "most the pitch",
                    short_length(array.diameter), pitch));
  else
    issues.error_among(
        {"camera.array.diameter", "camera.array.diameter_y", "camera.array.aperture",
         "camera.array.pitch"},
        fmt::format("microlenses that are {} and {} across overlap by {} in a {} lattice with a "
                    "pitch of {}; make the diameter smaller",
                    array.aperture == ApertureShape::square ? "square" : "hexagonal",
                    short_length(array.diameter), short_length(-2 * room),
                    array.lattice == Lattice::square ? "square" : "hexagonal", pitch));
}

}  // namespace plenoflame
