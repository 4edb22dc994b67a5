#pragma once
#include <span>
#include <vector>

#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/inverse/measurement.h"
#include "plenoflame/inverse/reconstruction.h"

/// The part of a result that concerns rows, for any model.
namespace plenoflame {

/// Counts the rows that have no weight. @throws InputError where there is no other
void count_left_out(std::span<const double> weights, Reconstruction& result);

/// Tells whether the solver or the form wants the stored matrix.
bool must_be_stored(const ReconstructionSettings& settings);

/// Tells whether the form allows the stored matrix.
bool may_be_stored(const ReconstructionSettings& settings);

/// Tells whether a matrix of this size [byte] is stored. @param at_least it may take more
/// @throws InputError if it must be stored and exceeds the allowed memory
bool is_stored(const ReconstructionSettings& settings, double matrix_bytes, bool at_least = false);

/// Adds two pictures for each view, the explained and the unexplained light, at the first pixel of
/// each row.
/// @param flux, explained [W] of the rows
/// @param weights 0: the row is left out
void add_row_pictures(const std::vector<Measurement>& measurements, const CameraRays& rays,
                      std::span<const double> flux, std::span<const double> explained,
                      std::span<const double> weights, Reconstruction& result);

}  // namespace plenoflame
