#pragma once
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/inverse/flame_estimate.h"
#include "plenoflame/inverse/unknowns.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// Results of one frame of a reconstruction.
struct ReconstructResult {
  Reconstruction figures;
  FlameEstimate estimate;
  std::vector<double> resolved_absorption;  ///< where it was solved for
  /// Relative standard error of all of the pictures' light together; no deviation holds it.
  double scale_error = 0;
  std::vector<Suspect> corrections;  ///< of refined cameras: what the scenes had wrong
  bool settled = true;               ///< false: the corrections still moved at their end
  /// Tells pictures and absorptions apart; empty: not known.
  std::string input = {};
  /// A block that would hold the flame, where that of the unknowns cuts it.
  std::optional<Box> uncut_block = {};
};

/// A field of what was found.
struct ReconstructedField {
  std::string name;  ///< of its grid
  std::string unit;
  const std::vector<double>* values;  ///< of the unknowns
};
/// The fields that there are, in the order in which they are written.
std::vector<ReconstructedField> reconstructed_fields(const ReconstructResult& result);

/// A field on voxels. Temperatures are those of the surroundings where nothing has one, and at
/// least as high: the unknowns' interpolation ends at 0.
VoxelField on_voxels(const ReconstructedField& field, const Unknowns& unknowns);

/// Numbers of unknowns along the axes: "16 x 32 x 1".
std::string shape_text(const Unknowns& unknowns);

/// The result as grids of one file. The file appears as a whole, or not.
/// @throws FileError
void write_estimate(const std::string& path, const ReconstructResult& result,
                    const Unknowns& unknowns);

/// The scene's flames at the places of the unknowns.
struct FlameTruth {
  std::vector<double> emission, temperature, absorption;
};
/// Emission is that of the open stop where filters cover parts of it: as what reconstructions find.
/// @param temperatures are found, by which filters pass their shares; else these are
/// pupil_transmission()
FlameTruth flame_truth(const CompiledScene& scene, std::size_t channel, const Unknowns& unknowns,
                       bool temperatures);

}  // namespace plenoflame
