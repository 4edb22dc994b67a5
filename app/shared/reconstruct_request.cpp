#include "reconstruct_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/render.h"
#include "rows_option.h"

namespace plenoflame {
namespace {

constexpr double kMostStrength = 1e12, kMostRelaxation = 2;

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
    throw UsageError(fmt::format("--smoothing: {} numbers for {} axes of {}", words.size(), axes,
                                 request.unknowns.kind));
  for (std::size_t a = 0; a < axes; ++a) {
    std::istringstream word(words[a]);
    word.imbue(std::locale::classic());
    if (!(word >> result[a]) || !word.eof() || !(result[a] >= 0) || !(result[a] <= 1e6))
      throw UsageError("--smoothing: '" + words[a] + "' is no number from 0 to 1e6");
  }
  return result;
}

bool given(const std::string& text) {
  return !text.empty() && text != "none";
}

/// An option that means nothing beside another one.
void refuse(bool wrong, const std::string& option, const std::string& why) {
  if (wrong) throw UsageError(option + " " + why);
}

void check_words(const ReconstructRequest& request) {
  check_choice("--find", request.find, {"emission", "temperature", "both"});
  check_choice("--solver", request.solver, reconstruction_solvers());
  check_choice("--form", request.form, {"auto", "matrix", "rays", "drawn"});
  check_unknowns(request.unknowns);
}

/// Options that neither the solver nor the penalty uses are refused.
void check_solver(const ReconstructRequest& request, ReconstructionSolver solver) {
  const std::string name = "--solver " + request.solver;
  const bool prior = !request.prior.empty() || request.prior_values;
  if (!is_penalised(solver)) {
    if (request.strength >= 0 || prior)
      throw UsageError(name +
                       " has no penalty: neither --strength nor --prior means anything to it");
    refuse(given(request.smoothing), "--smoothing",
           "means nothing to " + name + ", which has no penalty");
  }
  refuse(!is_penalised(solver) && !request.spreads.empty(), "--spread",
         "is for solvers with a penalty: " + name + " has no resolution matrix");
  const bool subsets = solver == ReconstructionSolver::sart || solver == ReconstructionSolver::osem;
  refuse(!subsets && !request.subsets.empty(), "--subsets", "is for sart and osem");
  const bool relaxed = solver == ReconstructionSolver::sirt ||
                       solver == ReconstructionSolver::sart || solver == ReconstructionSolver::mart;
  refuse(!relaxed && request.relaxation >= 0, "--relaxation", "is for sirt, sart and mart");
  if (request.solver == "mart" && request.relaxation > 1)
    throw UsageError("--relaxation: at most 1 for mart");
  if (request.relaxation == 0) throw UsageError("--relaxation: above 0, or nothing changes");
}

/// Each quantity to find needs, and excludes, some of the other options.
void check_sought(const ReconstructRequest& request) {
  const Sought sought = request.sought();
  const bool known = given(request.unknowns.absorption);
  if (sought == Sought::temperature && !known)
    throw UsageError(
        "--find temperature needs --absorption; --find both finds it from two channels");
  if (sought == Sought::both && known)
    throw UsageError("--find both finds the absorption: leave --absorption out");
  if (sought != Sought::emission && (!request.prior.empty() || request.prior_values))
    throw UsageError("--prior is for --find emission");
  if (sought != Sought::emission && !request.spreads.empty())
    throw UsageError("--spread is for --find emission");
  if (sought != Sought::emission && request.solver != "fista")
    throw UsageError("--solver " + request.solver +
                     " is for --find emission: temperatures are found by Gauss and Newton's "
                     "method");
  if (request.absorption_error > 0 && sought == Sought::both)
    throw UsageError("--absorption-error: --find both finds the absorption and its deviation");
  if (request.absorption_error > 0 && !known)
    throw UsageError("--absorption-error is for a known absorption: give --absorption");
  const std::size_t channels = request.channels().size();
  if (sought != Sought::both && channels > 1)
    throw UsageError("--channel: one at a time, unless --find both");
  if (sought != Sought::both && !request.ratio.empty())
    throw UsageError("--absorption-ratios is for --find both");
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
    check_choice("--refine", word, {"exposure", "pose", "focus", "axis"});
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

void set_option(ReconstructRequest& request, const std::string& name, const std::string& text) {
  UnknownsRequest& unknowns = request.unknowns;
  const std::map<std::string, std::string*> texts{{"unknowns", &unknowns.kind},
                                                  {"grid", &unknowns.grid},
                                                  {"center", &unknowns.centre},
                                                  {"size", &unknowns.size},
                                                  {"axis", &unknowns.axis},
                                                  {"basis", &unknowns.basis},
                                                  {"absorption", &unknowns.absorption},
                                                  {"find", &request.find},
                                                  {"channel", &request.channel},
                                                  {"solver", &request.solver},
                                                  {"smoothing", &request.smoothing},
                                                  {"absorption-ratios", &request.ratio},
                                                  {"start", &request.start},
                                                  {"resume", &request.resume},
                                                  {"prior", &request.prior},
                                                  {"support", &request.support},
                                                  {"refine", &request.refine},
                                                  {"rays", &request.rays},
                                                  {"iterations", &request.iterations},
                                                  {"draws", &request.draws},
                                                  {"probes", &request.probes},
                                                  {"bin", &request.bin},
                                                  {"cells", &request.cells},
                                                  {"seed", &request.seed},
                                                  {"subsets", &request.subsets},
                                                  {"memory", &request.memory},
                                                  {"form", &request.form}};
  if (const auto found = texts.find(name); found != texts.end()) {
    *found->second = text;
  } else if (name == "strength") {
    request.strength = number_option("--strength", text, 0, kMostStrength);
  } else if (name == "noise") {
    request.noise = number_option("--noise", text, 0, 1);
  } else if (name == "absorption-error") {
    request.absorption_error = number_option("--absorption-error", text, 0, 1);
  } else if (name == "relaxation") {
    request.relaxation = number_option("--relaxation", text, 0, kMostRelaxation);
  } else if (name == "spread") {
    request.spreads.push_back(text);
  } else if (name == "truth" || name == "all-voxels") {
    check_choice("--" + name, text, {"true", "false"});
    (name == "truth" ? request.truth : request.all) = text == "true";
  } else {
    throw UsageError("there is no option --" + name);
  }
}

ReconstructionSettings reconstruction_settings(const ReconstructRequest& request,
                                               std::uint64_t seed) {
  check_words(request);
  ReconstructionSettings result;
  result.rays.samples = whole_number_option("--rays", request.rays, 2, kMostSamples);
  result.rays.seed = seed;
  rows_option(request.bin, request.cells, result.rays);
  result.solver = solvers().at(request.solver);
  result.penalty_axes = smoothing_of(request);
  result.strength = request.strength;
  result.iterations = whole_number_option("--iterations", request.iterations, 1, 1000000);
  if (!request.subsets.empty())
    result.subsets = whole_number_option("--subsets", request.subsets, 1, 1000);
  result.relaxation = request.relaxation;
  result.support = !request.all;
  result.draws = whole_number_option("--draws", request.draws, 0, 100000);
  result.test_model = result.draws > 0;
  result.absorption_error = request.absorption_error;
  result.probes = whole_number_option("--probes", request.probes, 0, 100000);
  result.memory = 1e6 * whole_number_option("--memory", request.memory, 0, 100000000);
  result.form = forms().at(request.form);
  for (const std::string& spread : request.spreads) point_option("--spread", spread);
  check_solver(request, result.solver);
  check_sought(request);
  refuse(!request.refined().empty() && !is_penalised(result.solver), "--refine",
         "tests the model against the penalty, which --solver " + request.solver + " has not");
  refuse(result.absorption_error > 0 && !(result.draws > 0 && is_penalised(result.solver)),
         "--absorption-error",
         "is a part of the deviations, which need --draws and a solver with a penalty");
  refuse(request.refines_axis() && request.unknowns.kind != "rings", "--refine axis",
         "is for rings, not for " + request.unknowns.kind);
  refuse(wants_matrix(result.solver) && !(result.memory > 0), "--memory 0",
         "leaves no room for the stored matrix, whose rows --solver " + request.solver +
             " goes through; the others follow the rays again");
  refuse(wants_matrix(result.solver) && (request.form == "rays" || request.form == "drawn"),
         "--form " + request.form,
         "has no matrix, through whose rows --solver " + request.solver + " goes");
  const bool start = !request.start.empty() || request.start_values;
  if (start && !request.resume.empty()) throw UsageError("--start or --resume, not both");
  return result;
}

}  // namespace plenoflame
