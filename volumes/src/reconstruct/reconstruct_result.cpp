#include "plenoflame/volumes/reconstruct_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "plenoflame/base/error.h"
#include "plenoflame/inverse/measurement.h"
#include "plenoflame/inverse/unknowns_request.h"
#include "plenoflame/math/readable.h"
#include "plenoflame/scene/pupil_transmission.h"
#include "plenoflame/volumes/grid_writer.h"
#include "plenoflame/volumes/reconstruct_verdict.h"
#include "reconstruct/reconstruct_report.h"

namespace plenoflame {

double half_angle(const CompiledScene& scene, const Unknowns& unknowns,
                  const CameraRaySettings& settings) {
  const Box box = unknowns.bounds();
  const Vec3 middle = 0.5 * (box.lower + box.upper);
  const double reach = 0.02 * length(box.upper - box.lower);
  const Vec3 around{reach, reach, reach};
  // Rays that pass the middle, by the directions that they come from.
  const CameraRays rays =
      draw_camera_rays({{&scene, {}}}, {middle - around, middle + around}, settings);
  if (rays.rays.empty()) return 0;
  Vec3 mean;
  for (const CameraRay& ray : rays.rays) mean = mean + ray.direction;
  mean = normalize(mean);
  double squares = 0;
  for (const CameraRay& ray : rays.rays) {
    const Vec3 d = ray.direction - dot(ray.direction, mean) * mean;
    squares += dot(d, d);
  }
  // A disc of radius R has the mean square R^2 / 2.
  return std::asin(std::min(1.0, std::sqrt(2 * squares / static_cast<double>(rays.rays.size()))));
}

std::vector<ReconstructedField> reconstructed_fields(const ReconstructResult& result) {
  const FlameEstimate& estimate = result.estimate;
  std::vector<ReconstructedField> fields;
  const auto add = [&](const std::vector<double>& values, const char* name, const char* unit) {
    if (!values.empty()) fields.push_back({name, unit, &values});
  };
  add(estimate.temperature, "temperature", "K");
  add(estimate.temperature_deviation, "temperature_deviation", "K");
  add(estimate.absorption, "absorption", "1/m");
  add(estimate.absorption_deviation, "absorption_deviation", "1/m");
  add(estimate.emission, "emission", "W/(m^3 sr)");
  add(estimate.emission_deviation, "emission_deviation", "W/(m^3 sr)");
  add(result.figures.resolved, "resolved", "");
  add(result.resolved_absorption, "resolved_absorption", "");
  return fields;
}

VoxelField on_voxels(const ReconstructedField& field, const Unknowns& unknowns) {
  VoxelField voxels = unknowns.field(*field.values, field.name);
  if (field.name != "temperature") return voxels;
  constexpr auto kLeast = static_cast<float>(kAmbient);
  voxels.background = std::max(voxels.background, kLeast);
  for (float& value : voxels.values) value = std::max(value, kLeast);
  return voxels;
}

std::string shape_text(const Unknowns& unknowns) {
  return fmt::format("{}", fmt::join(unknowns.shape(), " x "));
}

void write_estimate(const std::string& path, const ReconstructResult& result,
                    const Unknowns& unknowns) {
  const std::vector<ReconstructedField> found = reconstructed_fields(result);
  std::vector<VoxelField> fields;
  for (const ReconstructedField& field : found) fields.push_back(on_voxels(field, unknowns));
  std::vector<GridOutput> grids;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (!std::all_of(fields[i].values.begin(), fields[i].values.end(),
                     [](float value) { return std::isfinite(value); }))
      throw InputError(
          fmt::format("'{}' is not written: {} has a value that is no finite number; a "
                      "value of the scene, of the pictures or of the options is far "
                      "out of range",
                      path, found[i].name));
    grids.push_back({&fields[i], found[i].unit});
    // A continued run takes up this strength, on this grid and from these pictures.
    if (found[i].name == "emission")
      grids.back().metadata = {{"strength", fmt::format("{:.17g}", result.figures.strength)},
                               {"unknowns", shape_text(unknowns)},
                               {"input", result.input}};
  }
  GridWriteOptions options;
  options.metadata = {{"creator", "plenoflame reconstruct"}};
  write_grids(path, grids, options);
}

FlameTruth flame_truth(const CompiledScene& scene, std::size_t channel, const Unknowns& unknowns,
                       bool temperatures) {
  FlameTruth truth;
  const PupilFilters& filters = scene.camera.pupil_filters();
  const bool filtered = !filters.empty();
  double passed = 1;
  if (filtered) {
    const std::vector<double> areas = filters.areas();
    const std::vector<double> shares = pupil_transmission(scene.scene, channel);
    passed = std::inner_product(areas.begin(), areas.end(), shares.begin(), 0.0);
  }
  const SourceFunction open = channel_source(scene.scene, channel);
  for (std::size_t j = 0; j < unknowns.size(); ++j) {
    const FlameAt at = flame_at(scene, channel, unknowns.place(j));
    truth.emission.push_back(filtered && temperatures ? at.absorption * open(at.temperature)
                                                      : at.emission / passed);
    truth.temperature.push_back(at.emission > 0 ? at.temperature : 0);
    truth.absorption.push_back(at.absorption);
  }
  return truth;
}

void report_errors(const FlameEstimate& estimate, const FlameTruth& truth, const Unknowns& unknowns,
                   Report& report) {
  std::vector<double> volumes;
  for (std::size_t j = 0; j < unknowns.size(); ++j) volumes.push_back(unknowns.volume(j));
  const EstimateErrors errors =
      compare_estimate(estimate, truth.emission, truth.temperature, volumes, truth.absorption);
  report.add("error of emission", readable_percent(errors.emission), "truth_emission_error",
             errors.emission);
  if (!estimate.temperature.empty())
    report.add("error of temperature",
               readable_percent(errors.temperature) + ", weighted by emission",
               "truth_temperature_error", errors.temperature);
  if (!estimate.absorption_deviation.empty())
    report.add("error of absorption",
               readable_percent(errors.absorption) + ", weighted by emission",
               "truth_absorption_error", errors.absorption);
}

namespace {

/// "0.5 mm x 4 mm" along the axes of the unknowns.
std::string widths_of(const PointSpread& spread, const Unknowns& unknowns) {
  std::vector<std::string> widths;
  for (std::size_t a = 0; a < 3; ++a)
    if (unknowns.shape()[a] > 1)
      widths.push_back(std::isfinite(spread.widths[a])
                           ? readable(spread.widths[a], Dimension::length)
                           : "the whole grid");
  return fmt::format("{}", fmt::join(widths, " x "));
}

std::string readable_place(Vec3 p) {
  return fmt::format("{}, {}, {}", readable(p.x, Dimension::length),
                     readable(p.y, Dimension::length), readable(p.z, Dimension::length));
}

nlohmann::json json_of(const PointSpread& spread, const Unknowns& unknowns) {
  nlohmann::json widths = nlohmann::json::array();
  for (std::size_t a = 0; a < 3; ++a)
    if (unknowns.shape()[a] > 1)
      widths.push_back(std::isfinite(spread.widths[a]) ? nlohmann::json(spread.widths[a])
                                                       : nlohmann::json());
  const Vec3 p = spread.place;
  return {{"place", {p.x, p.y, p.z}}, {"widths", widths}, {"peak", spread.peak}};
}

}  // namespace

void report_reconstruction(const ReconstructResult& result, const Unknowns& unknowns,
                           Report& report) {
  const Reconstruction& reconstruction = result.figures;
  const FlameEstimate& estimate = result.estimate;
  const auto count = [](std::size_t n) { return std::to_string(n); };
  report.add("rows", count(reconstruction.rows), "rows", reconstruction.rows);
  if (reconstruction.left_out > 0)
    report.add_text("left out", count(reconstruction.left_out) + " rows with unusable pixels");
  report.add_json("rows_left_out", reconstruction.left_out);
  report.add("rays", count(reconstruction.rays), "rays", reconstruction.rays);
  report.add("unknowns", count(unknowns.size()), "unknowns", unknowns.size());
  report.add("unseen", count(reconstruction.unseen) + " that no ray meets", "unseen",
             reconstruction.unseen);
  report.add("empty", count(reconstruction.empty) + " behind dark pixels", "empty",
             reconstruction.empty);
  report.add("matrix",
             fmt::format("{:.4g} MB{}", 1e-6 * reconstruction.matrix_bytes,
                         reconstruction.stored  ? ""
                         : reconstruction.drawn ? " is not stored: rays drawn again"
                                                : " is not stored: rays followed again"),
             "matrix_bytes", reconstruction.matrix_bytes);
  report.add_json("stored", reconstruction.stored);
  report.add_json("rays_kept", !reconstruction.drawn);
  report.add("error of the rays", readable_percent(reconstruction.rays_error.overall) + " of a row",
             "ray_error", reconstruction.rays_error.overall);
  // A run that was stopped early may have chosen no strength.
  if (reconstruction.strength >= 0)
    report.add("strength", readable_number(reconstruction.strength), "strength",
               reconstruction.strength);
  if (reconstruction.ratio_strength > 0)
    report.add("its ratios", readable_number(reconstruction.ratio_strength), "ratio_strength",
               reconstruction.ratio_strength);
  report.add("chi^2 per row", readable_number(reconstruction.chi_squared), "chi_squared",
             reconstruction.chi_squared);
  report.add_json("noise_chi_squared", reconstruction.noise_chi_squared);
  if (reconstruction.absorption_error > 0)
    report.add("absorption",
               fmt::format("known to {:.3g} %, which the deviations hold",
                           100 * reconstruction.absorption_error),
               "absorption_error", reconstruction.absorption_error);
  if (reconstruction.noise_factor > 1)
    report.add_text("model", fmt::format("the pictures differ from it by {:.3g} times their noise; "
                                         "the deviations hold that",
                                         reconstruction.noise_factor));
  report.add_json("noise_factor", reconstruction.noise_factor);
  if (reconstruction.chain) {
    report.add_text("Markov chain",
                    fmt::format("{:.2f} times as wide as the linearised problem; {:.0f} % of its "
                                "steps are taken",
                                reconstruction.chain->width, 100 * reconstruction.chain->accepted));
    report.add_json("chain_width", reconstruction.chain->width);
    report.add_json("chain_accepted", reconstruction.chain->accepted);
  }
  if (reconstruction.rendered_chi_squared >= 0)
    report.add("as rendered",
               "chi^2 per row " + readable_number(reconstruction.rendered_chi_squared) +
                   " of temperatures and absorptions, which are interpolated before they shine",
               "rendered_chi_squared", reconstruction.rendered_chi_squared);
  report.add("iterations", count(reconstruction.history.size()), "iterations",
             reconstruction.history.size());
  report.add_json("history", reconstruction.history);
  nlohmann::json trials = nlohmann::json::array();
  for (const auto& trial : reconstruction.trials)
    trials.push_back({{"strength", trial.strength},
                      {"chi_squared", trial.chi_squared},
                      {"penalty", trial.penalty},
                      {"gcv", trial.gcv}});
  report.add_json("trials", trials);
  report.add_json("strength_at_end", reconstruction.strength_at_end);
  report.add_json("explained_by_noise", reconstruction.explained_by_noise);
  report.add("ended by", name_of(reconstruction.reason), "reason", name_of(reconstruction.reason));
  if (reconstruction.clipped > 0)
    report.add("clipped", count(reconstruction.clipped) + " rows below 0 were taken for 0",
               "rows_clipped", reconstruction.clipped);
  if (reconstruction.resolved_unknowns >= 0) {
    const std::size_t all = unknowns.size() * (result.resolved_absorption.empty() ? 1 : 2);
    report.add(
        "resolved",
        fmt::format("{:.0f} of {} unknowns ({})", reconstruction.resolved_unknowns, all,
                    readable_percent(reconstruction.resolved_unknowns / static_cast<double>(all))),
        "resolved_unknowns", reconstruction.resolved_unknowns);
  }
  nlohmann::json spreads = nlohmann::json::array();
  for (const PointSpread& spread : reconstruction.spreads) {
    report.add_text("point spread",
                    fmt::format("{} wide, {} of the point stay, at {}", widths_of(spread, unknowns),
                                readable_percent(spread.peak), readable_place(spread.place)));
    spreads.push_back(json_of(spread, unknowns));
  }
  for (const PointSpread& spread : reconstruction.resolution)
    report.add(
        "resolution",
        widths_of(spread, unknowns) + " where it is brightest, at " + readable_place(spread.place),
        "resolution", json_of(spread, unknowns));
  if (!spreads.empty()) report.add_json("point_spreads", spreads);
  // Weighted by what emits, as what does not emit has no temperature.
  double weight = 0, sum = 0, hottest = 0, brightest = 0;
  for (std::size_t j = 0; j < estimate.emission.size(); ++j) {
    brightest = std::max(brightest, estimate.emission[j]);
    if (estimate.temperature.empty() || !(estimate.temperature[j] > 0)) continue;
    weight += unknowns.volume(j) * estimate.emission[j];
    sum += unknowns.volume(j) * estimate.emission[j] * estimate.temperature[j];
    hottest = std::max(hottest, estimate.temperature[j]);
  }
  const MeanDeviations deviations = mean_deviations(estimate, unknowns);
  report.add("emission", fmt::format("{:.4g} W/(m^3 sr) at most", brightest), "largest_emission",
             brightest);
  if (deviations.emission)
    report.add("its deviation", readable_percent(*deviations.emission) + ", mean",
               "emission_deviation", *deviations.emission);
  if (weight > 0) {
    report.add("temperature",
               readable(sum / weight, Dimension::temperature) + " mean, weighted by emission; " +
                   readable(hottest, Dimension::temperature) + " at most",
               "mean_temperature_K", sum / weight);
    report.add_json("highest_temperature_K", hottest);
    if (deviations.temperature)
      report.add("its deviation",
                 readable(*deviations.temperature, Dimension::temperature) + ", mean",
                 "temperature_deviation_K", *deviations.temperature);
  }
}

void report_suspects(const ReconstructResult& result, const std::vector<std::string>& cameras,
                     Report& report) {
  static constexpr const char* kNames[] = {"exposure", "stray_light", "right", "up",
                                           "forward",  "turn",        "focus", "absorption"};
  const auto list = [&](const std::vector<Suspect>& all, bool tests) {
    nlohmann::json suspects = nlohmann::json::array();
    for (const Suspect& suspect : all) {
      suspects.push_back({{"quantity", kNames[static_cast<int>(suspect.kind)]},
                          {"estimate", suspect.estimate},
                          {"deviation", suspect.deviation}});
      if (suspect.kind != SuspectKind::absorption)
        suspects.back()["camera"] = cameras.at(suspect.view);
      if (tests) suspects.back()["named"] = suspect.named;
    }
    return suspects;
  };
  report.add_json("suspects", list(result.figures.suspects, true));
  report.add_json("grid_share", result.figures.grid_share);
  if (!result.corrections.empty()) report.add_json("corrected", list(result.corrections, false));
  report.add_json("light_outside", result.figures.light_outside);
}

void report_scale(const ReconstructResult& result, const SourceFunction* source,
                  const Unknowns& unknowns, Report& report) {
  const FlameEstimate& estimate = result.estimate;
  std::string text = readable_percent(result.scale_error) + " of all emission together";
  double weight = 0, sum = 0;
  for (std::size_t j = 0; source != nullptr && j < estimate.temperature.size(); ++j) {
    const double w = unknowns.volume(j) * estimate.emission[j];
    const double slope = source_slope(*source, estimate.temperature[j]);
    if (!(slope > 0)) continue;
    weight += w;
    sum += w * result.scale_error * (*source)(estimate.temperature[j]) / slope;
  }
  if (weight > 0) {
    text += ", " + readable(sum / weight, Dimension::temperature) + " of the temperature";
    report.add_json("scale_error_K", sum / weight);
  }
  report.add("error of the scale", text + ", besides", "scale_error", result.scale_error);
}

}  // namespace plenoflame
