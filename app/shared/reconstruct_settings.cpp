#include "reconstruct_settings.h"

#include <fmt/format.h>

#include <algorithm>

#include "options.h"

namespace plenoflame {
namespace {

constexpr double kMostStrength = 1e12, kMostRelaxation = 2, kMany = 100000;

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ","));
}

std::string refined_text(const ReconstructRequest& request) {
  std::vector<std::string> words;
  for (const SuspectKind kind : request.refine) {
    if (kind == SuspectKind::exposure) words.push_back("exposure");
    if (kind == SuspectKind::right) words.push_back("pose");
    if (kind == SuspectKind::focus) words.push_back("focus");
  }
  if (request.refine_axis) words.push_back("axis");
  return joined(words);
}

void set_refined(ReconstructRequest& request, const SettingReader& value) {
  using enum SuspectKind;
  request.refine.clear();
  request.refine_axis = false;
  for (const std::string& word : value.list()) {
    check_choice(value.setting(), word, {"exposure", "pose", "focus", "axis"});
    if (word == "exposure") request.refine.push_back(exposure);
    if (word == "focus") request.refine.push_back(focus);
    if (word == "pose") request.refine.insert(request.refine.end(), {right, up, forward, turn});
    if (word == "axis") request.refine_axis = true;
  }
}

}  // namespace

template <>
std::span<const SettingRow<ReconstructRequest>> setting_rows() {
  using R = ReconstructRequest;
  using enum SettingKind;
  static const std::vector<SettingRow<R>> rows{
      {"find", "WHAT",
       "emission; temperature, with known absorption; both: temperature and absorption, from two "
       "channels",
       setting_choice<&R::find, R>(), any_of("emission", "temperature", "both")},
      {"channel", "NAME",
       "Channel that is reconstructed; for both, two or more with commas between (the pictures' "
       "first)",
       SettingText<R>{[](const R& r) { return joined(r.channels); },
                      [](R& r, const SettingReader& value) { r.channels = value.list(); }}},
      {"absorption-error", "SHARE",
       "Relative standard deviation of a known absorption, alike everywhere: 0.1 for 10 %",
       &R::absorption_error, between(0, 1)},
      {"absorption-ratios", "R[,R]",
       "For both: absorption of the further channels over that of the first (soot: inverse to the "
       "wavelengths)",
       &R::absorption_ratios, between(0, 1e6)},
      {"noise", "SHARE",
       "Standard deviation added to each pixel's own, as a share of the largest value", &R::noise,
       between(0, 1)},
      {"support", "FILE.vdb", "Nothing is where this file's first grid is 0 (.vdb)", &R::support,
       file},
      {"all-voxels", "", "Solve also for places behind dark pixels", &R::all},
      {"solver", "NAME",
       "With a penalty: fista, nnls (few unknowns), cgls or lsqr. Without, stopped by the noise: "
       "sirt, sart, mlem, osem, mart",
       setting_choice<&R::solver, R>(), SettingWords{reconstruction_solvers()}},
      {"smoothing", "A[,B,C]",
       "Weight of the penalty along each axis of the unknowns, e.g. 3,1,1 where depth is x (1,1,1)",
       &R::smoothing, between(0, 1e6)},
      {"strength", "NUMBER", "Of the penalty; 0: none; without it, by cross-validation or evidence",
       &R::strength, between(0, kMostStrength)},
      {"iterations", "N", "At most, of the last solution", &R::iterations, between(1, 1000000)},
      {"subsets", "N", "Of the rows, for sart and osem (4)", &R::subsets, between(1, 1000)},
      {"relaxation", "NUMBER",
       "Of sirt (1.9), sart (1) and mart (0.05): above 0, below 2, for mart up to 1",
       &R::relaxation, between(0, kMostRelaxation)},
      {"prior", "FILE.vdb", "The penalty pulls towards the emission of this earlier result",
       &R::prior, file},
      {"start", "FILE.vdb", "Begin with this earlier result", &R::start, file},
      {"resume", "FILE.vdb",
       "Go on from this result of the same command that was stopped, with its strength", &R::resume,
       file},
      rays_row<R>(),
      bin_row<R>(),
      cells_row<R>(),
      {"draws", "N", "Draws for the standard deviations; 0: none", &R::draws, between(0, kMany)},
      {"probes", "N", "Random vectors for what is resolved; 0: none", &R::probes,
       between(0, kMany)},
      {"spread", "X,Y,Z", "Tell how wide a point at this place becomes; repeatable", &R::spreads,
       lengths},
      {"refine", "WHAT[,...]",
       "Correct what the pictures say is wrong: exposure, pose (place and turn about the line of "
       "sight), focus, axis (of rings)",
       SettingText<R>{refined_text, set_refined}},
      {"memory", "N", "Most memory of the matrix [MB]", &R::memory, between(0, 1000 * kMany)},
      {"form", "FORM",
       "Kept in memory: matrix; rays, followed in each iteration; drawn: nothing, each iteration "
       "draws the rays again; auto: the first that fits",
       setting_choice<&R::form, R>(), any_of("auto", "matrix", "rays", "drawn")},
      {"truth", "", "Compare with the first scene's flames", &R::truth},
      {"seed", "N", "Seed of the rays (default: the scene's + 1000)", &R::seed}};
  return rows;
}

}  // namespace plenoflame
