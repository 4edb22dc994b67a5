#include "plenoflame/inverse/refine.h"

#include <algorithm>
#include <cmath>

#include "inverse/displaced_camera.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"

namespace plenoflame {
namespace {

constexpr int kRounds = 6;
/// Part of its deviation by which a quantity may move in the last round.
constexpr double kSettled = 0.5;

/// Adds what was found to the corrections. @return true if all of them have settled
bool add_corrections(const std::vector<Suspect>& suspects, std::span<const SuspectKind> kinds,
                     std::vector<Suspect>& corrections) {
  bool settled = true;
  for (const Suspect& suspect : suspects) {
    if (!suspect.named || std::ranges::find(kinds, suspect.kind) == kinds.end()) continue;
    settled &= suspect.significance() < kSettled;
    const auto known = std::ranges::find_if(
        corrections, [&](const Suspect& other) { return other.is_same(suspect); });
    if (known == corrections.end()) {
      corrections.push_back(suspect);
      continue;
    }
    known->estimate = suspect.kind == SuspectKind::exposure
                          ? (1 + known->estimate) * (1 + suspect.estimate) - 1
                          : known->estimate + suspect.estimate;
    known->deviation = suspect.deviation;
  }
  return settled;
}

/// Scenes and exposures with these corrections.
void apply(const std::vector<CameraView>& views, Refinement& refinement) {
  refinement.scenes.assign(views.size(), nullptr);
  refinement.exposures.assign(views.size(), 1);
  for (std::size_t v = 0; v < views.size(); ++v) {
    Scene moved = views[v].scene->scene;
    moved.flames.clear();
    bool any = false;
    for (const Suspect& correction : refinement.corrections) {
      if (correction.view != v) continue;
      if (correction.kind == SuspectKind::exposure)
        refinement.exposures[v] = 1 + correction.estimate;
      else
        displace(moved.camera, correction.kind, correction.estimate), any = true;
    }
    if (any) refinement.scenes[v] = std::make_shared<const CompiledScene>(compile(moved));
  }
}

}  // namespace

void correct_exposure(Measurement& measurement, double exposure) {
  const auto factor = static_cast<float>(1 / exposure);
  for (float& value : measurement.flux.pixels) value *= factor;
  for (float& value : measurement.deviation.pixels) value *= factor;
  measurement.electron /= exposure;
  measurement.dark /= exposure;
  measurement.model_error /= exposure;
}

Refinement refine_cameras(const ReconstructionInput& input, ReconstructionSettings settings,
                          std::span<const SuspectKind> kinds, const Execution& execution) {
  settings.draws = 0;  // tests need no deviations
  settings.probes = std::min(settings.probes, 4);
  settings.test_model = true;
  Refinement result;
  apply(input.views, result);
  ReconstructionInput moved = input;
  moved.spread_at.clear();
  for (int round = 0; round < kRounds; ++round) {
    settings.corrected = result.corrections;
    const Reconstruction found = reconstruct(
        moved, settings,
        part_of_progress(execution, static_cast<double>(round) / kRounds, 1. / kRounds));
    if (!found.complete) throw Cancelled();
    result.settled = add_corrections(found.suspects, kinds, result.corrections);
    apply(input.views, result);
    if (result.settled) break;
    for (std::size_t v = 0; v < input.views.size(); ++v) {
      moved.views[v].scene = result.scenes[v] ? result.scenes[v].get() : input.views[v].scene;
      moved.measurements[v] = input.measurements[v];
      correct_exposure(moved.measurements[v], result.exposures[v]);
    }
    settings.strength = found.strength;
    moved.start = found.values;
  }
  return result;
}

}  // namespace plenoflame
