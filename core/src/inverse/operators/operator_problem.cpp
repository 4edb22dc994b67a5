#include "plenoflame/inverse/operator_problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "plenoflame/base/available_memory.h"
#include "plenoflame/base/error.h"
#include "plenoflame/film/film.h"
#include "plenoflame/render/render.h"

namespace plenoflame {

namespace {

/// Leaves the views' lines of pixels that belong to a part, counted through all of them: parts that
/// follow each other have rows that do. Returns the numbers of the views that are left.
std::vector<int> restrict_to(const Part& part, int bin, std::vector<CameraView>& views) {
  // Rays are drawn in tiles. Blocks of pixels may lie in two, and are to lie in the same ones.
  const int step = bin == 1 ? 1 : std::lcm(bin, Film::kTile);
  std::vector<int> strips;
  for (CameraView& view : views) {
    view.window = window_of(view);
    strips.push_back((view.window.height + step - 1) / step);
  }
  const std::int64_t all = std::accumulate(strips.begin(), strips.end(), std::int64_t{0});
  const std::int64_t begin = all * (part.number - 1) / part.count,
                     end = all * part.number / part.count;
  std::vector<CameraView> left;
  std::vector<int> numbers;
  std::int64_t before = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto own = [&](std::int64_t strip) {
      return static_cast<int>(std::clamp<std::int64_t>(strip - before, 0, strips[v]));
    };
    const int first = own(begin) * step, last = std::min(own(end) * step, views[v].window.height);
    before += strips[v];
    if (last <= first) continue;
    left.push_back(views[v]);
    left.back().window.y += first;
    left.back().window.height = last - first;
    numbers.push_back(static_cast<int>(v));
  }
  views = std::move(left);
  return numbers;
}

}  // namespace

void take_rows(int bin, int cells, CameraRaySettings& rays) {
  rays.bin = std::max(bin, 1);
  rays.cells = bin == kView ? cells : bin == kMicroImage ? 1 : 0;
}

void check_operator(const OperatorRequest& request) {
  check_unknowns(request.unknowns);
  if (request.unknowns.fits_axis)
    throw UsageError(request.unknowns.names("axis", "fit") +
                     " needs pictures, as in reconstruct; give a direction");
}

std::unique_ptr<OperatorProblem> make_operator_problem(
    const OperatorRequest& request, const std::vector<const CompiledScene*>& scenes,
    const std::string& what, const Execution& execution, const Part& part) {
  check_operator(request);
  const SettingNames& names = request.unknowns.names;
  const CompiledScene& scene = *scenes.front();
  CameraRaySettings how;
  how.samples = request.rays;
  take_rows(request.bin, request.cells, how);
  how.seed = request.seed.value_or(scene.scene.render.seed);
  std::size_t channel = 0;
  if (!request.channel.empty()) {
    const auto& channels = scene.scene.channels;
    const auto found = std::find_if(channels.begin(), channels.end(),
                                    [&](const auto& c) { return c.name == request.channel; });
    if (found == channels.end())
      throw UsageError(names("channel") + ": " + what + " has no channel " + request.channel);
    channel = static_cast<std::size_t>(found - channels.begin());
  }
  how.channel = static_cast<int>(channel);
  auto result = std::make_unique<OperatorProblem>();
  result->unknowns = unknowns_of(request.unknowns, scene);
  // Each thread gathers the entries of a row by unknown.
  require_memory((sizeof(double) + 1.0) * static_cast<double>(result->unknowns->size()) *
                     (execution.thread_count() + 1),
                 fmt::format("rows of {} unknowns", result->unknowns->size()),
                 fmt::format("use a coarser {}, or fewer {}", names("grid"), names("threads")));
  EmissionProblem& problem = result->problem;
  problem.unknowns = result->unknowns.get();
  problem.absorption = absorption_of(request.unknowns, scene, channel, *result->unknowns);
  problem.model = problem.absorption.empty() ? RowModel::emission : RowModel::source;
  std::vector<CameraView> views;
  for (const CompiledScene* one : scenes) views.push_back({one, {}});
  if (how.cells > 0 && !part.is_whole())
    throw UsageError(names("part") +
                     " cannot be used with micro-images, which lie across parts; use pixels or "
                     "blocks (" +
                     names("bin", "N") + ")");
  const std::vector<int> numbers = restrict_to(part, how.bin, views);
  result->rays = rays_of_form(request.form, views, result->unknowns->bounds(), how, execution);
  for (CameraRays::Row& row : result->rays.rows)
    row.view = numbers[static_cast<std::size_t>(row.view)];
  if (result->rays.rows.empty() && part.is_whole())
    throw InputError("no ray of the camera meets the grid, which lies outside of the picture");
  problem.rays = &result->rays;
  return result;
}

}  // namespace plenoflame
