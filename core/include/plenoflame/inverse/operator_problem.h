#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/base/part.h"
#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/unknowns_request.h"

namespace plenoflame {

/// Pixels of a row of a linear problem, in place of blocks of N x N: whole micro-images, or cells
/// within each.
inline constexpr int kMicroImage = -1, kView = -2;

/// Sets the pixels that make a row. @param bin N, kMicroImage or kView @param cells of kView
void take_rows(int bin, int cells, CameraRaySettings& rays);

/// A request for an operator.
struct OperatorRequest {
  UnknownsRequest unknowns;
  std::string channel = {};                ///< empty: the first
  int rays = 64;                           ///< per pixel and microlens that covers it
  int bin = 1;                             ///< of rows: N, kMicroImage, kView
  int cells = 3;                           ///< of a micro-image along each side, for kView
  std::optional<std::uint64_t> seed = {};  ///< nothing: the scene's
  OperatorForm form = OperatorForm::automatic;
};

/// Checks a request before any work. @throws UsageError
void check_operator(const OperatorRequest& request);

/// The linear problem of some cameras with the rays that make it. Not copied: `problem` points to
/// its own rays and unknowns.
struct OperatorProblem {
  OperatorProblem() = default;
  OperatorProblem(const OperatorProblem&) = delete;
  OperatorProblem& operator=(const OperatorProblem&) = delete;

  std::unique_ptr<Unknowns> unknowns;
  CameraRays rays;
  EmissionProblem problem;
};

/// Follows the rays. @param scenes compiled, one for each camera
/// @param what names the first in messages @param part of the rows, in their order; may have none
/// @throws UsageError, InputError, Cancelled
std::unique_ptr<OperatorProblem> make_operator_problem(
    const OperatorRequest& request, const std::vector<const CompiledScene*>& scenes,
    const std::string& what = "the scene", const Execution& execution = {}, const Part& part = {});

}  // namespace plenoflame
