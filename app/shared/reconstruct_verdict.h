#pragma once
#include <optional>
#include <string>
#include <vector>

#include "reconstruct_result.h"

/// A reconstruction in words: what a reader may believe, and what is wrong.
namespace plenoflame {

/// Means over the flame, weighted by light.
struct MeanDeviations {
  std::optional<double> emission;     ///< relative
  std::optional<double> temperature;  ///< [K]
  std::optional<double> absorption;   ///< relative
};
MeanDeviations mean_deviations(const FlameEstimate& estimate, const Unknowns& unknowns);

/// How well the flame is known. @param kind "voxels", "rings" or "layers"
std::string verdict(const ReconstructResult& result, const Unknowns& unknowns,
                    const std::string& kind, std::size_t cameras);

}  // namespace plenoflame
