#pragma once
#include <memory>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/media/medium.h"
#include "plenoflame/radiometry/source_function.h"

namespace plenoflame {

/// A homogeneous ellipsoid, axes along the local x, y, z.
struct EllipsoidLayer {
  Vec3 centre;             ///< [m] local frame
  Vec3 semi_axes;          ///< [m]
  double temperature = 0;  ///< [K]
  double absorption = 0;   ///< [1/m]
};

/// Stratified flame of homogeneous ellipsoids: exact. If several overlap, the first one listed
/// counts.
/// @param to_world places the local frame
/// @param absorption_factors per channel, on the layers' absorption; empty: grey
/// @throws InputError without layers or channels.
std::unique_ptr<Medium> make_layered_medium(std::vector<EllipsoidLayer> layers,
                                            const RigidTransform& to_world,
                                            std::vector<SourceFunction> channels,
                                            std::vector<double> absorption_factors = {});

}  // namespace plenoflame
