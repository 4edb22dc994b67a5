#pragma once
#include <cstddef>
#include <vector>

#include "plenoflame/camera/camera.h"
#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// Half the sensor's diagonal, plus the reach of the sensor's blur [m].
double field_radius(const Camera& camera);

/// Distance by which a decentred or tilted main lens displaces its field over array and sensor [m].
/// It is the larger of the displacements of Camera::foot() and of the lens' own axis.
double field_shift(const Camera& camera);

/// Number of nodes that a table over distances up to `field` [m] from the axis needs. The entries
/// of a table depend on the angle at which the exit pupil is seen.
std::size_t field_nodes(const Camera& camera, double field);

/// Copies a node to its dark neighbour, which otherwise would cut the light between them.
/// @param cuts of the same nodes
void extend_into_shadow(std::vector<PupilNode>& nodes, std::vector<PupilCuts>& cuts);

}  // namespace plenoflame
