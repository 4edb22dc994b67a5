#pragma once
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/inverse/unknowns_request.h"
#include "plenoflame/volumes/reconstruct_result.h"

/// A reconstruction in words: what a reader may believe, and what is wrong.
namespace plenoflame {

/// Means over the flame, weighted by light.
struct MeanDeviations {
  std::optional<double> emission;     ///< relative
  std::optional<double> temperature;  ///< [K]
  std::optional<double> absorption;   ///< relative
};
MeanDeviations mean_deviations(const FlameEstimate& estimate, const Unknowns& unknowns);

/// How well the flame is known, and what is wrong with the model. @param cameras their
/// names
std::string verdict(const ReconstructResult& result, const Unknowns& unknowns, UnknownKind kind,
                    const std::vector<std::string>& cameras);

/// A sentence for each quantity that was corrected.
std::vector<std::string> what_was_corrected(const ReconstructResult& result, UnknownKind kind,
                                            const std::vector<std::string>& cameras);

/// A sentence for each thing that the pictures say is wrong: a block that cuts the flame, and
/// quantities of cameras and flame.
std::vector<std::string> what_is_wrong(const ReconstructResult& result, UnknownKind kind,
                                       const std::vector<std::string>& cameras);

}  // namespace plenoflame
