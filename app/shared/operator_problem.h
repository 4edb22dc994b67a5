#pragma once
#include <memory>
#include <string>
#include <vector>

#include "plenoflame/base/part.h"
#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/scene/compile.h"
#include "unknowns_request.h"

namespace plenoflame {

/// A call of `plenoflame operator`, as texts of its options.
struct OperatorRequest {
  UnknownsRequest unknowns;
  std::string channel;  ///< empty: the first
  std::string rays = "64", bin = "1", cells = "3", seed, form = "auto";
};

/// Sets an option by its name, "unknowns" or "rays". @throws UsageError for an unknown name
void set_option(OperatorRequest& request, const std::string& name, const std::string& text);

/// Before any work. @throws UsageError in the words of the command line
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
