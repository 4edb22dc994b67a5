#pragma once
#include <array>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/media/medium.h"

namespace plenoflame {

/// A medium's temperature and absorption at the points of a lattice along the world's axes.
struct MediumSamples {
  Vec3 origin;                     ///< [m] world; the first point
  Vec3 step;                       ///< [m] between points
  std::array<int, 3> count{};      ///< points along x, y, z
  std::vector<float> temperature;  ///< [K] x fastest
  std::vector<float> absorption;   ///< [1/m]
};

/// The places of the points in the medium's bounds.
enum class SamplePlaces {
  /// On the rim as well, at equal distances in all directions: `longest` of them along the longest
  /// side, at least 2 along the others. If the last step ends beyond a side, both ends share the
  /// excess.
  nodes,
  /// In the middles of boxes that fill the bounds: `longest` of them along the longest side. The
  /// other sides have the number that makes the boxes nearly cubes, at least 2.
  middles,
};

/// At the middles of the cells into which a box is divided, `count` along x, y and z. Places where
/// there is no medium have neither temperature nor absorption.
/// @throws Cancelled; InputError for a box without volume or fewer than one cell
MediumSamples sample_medium(const Medium& medium, const Box& box, std::array<int, 3> count,
                            const Execution& execution = {});

/// @return without points when the medium is nowhere
/// @throws Cancelled when execution.stop is requested; InputError for fewer than 2 points
MediumSamples sample_medium(const Medium& medium, SamplePlaces places, int longest,
                            const Execution& execution = {});

}  // namespace plenoflame
