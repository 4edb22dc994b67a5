#pragma once
#include "camera/pupil_tracer.h"
#include "plenoflame/camera/pupil_sampling.h"

namespace plenoflame {

/// Widens a table until it holds every one of many rays that get through the camera, traced between
/// its nodes: what interpolation, the grids and the microlens' own aberrations leave out.
/// @param cuts of every node @param own traces through the microlens with its own apertures
void widen_to_hold(PupilTracer& own, const PupilTable& table, std::vector<PupilCuts>& cuts);

}  // namespace plenoflame
