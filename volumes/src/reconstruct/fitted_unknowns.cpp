#include "reconstruct/fitted_unknowns.h"

#include <algorithm>
#include <exception>

#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/inverse/flame_block.h"
#include "plenoflame/inverse/light_behind.h"

namespace plenoflame {
namespace {

/// Share of its sides that a block by the pictures has beyond the light on each side; the same with
/// blur and stray light.
constexpr double kBeyondLight = 1.0 / 12, kBeyondBlur = 0.15;

/// True if a box holds the light of another one, which is by the pictures.
/// @param share of the sides of the other that need not be inside, on each side
bool holds(const Box& box, const Box& other, double share) {
  const Vec3 margin = share * (other.upper - other.lower);
  const auto side = [](double lower, double upper, double least, double most, double beyond) {
    return lower <= least + beyond && upper >= most - beyond;
  };
  return side(box.lower.x, box.upper.x, other.lower.x, other.upper.x, margin.x) &&
         side(box.lower.y, box.upper.y, other.lower.y, other.upper.y, margin.y) &&
         side(box.lower.z, box.upper.z, other.lower.z, other.upper.z, margin.z);
}

}  // namespace

std::vector<CameraView> windowed(std::vector<CameraView> views,
                                 const std::vector<Measurement>& measurements) {
  for (std::size_t v = 0; v < views.size(); ++v) views[v].window = measurements[v].window;
  return views;
}

std::optional<Box> fitted_block(const UnknownsRequest& request, const ReconstructCameras& cameras,
                                const std::vector<Measurement>& measurements,
                                const Execution& execution) {
  if (!request.fits_block()) return {};
  const std::vector<CameraView> views = windowed(cameras.views(), measurements);
  for (const CameraView& view : views)
    if (shines_without_flames(*view.scene)) return {};
  const Execution quiet = without_reports(execution);
  Box box = block_of(request, cameras.first());
  if (!box.empty()) {
    CameraRaySettings how;
    how.samples = 16;
    how.channel = static_cast<int>(cameras.channels[0]);
    const CameraRays rays = rays_of_form(OperatorForm::automatic, views, box, how, quiet);
    const std::vector<double> outside = light_outside(views, measurements, rays, how.bin);
    if (std::ranges::all_of(outside, [](double share) { return share <= kLightCut; })) return {};
  } else if (request.centre) {
    box = {*request.centre, *request.centre};
  }
  const auto channel = static_cast<int>(cameras.channels[0]);
  try {
    const Box found = block_of_light(views, measurements, box, quiet, channel);
    // Stray light passes beside every block.
    if (!box.empty() && holds(box, found, kBeyondBlur)) return {};
    return found;
  } catch (const InputError&) {
    if (box.empty() || !(length(box.upper - box.lower) > 0)) throw;
    return {};  // the block of the scene's flames is as good as any
  }
}

std::optional<Box> uncut_block(const Reconstruction& figures, const std::vector<CameraView>& views,
                               const std::vector<Measurement>& measurements, const Box& known,
                               int channel, const Execution& execution) {
  // A little light may be the end of a flame, if something is wrong.
  const bool wrong = !figures.explained_by_noise;
  const double least = wrong ? 0 : kLightCut;
  if (std::ranges::all_of(figures.light_outside, [&](double share) { return share <= least; }))
    return {};
  try {
    const Box found =
        block_of_light(views, measurements, known, without_reports(execution), channel);
    if (holds(known, found, wrong ? kBeyondLight : kBeyondBlur)) return {};
    return found;
  } catch (const std::exception&) {
    return {};  // the flame stays as it is
  }
}

FlameAxis fitted_axis(const UnknownsRequest& request, const ReconstructCameras& cameras,
                      const std::vector<Measurement>& measurements, const Execution& execution) {
  const std::unique_ptr<Unknowns> unknowns = unknowns_of(request, cameras.first());
  const Box box = unknowns->bounds();
  CameraRaySettings how;
  how.samples = 16;
  how.channel = static_cast<int>(cameras.channels[0]);
  const std::vector<CameraView> views = windowed(cameras.views(), measurements);
  const CameraRays rays = draw_camera_rays(views, box, how, without_reports(execution));
  FlameAxis start;
  start.base = 0.5 * (box.lower + box.upper);
  start.direction = {0, 0, 1};
  if (request.axis) start.direction = *request.axis;
  MeasuredRows measured = measured_rows(measurements, rays, 1);
  take_away(light_behind(views, rays, *unknowns, {}, how, execution), measured);
  return fit_axis(rays, measured, start);
}

}  // namespace plenoflame
