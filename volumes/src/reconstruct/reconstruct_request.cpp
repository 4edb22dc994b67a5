#include "plenoflame/volumes/reconstruct_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

std::array<double, 3> smoothing_of(const ReconstructRequest& request) {
  std::array<double, 3> result{1, 1, 1};
  if (request.smoothing.empty()) return result;
  const std::size_t axes = unknown_axes(request.unknowns.kind);
  if (request.smoothing.size() != axes)
    throw UsageError(fmt::format("{}: {} numbers for {} axes of {}", request.names()("smoothing"),
                                 request.smoothing.size(), axes, name_of(request.unknowns.kind)));
  std::ranges::copy(request.smoothing, result.begin());
  return result;
}

std::string solver_name(ReconstructionSolver solver) {
  return reconstruction_solvers()[static_cast<std::size_t>(solver)];
}

/// A setting that means nothing beside another one.
void refuse(bool wrong, const std::string& setting, const std::string& why) {
  if (wrong) throw UsageError(setting + " " + why);
}

/// Settings that neither the solver nor the penalty uses are refused.
void check_solver(const ReconstructRequest& request, ReconstructionSolver solver) {
  const SettingNames& names = request.names();
  const std::string name = names("solver", solver_name(request.solver));
  const bool prior = !request.prior.empty() || request.prior_values;
  if (!is_penalised(solver)) {
    if (request.strength || prior)
      throw UsageError(fmt::format("{} has no penalty: neither {} nor {} means anything to it",
                                   name, names("strength"), names("prior")));
    refuse(!request.smoothing.empty(), names("smoothing"),
           "means nothing to " + name + ", which has no penalty");
  }
  refuse(!is_penalised(solver) && !request.spreads.empty(), names("spread"),
         "is for solvers with a penalty: " + name + " has no resolution matrix");
  const bool subsets = solver == ReconstructionSolver::sart || solver == ReconstructionSolver::osem;
  refuse(!subsets && request.subsets, names("subsets"), "is for sart and osem");
  const bool relaxed = solver == ReconstructionSolver::sirt ||
                       solver == ReconstructionSolver::sart || solver == ReconstructionSolver::mart;
  refuse(!relaxed && request.relaxation, names("relaxation"), "is for sirt, sart and mart");
  if (!request.relaxation) return;
  if (solver == ReconstructionSolver::mart && *request.relaxation > 1)
    throw UsageError(names("relaxation") + ": at most 1 for mart");
  if (*request.relaxation == 0)
    throw UsageError(names("relaxation") + ": above 0, or nothing changes");
}

/// Each quantity to find needs, and excludes, some of the other settings.
void check_sought(const ReconstructRequest& request) {
  const SettingNames& names = request.names();
  const auto find = [&](const char* what) { return names("find", what); };
  const Sought sought = request.find;
  const bool known = request.unknowns.knows_absorption();
  if (sought == Sought::temperature && !known)
    throw UsageError(fmt::format("{} needs {}; {} finds it from two channels", find("temperature"),
                                 names("absorption"), find("both")));
  if (sought == Sought::both && known)
    throw UsageError(find("both") + " finds the absorption: leave " + names("absorption") + " out");
  for (const double ratio : request.absorption_ratios)
    if (!(ratio > 0)) throw UsageError(names("absorption-ratios") + ": each is above 0");
  const bool linear = sought == Sought::emission;
  const std::string for_emission = "is for " + find("emission");
  refuse(!linear && (!request.prior.empty() || request.prior_values), names("prior"), for_emission);
  refuse(!linear && request.built.rays, names("operator"), for_emission);
  refuse(!linear && !request.spreads.empty(), names("spread"), for_emission);
  refuse(!linear && request.solver != ReconstructionSolver::fista,
         names("solver", solver_name(request.solver)),
         for_emission + ": temperatures are found by Gauss and Newton's method");
  if (request.absorption_error > 0 && sought == Sought::both)
    throw UsageError(names("absorption-error") + ": " + find("both") +
                     " finds the absorption and its deviation");
  refuse(request.absorption_error > 0 && !known, names("absorption-error"),
         "is for a known absorption: give " + names("absorption"));
  const std::size_t channels = request.channels.size();
  if (sought != Sought::both && channels > 1)
    throw UsageError(names("channel") + ": one at a time, unless " + find("both"));
  refuse(sought != Sought::both && !request.absorption_ratios.empty(), names("absorption-ratios"),
         "is for " + find("both"));
}

}  // namespace

std::vector<std::string> reconstruction_solvers() {
  return {"fista", "nnls", "cgls", "lsqr", "sirt", "sart", "mlem", "osem", "mart"};
}

ReconstructionSettings reconstruction_settings(const ReconstructRequest& request,
                                               std::uint64_t seed) {
  const SettingNames& names = request.names();
  check_unknowns(request.unknowns);
  ReconstructionSettings result;
  result.rays.samples = request.rays;
  result.rays.seed = seed;
  take_rows(request.bin, request.cells, result.rays);
  result.solver = request.solver;
  result.penalty_axes = smoothing_of(request);
  result.strength = request.strength.value_or(-1);
  result.evidence = !request.strength;
  result.iterations = request.iterations;
  if (request.subsets) result.subsets = *request.subsets;
  result.relaxation = request.relaxation.value_or(-1);
  result.support = !request.all;
  result.draws = request.draws;
  result.test_model = result.draws > 0;
  result.absorption_error = request.absorption_error;
  result.probes = request.probes;
  result.memory = 1e6 * request.memory;
  result.form = request.form;
  check_solver(request, result.solver);
  check_sought(request);
  const std::string solver = names("solver", solver_name(request.solver));
  refuse(!request.refine.empty() && !is_penalised(result.solver), names("refine"),
         "tests the model against the penalty, which " + solver + " has not");
  refuse(
      result.absorption_error > 0 && !(result.draws > 0 && is_penalised(result.solver)),
      names("absorption-error"),
      "is a part of the deviations, which need " + names("draws") + " and a solver with a penalty");
  refuse(request.refine_axis && request.unknowns.kind != UnknownKind::rings,
         names("refine", "axis"),
         "is for rings, not for " + std::string(name_of(request.unknowns.kind)));
  refuse(wants_matrix(result.solver) && !(result.memory > 0), names("memory", "0"),
         "leaves no room for the stored matrix, whose rows " + solver +
             " goes through; the others follow the rays again");
  refuse(wants_matrix(result.solver) &&
             (request.form == OperatorForm::rays || request.form == OperatorForm::drawn),
         names("form", request.form == OperatorForm::rays ? "rays" : "drawn"),
         "has no matrix, through whose rows " + solver + " goes");
  const bool start = !request.start.empty() || request.start_values;
  if (start && !request.resume.empty())
    throw UsageError(names("start") + " or " + names("resume") + ", not both");
  return result;
}

}  // namespace plenoflame
