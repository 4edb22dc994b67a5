#pragma once
#include <cstddef>
#include <vector>

#include "camera/pupil/pupil_tracer.h"
#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// The distances from their middles at which a table's series find the farthest ray that passes
/// [radii]; 0 where they are not known.
struct Crossed {
  double stop = 0, far_face = 0;
};

/// Widens the cuts of a table's node i and of the next until they hold every one of many rays that
/// get through the camera, traced between the two: what interpolation, the grids and the microlens'
/// own aberrations leave out. Neighbouring pairs share a node.
/// @param own traces through the microlens with its own apertures @param cuts of every node
/// @return of the rays that get through, as the table's series find them
Crossed widen_pair(PupilTracer& own, const PupilTable& table, std::size_t i,
                   std::vector<PupilCuts>& cuts);

/// Makes room in the cuts for the rays that were not traced.
void add_margin(const PupilTable& table, std::vector<PupilCuts>& cuts);
/// Moves the edges of micro-images outwards: what is open last is small, and hardly ever met.
void add_edge_margin(std::vector<PupilCuts>& cuts);

}  // namespace plenoflame
