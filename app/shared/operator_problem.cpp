#include "operator_problem.h"

#include <algorithm>
#include <map>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/render.h"

namespace plenoflame {

void set_option(OperatorRequest& request, const std::string& name, const std::string& text) {
  UnknownsRequest& unknowns = request.unknowns;
  const std::map<std::string, std::string*> texts{
      {"unknowns", &unknowns.kind},  {"grid", &unknowns.grid},
      {"center", &unknowns.centre},  {"size", &unknowns.size},
      {"axis", &unknowns.axis},      {"basis", &unknowns.basis},
      {"channel", &request.channel}, {"absorption", &unknowns.absorption},
      {"rays", &request.rays},       {"bin", &request.bin},
      {"seed", &request.seed}};
  const auto found = texts.find(name);
  if (found == texts.end()) throw UsageError("there is no option --" + name);
  *found->second = text;
}

void check_operator(const OperatorRequest& request) {
  check_unknowns(request.unknowns);
  if (request.unknowns.fits_axis())
    throw UsageError("--axis fit takes pictures, which reconstruct has: give a direction");
  whole_number_option("--rays", request.rays, 2, kMostSamples);
  whole_number_option("--bin", request.bin, 1, 10000);
  if (!request.seed.empty()) whole_number_option<std::uint64_t>("--seed", request.seed, 0);
}

std::unique_ptr<OperatorProblem> make_operator_problem(
    const OperatorRequest& request, const std::vector<const CompiledScene*>& scenes,
    const std::string& what, const Execution& execution) {
  check_operator(request);
  const CompiledScene& scene = *scenes.front();
  CameraRaySettings how;
  how.samples = whole_number_option("--rays", request.rays, 2, kMostSamples);
  how.bin = whole_number_option("--bin", request.bin, 1, 10000);
  how.seed = request.seed.empty() ? scene.scene.render.seed
                                  : whole_number_option<std::uint64_t>("--seed", request.seed, 0);
  std::size_t channel = 0;
  if (!request.channel.empty()) {
    const auto& channels = scene.scene.channels;
    const auto found = std::find_if(channels.begin(), channels.end(),
                                    [&](const auto& c) { return c.name == request.channel; });
    if (found == channels.end())
      throw UsageError("--channel: " + what + " has no channel " + request.channel);
    channel = static_cast<std::size_t>(found - channels.begin());
  }
  how.channel = static_cast<int>(channel);
  auto result = std::make_unique<OperatorProblem>();
  result->unknowns = unknowns_of(request.unknowns, scene);
  EmissionProblem& problem = result->problem;
  problem.unknowns = result->unknowns.get();
  problem.absorption = absorption_of(request.unknowns, scene, channel, *result->unknowns);
  problem.model = problem.absorption.empty() ? RowModel::emission : RowModel::source;
  std::vector<CameraView> views;
  for (const CompiledScene* one : scenes) views.push_back({one, {}});
  result->rays = draw_camera_rays(views, result->unknowns->bounds(), how, execution);
  if (result->rays.rows.empty())
    throw InputError("no ray of the camera meets the grid: it lies outside of the picture");
  problem.rays = &result->rays;
  return result;
}

}  // namespace plenoflame
