#pragma once
#include <cstddef>
#include <vector>

#include "camera/pupil/pupil_tracer.h"
#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// The distances from their middles at which a table's series find the farthest passing ray
/// [radii]; 0: unknown.
struct Crossed {
  double stop = 0, far_face = 0;
};

/// Widens the cuts of a table's node i and of the next until they contain many traced rays that
/// pass the camera between the two. This covers errors of interpolation and grids, and aberrations
/// of the microlens. Neighbouring pairs share a node.
/// @param own traces through the microlens with its own apertures @param cuts of every node
/// @return reach of the passing rays in the table's series
Crossed widen_pair(PupilTracer& own, const PupilTable& table, std::size_t i,
                   std::vector<PupilCuts>& cuts);

/// Widens the cuts for the rays that were not traced.
void add_margin(const PupilTable& table, std::vector<PupilCuts>& cuts);
/// Moves the edges of micro-images outwards: the last opening is small, and traced rays rarely hit
/// it.
void add_edge_margin(std::vector<PupilCuts>& cuts);

}  // namespace plenoflame
