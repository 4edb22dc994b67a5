#pragma once
#include <cstddef>
#include <vector>

#include "plenoflame/camera/camera.h"
#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// Half the sensor's diagonal [m].
double field_radius(const Camera& camera);

/// Distance by which a main lens that is moved displaces its field over array and sensor, as the
/// middle of the stop sees it or along its own axis [m].
double field_shift(const Camera& camera);

/// Number of nodes that a table over distances up to `field` [m] from the axis needs: what the
/// tables hold changes with the angle under which the exit pupil is seen.
std::size_t field_nodes(const Camera& camera, double field);

/// A node where nothing passes next to one where something does must not cut the light between.
/// @param cuts of the same nodes
void extend_into_shadow(std::vector<PupilNode>& nodes, std::vector<PupilCuts>& cuts);

}  // namespace plenoflame
