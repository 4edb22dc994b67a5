#pragma once
#include <string>
#include <vector>

#include "reconstruct_result.h"

namespace plenoflame::cli {

/// Content of the page beside the figures.
struct ReconstructPage {
  const ReconstructResult& result;
  const Unknowns& unknowns;
  const Report& report;
  std::vector<std::string> pictures;  ///< names, as many as there are residuals
  const FlameTruth* truth = nullptr;  ///< nullptr: not known
};

/// The report as a page of HTML that needs no other file: figures, slices (beside the truth), what
/// is not explained of each picture, the strengths that were tried and the history.
std::string reconstruct_page(const ReconstructPage& page);

}  // namespace plenoflame::cli
