#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/report.h"
#include "plenoflame/volumes/reconstruct_result.h"

namespace plenoflame::cli {

/// Content of the page beside the figures.
struct ReconstructPage {
  const ReconstructResult& result;
  const Unknowns& unknowns;
  const Report& report;
  std::vector<std::string> pictures;  ///< names, as many as there are residuals
  const FlameTruth* truth = nullptr;  ///< nullptr: not known
};

/// The report as a page of HTML that needs no other file. It begins with the verdict. It shows
/// figures, slices (beside the truth), the unexplained part of each picture, the tested strengths
/// and the history.
std::string reconstruct_page(const ReconstructPage& page);

}  // namespace plenoflame::cli
