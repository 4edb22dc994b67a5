#include "reconstruct_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <sstream>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/render.h"
#include "rows_option.h"

namespace plenoflame {
namespace {

constexpr double kMostStrength = 1e12, kMostRelaxation = 2, kMany = 100000;

std::map<std::string, ReconstructionSolver> solvers() {
  using enum ReconstructionSolver;
  return {{"fista", fista}, {"nnls", active_set}, {"cgls", cgls}, {"lsqr", lsqr}, {"sirt", sirt},
          {"sart", sart},   {"mlem", mlem},       {"osem", osem}, {"mart", mart}};
}

std::map<std::string, OperatorForm> forms() {
  using enum OperatorForm;
  return {{"auto", automatic}, {"matrix", matrix}, {"rays", rays}, {"drawn", drawn}};
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) words.push_back(word);
  return words;
}

std::array<double, 3> smoothing_of(const ReconstructRequest& request) {
  std::array<double, 3> result{1, 1, 1};
  if (request.smoothing.empty()) return result;
  const std::vector<std::string> words = split(request.smoothing);
  const std::size_t axes = unknown_axes(request.unknowns);
  if (words.size() != axes)
    throw UsageError(fmt::format("{}: {} numbers for {} axes of {}", request.names()("smoothing"),
                                 words.size(), axes, request.unknowns.kind));
  for (std::size_t a = 0; a < axes; ++a) {
    std::istringstream word(words[a]);
    word.imbue(std::locale::classic());
    if (!(word >> result[a]) || !word.eof() || !(result[a] >= 0) || !(result[a] <= 1e6))
      throw UsageError(request.names()("smoothing") + ": '" + words[a] +
                       "' is no number from 0 to 1e6");
  }
  return result;
}

bool given(const std::string& text) {
  return !text.empty() && text != "none";
}

/// A setting that means nothing beside another one.
void refuse(bool wrong, const std::string& option, const std::string& why) {
  if (wrong) throw UsageError(option + " " + why);
}

/// Settings that neither the solver nor the penalty uses are refused.
void check_solver(const ReconstructRequest& request, ReconstructionSolver solver) {
  const SettingNames& names = request.names();
  const std::string name = names("solver", request.solver);
  const bool prior = !request.prior.empty() || request.prior_values;
  if (!is_penalised(solver)) {
    if (request.strength || prior)
      throw UsageError(fmt::format("{} has no penalty: neither {} nor {} means anything to it",
                                   name, names("strength"), names("prior")));
    refuse(given(request.smoothing), names("smoothing"),
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
  if (request.solver == "mart" && *request.relaxation > 1)
    throw UsageError(names("relaxation") + ": at most 1 for mart");
  if (*request.relaxation == 0)
    throw UsageError(names("relaxation") + ": above 0, or nothing changes");
}

/// Each quantity to find needs, and excludes, some of the other settings.
void check_sought(const ReconstructRequest& request) {
  const SettingNames& names = request.names();
  const auto find = [&](const char* what) { return names("find", what); };
  const Sought sought = request.sought();
  const bool known = given(request.unknowns.absorption);
  if (sought == Sought::temperature && !known)
    throw UsageError(fmt::format("{} needs {}; {} finds it from two channels", find("temperature"),
                                 names("absorption"), find("both")));
  if (sought == Sought::both && known)
    throw UsageError(find("both") + " finds the absorption: leave " + names("absorption") + " out");
  const bool linear = sought == Sought::emission;
  const std::string for_emission = "is for " + find("emission");
  refuse(!linear && (!request.prior.empty() || request.prior_values), names("prior"), for_emission);
  refuse(!linear && request.built.rays, names("operator"), for_emission);
  refuse(!linear && !request.spreads.empty(), names("spread"), for_emission);
  refuse(!linear && request.solver != "fista", names("solver", request.solver),
         for_emission + ": temperatures are found by Gauss and Newton's method");
  if (request.absorption_error > 0 && sought == Sought::both)
    throw UsageError(names("absorption-error") + ": " + find("both") +
                     " finds the absorption and its deviation");
  refuse(request.absorption_error > 0 && !known, names("absorption-error"),
         "is for a known absorption: give " + names("absorption"));
  const std::size_t channels = request.channels().size();
  if (sought != Sought::both && channels > 1)
    throw UsageError(names("channel") + ": one at a time, unless " + find("both"));
  refuse(sought != Sought::both && !request.ratio.empty(), names("absorption-ratios"),
         "is for " + find("both"));
}

}  // namespace

std::vector<std::string> reconstruction_solvers() {
  std::vector<std::string> names;
  for (const auto& [name, solver] : solvers()) names.push_back(name);
  return names;
}

Sought ReconstructRequest::sought() const {
  return find == "both"          ? Sought::both
         : find == "temperature" ? Sought::temperature
                                 : Sought::emission;
}

std::vector<std::string> ReconstructRequest::channels() const {
  return split(channel);
}

std::vector<SuspectKind> ReconstructRequest::refined() const {
  std::vector<SuspectKind> kinds;
  for (const std::string& word : split(refine)) {
    check_choice(names()("refine"), word, {"exposure", "pose", "focus", "axis"});
    if (word == "exposure") kinds.push_back(SuspectKind::exposure);
    if (word == "focus") kinds.push_back(SuspectKind::focus);
    if (word == "pose")
      kinds.insert(kinds.end(),
                   {SuspectKind::right, SuspectKind::up, SuspectKind::forward, SuspectKind::turn});
  }
  return kinds;
}

bool ReconstructRequest::refines_axis() const {
  return std::ranges::count(split(refine), "axis") > 0;
}

template <>
std::span<const SettingRow<ReconstructRequest>> setting_rows() {
  using R = ReconstructRequest;
  using enum SettingKind;
  static const std::vector<SettingRow<R>> rows{
      {"find",
       "WHAT",
       "emission; temperature, with known absorption; both: temperature and absorption, from two "
       "channels",
       &R::find,
       word,
       {"emission", "temperature", "both"}},
      {"channel", "NAME",
       "Channel that is reconstructed; for both, two or more with commas between (the pictures' "
       "first)",
       &R::channel},
      {"absorption-error",
       "SHARE",
       "Relative standard deviation of a known absorption, alike everywhere: 0.1 for 10 %",
       &R::absorption_error,
       number,
       {},
       0,
       1},
      {"absorption-ratios", "R[,R]",
       "For both: absorption of the further channels over that of the first (soot: inverse to the "
       "wavelengths)",
       &R::ratio},
      {"noise",
       "SHARE",
       "Standard deviation added to each pixel's own, as a share of the largest value",
       &R::noise,
       number,
       {},
       0,
       1},
      {"support", "FILE.vdb", "Nothing is where this file's first grid is 0 (.vdb)", &R::support,
       file},
      {"all-voxels", "", "Solve also for places behind dark pixels", &R::all, flag},
      {"solver", "NAME",
       "With a penalty: fista, nnls (few unknowns), cgls or lsqr. Without, stopped by the noise: "
       "sirt, sart, mlem, osem, mart",
       &R::solver, word, reconstruction_solvers()},
      {"smoothing", "A[,B,C]",
       "Weight of the penalty along each axis of the unknowns, e.g. 3,1,1 where depth is x (1,1,1)",
       &R::smoothing},
      {"strength",
       "NUMBER",
       "Of the penalty; 0: none; without it, by cross-validation",
       &R::strength,
       number,
       {},
       0,
       kMostStrength},
      {"iterations", "N", "At most, of the last solution", &R::iterations, whole, {}, 1, 1000000},
      {"subsets", "N", "Of the rows, for sart and osem (4)", &R::subsets, whole, {}, 1, 1000},
      {"relaxation",
       "NUMBER",
       "Of sirt (1.9), sart (1) and mart (0.05): above 0, below 2, for mart up to 1",
       &R::relaxation,
       number,
       {},
       0,
       kMostRelaxation},
      {"prior", "FILE.vdb", "The penalty pulls towards the emission of this earlier result",
       &R::prior, file},
      {"start", "FILE.vdb", "Begin with this earlier result", &R::start, file},
      {"resume", "FILE.vdb",
       "Go on from this result of the same command that was stopped, with its strength", &R::resume,
       file},
      rays_row<R>(),
      bin_row<R>(),
      cells_row<R>(),
      {"draws", "N", "Draws for the standard deviations; 0: none", &R::draws, whole, {}, 0, kMany},
      {"probes",
       "N",
       "Random vectors for what is resolved; 0: none",
       &R::probes,
       whole,
       {},
       0,
       kMany},
      {"spread", "X,Y,Z", "Tell how wide a point at this place becomes; repeatable", &R::spreads,
       lengths},
      {"refine", "WHAT[,...]",
       "Correct what the pictures say is wrong: exposure, pose (place and turn about the line of "
       "sight), focus, axis (of rings)",
       &R::refine},
      {"memory", "N", "Most memory of the matrix [MB]", &R::memory, whole, {}, 0, 1000 * kMany},
      {"form",
       "FORM",
       "Kept in memory: matrix; rays, followed in each iteration; drawn: nothing, each iteration "
       "draws the rays again; auto: the first that fits",
       &R::form,
       word,
       {"auto", "matrix", "rays", "drawn"}},
      {"truth", "", "Compare with the first scene's flames", &R::truth, flag},
      {"seed", "N", "Seed of the rays (default: the scene's + 1000)", &R::seed, whole}};
  return rows;
}

void set_option(ReconstructRequest& request, const std::string& name, const std::string& text) {
  const SettingNames names = request.names();
  if (!set_setting(request, names, name, text) && !set_setting(request.unknowns, names, name, text))
    throw UsageError("there is no setting " + names(name));
}

ReconstructionSettings reconstruction_settings(const ReconstructRequest& request,
                                               std::uint64_t seed) {
  const SettingNames& names = request.names();
  check_unknowns(request.unknowns);
  ReconstructionSettings result;
  result.rays.samples = request.rays;
  result.rays.seed = seed;
  take_rows(request, result.rays);
  result.solver = solvers().at(request.solver);
  result.penalty_axes = smoothing_of(request);
  result.strength = request.strength.value_or(-1);
  result.iterations = request.iterations;
  if (request.subsets) result.subsets = *request.subsets;
  result.relaxation = request.relaxation.value_or(-1);
  result.support = !request.all;
  result.draws = request.draws;
  result.test_model = result.draws > 0;
  result.absorption_error = request.absorption_error;
  result.probes = request.probes;
  result.memory = 1e6 * request.memory;
  result.form = forms().at(request.form);
  for (const std::string& spread : request.spreads) point_option(names("spread"), spread);
  check_solver(request, result.solver);
  check_sought(request);
  const std::string solver = names("solver", request.solver);
  refuse(!request.refined().empty() && !is_penalised(result.solver), names("refine"),
         "tests the model against the penalty, which " + solver + " has not");
  refuse(
      result.absorption_error > 0 && !(result.draws > 0 && is_penalised(result.solver)),
      names("absorption-error"),
      "is a part of the deviations, which need " + names("draws") + " and a solver with a penalty");
  refuse(request.refines_axis() && request.unknowns.kind != "rings", names("refine", "axis"),
         "is for rings, not for " + request.unknowns.kind);
  refuse(wants_matrix(result.solver) && !(result.memory > 0), names("memory", "0"),
         "leaves no room for the stored matrix, whose rows " + solver +
             " goes through; the others follow the rays again");
  refuse(wants_matrix(result.solver) && (request.form == "rays" || request.form == "drawn"),
         names("form", request.form), "has no matrix, through whose rows " + solver + " goes");
  const bool start = !request.start.empty() || request.start_values;
  if (start && !request.resume.empty())
    throw UsageError(names("start") + " or " + names("resume") + ", not both");
  return result;
}

}  // namespace plenoflame
