#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/base/part.h"
#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/scene/compile.h"
#include "unknowns_request.h"

namespace plenoflame {

/// A request for an operator.
struct OperatorRequest {
  UnknownsRequest unknowns;
  std::string channel = {};  ///< empty: the first
  int rays = 64;
  int bin = 1;  ///< of rows: N, kMicroImage, kView
  int cells = 3;
  std::optional<std::uint64_t> seed = {};  ///< nothing: the scene's
  std::string form = "auto";
};
template <>
std::span<const SettingRow<OperatorRequest>> setting_rows();

/// Sets a setting of it, or of its unknowns, by its name. @throws UsageError also for an unknown
/// name
void set_option(OperatorRequest& request, const std::string& name, const std::string& text);

/// Before any work. @throws UsageError
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

/// Follows the rays. @param scenes compiled, one for each camera @param what names the first in
/// messages @throws UsageError, InputError, Cancelled
/// @param part of the rows, in their order; may have none
std::unique_ptr<OperatorProblem> make_operator_problem(
    const OperatorRequest& request, const std::vector<const CompiledScene*>& scenes,
    const std::string& what, const Execution& execution, const Part& part = {});

/// All that rows depend on, in words.
std::string operator_work(const OperatorRequest& request,
                          const std::vector<const CompiledScene*>& scenes);

}  // namespace plenoflame
