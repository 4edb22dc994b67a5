#include "plenoflame/volumes/reconstructor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <sstream>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/inverse/csr_matrix.h"
#include "plenoflame/math/readable.h"
#include "plenoflame/volumes/grid_file.h"
#include "plenoflame/volumes/grid_samples.h"
#include "plenoflame/volumes/reconstruct_verdict.h"
#include "reconstruct/fitted_unknowns.h"
#include "reconstruct/reconstruct_report.h"
#include "reconstruct/reconstruct_warnings.h"

namespace plenoflame {
namespace {

/// Share of the work before the cameras are tested, of temperatures.
constexpr double kUntested = 0.7;

/// The requested channels, by the names in the first picture.
/// @param filtered filters in the pupil may give one channel two colours
std::vector<std::string> wanted_channels(const ReconstructRequest& request,
                                         const LightField& picture, const std::string& name,
                                         bool filtered) {
  std::vector<std::string> names = request.channels;
  const bool both = request.find == Sought::both;
  if (names.empty()) {
    const std::size_t wanted = both && !(filtered && picture.channels.size() == 1) ? 2 : 1;
    if (picture.channels.size() < wanted)
      throw InputError(name + " has a single channel; both takes two");
    for (std::size_t k = 0; k < wanted; ++k) names.push_back(picture.channels[k].name);
  }
  if (both && names.size() < 2 && !filtered)
    throw UsageError(request.names()("channel") +
                     ": both takes two channels, e.g. 650nm,850nm, or filters of two colours in "
                     "the pupil");
  return names;
}

std::size_t number_of(const Scene& scene, const std::string& name, const std::string& scene_file,
                      const std::string& image) {
  const auto found = std::find_if(scene.channels.begin(), scene.channels.end(),
                                  [&](const ChannelSpec& c) { return c.name == name; });
  if (found == scene.channels.end())
    throw InputError(fmt::format("{} has no channel {}, which {} holds", scene_file, name, image));
  return static_cast<std::size_t>(found - scene.channels.begin());
}

void warn_of_scenes(const ReconstructCameras& cameras, const Execution& execution) {
  for (const ReconstructCamera& camera : cameras.cameras)
    if (!camera.scene->scatterers.empty())
      return execution.warn(camera.what +
                            ": the flame scatters, which is left out: its scattered light is taken "
                            "for emission");
}

std::vector<Vec3> places_of(const Unknowns& unknowns) {
  std::vector<Vec3> places;
  for (std::size_t j = 0; j < unknowns.size(); ++j) places.push_back(unknowns.place(j));
  return places;
}

std::vector<char> read_support(const std::string& path, const Unknowns& unknowns) {
  const std::vector<GridInfo> grids = list_grids(path, false);
  const auto first =
      std::find_if(grids.begin(), grids.end(), [](const GridInfo& g) { return g.readable; });
  if (first == grids.end()) throw InputError(path + " has no grid of numbers");
  std::vector<char> support;
  for (const double value : sample_grid(path, first->name, places_of(unknowns)))
    support.push_back(value != 0);
  if (std::find(support.begin(), support.end(), 1) == support.end())
    throw InputError(fmt::format("grid '{}' of {} is 0 wherever an unknown is", first->name, path));
  return support;
}

std::vector<double> absorption_ratios(const ReconstructRequest& request,
                                      const ReconstructCameras& cameras) {
  std::vector<double> ratios{1};
  if (!request.absorption_ratios.empty()) {
    ratios.insert(ratios.end(), request.absorption_ratios.begin(), request.absorption_ratios.end());
    if (ratios.size() != cameras.channels.size())
      throw UsageError(fmt::format("{}: {} for {} channels, one less than which are wanted",
                                   request.names()("absorption-ratios"), ratios.size() - 1,
                                   cameras.channels.size()));
    return ratios;
  }
  const auto wavelength = [&](std::size_t k) {
    return channel_source(cameras.first().scene, cameras.channels[k]).wavelength();
  };
  for (std::size_t k = 1; k < cameras.channels.size(); ++k) {
    if (!(wavelength(0) > 0) || !(wavelength(k) > 0))
      throw UsageError("a channel of all wavelengths has none: give " +
                       request.names()("absorption-ratios"));
    ratios.push_back(wavelength(0) / wavelength(k));
  }
  return ratios;
}

/// @throws InputError where a picture is that of another one of the cameras
void check_order(const ReconstructCameras& cameras, const std::vector<LightField>& pictures,
                 const std::vector<std::string>& names) {
  for (std::size_t v = 0; v < pictures.size(); ++v) {
    const Scene& own = cameras.cameras[v].scene->scene;
    if (was_taken_by(pictures[v], own)) continue;
    const bool fits = may_be_taken_by(pictures[v], own);
    for (const ReconstructCamera& other : cameras.cameras)
      if (fits ? was_taken_by(pictures[v], other.scene->scene)
               : may_be_taken_by(pictures[v], other.scene->scene))
        throw InputError(
            fmt::format("{} is given for {}, but it is the picture of {}: give the "
                        "pictures in the order of the cameras",
                        names[v], cameras.cameras[v].what, other.what));
  }
}

/// @throws UsageError where cameras cannot be refined
void check_refined(const ReconstructRequest& request, const ReconstructCameras& cameras) {
  if (request.refine.empty()) return;
  for (const ReconstructCamera& camera : cameras.cameras)
    if (!camera.scene->camera.pupil_filters().empty())
      throw UsageError(request.names()("refine") + ": " + camera.what +
                       " has filters in its pupil, whose colours would pass for displacements");
}

FrameMeasurements corrected_exposures(FrameMeasurements measurements,
                                      const std::optional<Refinement>& refinement) {
  if (refinement)
    for (std::vector<Measurement>& of_cameras : measurements)
      for (std::size_t v = 0; v < of_cameras.size(); ++v)
        correct_exposure(of_cameras[v], refinement->exposures[v]);
  return measurements;
}

/// @throws InputError where an earlier result that is in memory belongs to other unknowns
void check_fits(const EarlierResult& result, std::size_t unknowns) {
  for (const auto* values : {&result.emission, &result.temperature, &result.absorption})
    if (!values->empty() && values->size() != unknowns)
      throw InputError(
          fmt::format("the earlier result has {} unknowns, not {}: write it to a file "
                      "and give that, which is sampled where the unknowns are",
                      values->size(), unknowns));
}

/// @throws FileError, InputError: there is none of the grids
EarlierResult read_earlier_result(const std::string& path, const Unknowns& unknowns) {
  EarlierResult result;
  const std::vector<Vec3> places = places_of(unknowns);
  for (const GridInfo& grid : list_grids(path, false)) {
    std::vector<double>* to = grid.name == "emission"      ? &result.emission
                              : grid.name == "temperature" ? &result.temperature
                              : grid.name == "absorption"  ? &result.absorption
                                                           : nullptr;
    if (!to) continue;
    *to = sample_grid(path, grid.name, places);
    if (const auto shape = grid.metadata.find("unknowns"); shape != grid.metadata.end())
      result.shape = shape->second;
    if (const auto input = grid.metadata.find("input"); input != grid.metadata.end())
      result.input = input->second;
    const auto strength = grid.metadata.find("strength");
    if (strength == grid.metadata.end()) continue;
    std::istringstream number(strength->second);
    number.imbue(std::locale::classic());
    if (!(number >> result.strength)) result.strength = -1;
  }
  if (result.emission.empty())
    throw InputError(path + " has no grid 'emission': it is no result of reconstruct");
  return result;
}

/// A number that tells pictures and absorptions apart.
std::string input_of(const FrameMeasurements& measurements, const std::vector<double>& absorption) {
  std::string bytes;
  const auto add = [&](const auto& values) {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  for (const std::vector<Measurement>& channel : measurements)
    for (const Measurement& taken : channel) add(taken.flux.pixels);
  add(absorption);
  return fmt::format("{:x}", csr_work(bytes));
}

}  // namespace

std::vector<CameraView> ReconstructCameras::views() const {
  std::vector<CameraView> result;
  for (const ReconstructCamera& camera : cameras) result.push_back({camera.scene.get(), {}});
  return result;
}

ReconstructCameras reconstruct_cameras(const ReconstructRequest& request,
                                       std::vector<ReconstructCamera> cameras,
                                       const LightField& first,
                                       const std::vector<std::string>& names) {
  if (cameras.empty() || cameras.size() != names.size())
    throw UsageError("a reconstruction needs one picture for each camera");
  ReconstructCameras result;
  result.cameras = std::move(cameras);
  // Other rays than those of the pictures, which may be renderings of the same scene.
  result.seed = request.seed.value_or(result.first().scene.render.seed + 1000);
  const int bin = reconstruction_settings(request, result.seed).rays.bin;
  for (const ReconstructCamera& camera : result.cameras) {
    const SensorSpec& sensor = camera.scene->scene.camera.sensor;
    if (bin > sensor.columns || bin > sensor.rows)
      throw UsageError(fmt::format("{}: the sensor of {} has {} x {} pixels, no block of {} x {}",
                                   request.names()("bin"), camera.what, sensor.columns, sensor.rows,
                                   bin, bin));
  }
  const bool filtered = std::any_of(result.cameras.begin(), result.cameras.end(),
                                    [](const ReconstructCamera& camera) {
                                      return !camera.scene->camera.pupil_filters().empty();
                                    });
  for (const std::string& name : wanted_channels(request, first, names[0], filtered)) {
    const std::string& wanted = find_channel(first, name, names[0]).name;
    for (std::size_t v = 0; v < result.cameras.size(); ++v) {
      const Scene& scene = result.cameras[v].scene->scene;
      const std::size_t number = number_of(scene, wanted, result.cameras[v].what, names[v]);
      if (v == 0) result.channels.push_back(number);
      if (number != result.channels.back() ||
          !(scene.channels[number] == result.first().scene.channels[number]))
        throw InputError(fmt::format("channel {} of {} is not that of {}", wanted,
                                     result.cameras[v].what, result.cameras[0].what));
    }
  }
  for (std::size_t k = 0; k < result.channels.size(); ++k)
    for (std::size_t m = 0; m < k; ++m)
      if (result.channels[k] == result.channels[m])
        throw UsageError(request.names()("channel") + ": " + result.channel_name(k) +
                         " is given twice");
  absorption_ratios(request, result);
  return result;
}

FrameMeasurements measure_frame(const ReconstructRequest& request,
                                const ReconstructCameras& cameras,
                                const std::vector<LightField>& pictures,
                                const std::vector<std::string>& names) {
  FrameMeasurements result(cameras.channels.size());
  check_order(cameras, pictures, names);
  for (std::size_t v = 0; v < cameras.cameras.size(); ++v)
    for (std::size_t k = 0; k < cameras.channels.size(); ++k)
      result[k].push_back(take_measurement(pictures[v], cameras.cameras[v].scene->scene,
                                           cameras.channels[k], request.noise, names[v]));
  return result;
}

void warn_of_pictures(const FrameMeasurements& measurements, const std::vector<std::string>& names,
                      const Execution& execution) {
  for (std::size_t v = 0; v < names.size(); ++v)
    for (const std::vector<Measurement>& channel : measurements) {
      const Measurement& taken = channel[v];
      if (taken.negative > 0)
        execution.warn(fmt::format("{}: {} pixels are below 0 by more than 5 standard deviations",
                                   names[v], taken.negative));
      if (taken.saturated > 0)
        execution.warn(
            fmt::format("{}: {} saturated pixels are left out", names[v], taken.saturated));
    }
}

Reconstructor::Reconstructor(const ReconstructRequest& request, const ReconstructCameras& cameras,
                             const FrameMeasurements& first, const Execution& execution)
    : request_(request), cameras_(cameras) {
  warn_of_scenes(cameras, execution);
  const CompiledScene& scene = cameras.first();
  settings_ = reconstruction_settings(request_, cameras.seed);
  settings_.rays.channel = static_cast<int>(cameras.channels[0]);
  check_refined(request_, cameras);
  if (request_.truth && !scene.medium)
    throw UsageError(request_.names()("truth") + ": the scene has no flame to compare with");
  if (!request_.built.rays)
    request_.unknowns.fitted_block = fitted_block(request_.unknowns, cameras, first[0], execution);
  // The middle of a block by the pictures is no axis yet.
  const bool no_axis = request_.unknowns.kind == UnknownKind::rings && !request_.unknowns.axis &&
                       !request_.unknowns.fits_axis && request_.unknowns.fitted_block;
  if (request_.unknowns.fits_axis || request_.refine_axis || no_axis) {
    try {
      const FlameAxis axis = fitted_axis(request_.unknowns, cameras, first[0], execution);
      request_.unknowns.fitted_axis = {{axis.base, axis.direction}};
    } catch (const InputError&) {
      if (!no_axis) throw;
    }
  }
  unknowns_ = unknowns_of(request_.unknowns, scene);
  const std::size_t quantities = request_.find == Sought::both ? 2 : 1;
  require_vector_memory(settings_, *unknowns_, quantities * unknowns_->size(), 0);
  absorption_ = absorption_of(request_.unknowns, scene, cameras.channels[0], *unknowns_);
  if (!request_.support.empty()) support_ = read_support(request_.support, *unknowns_);
  if (request_.truth)
    truth_ = flame_truth(scene, cameras.channels[0], *unknowns_, request_.find != Sought::emission);
  const auto earlier = [&](const std::shared_ptr<const EarlierResult>& given,
                           const std::string& path) {
    if (!given) return read_earlier_result(path, *unknowns_);
    check_fits(*given, unknowns_->size());
    return *given;
  };
  if (request_.prior_values || !request_.prior.empty())
    prior_ = samples_of(earlier(request_.prior_values, request_.prior).emission, absorption_);
  const bool resumes = !request_.resume.empty();
  const std::string& path = resumes ? request_.resume : request_.start;
  if (!request_.start_values && path.empty()) return;
  const EarlierResult start = earlier(resumes ? nullptr : request_.start_values, path);
  if (const std::string shape = shape_text(*unknowns_);
      resumes && !start.shape.empty() && start.shape != shape)
    throw InputError(fmt::format(
        "{} has {} unknowns, not {}: {} continues the same command, and {} begins "
        "another one from a file",
        path, start.shape, shape, request_.names()("resume"), request_.names()("start")));
  if (resumes && !start.input.empty() && start.input != input_of(first, absorption_))
    throw InputError(fmt::format(
        "{} was found from other pictures, or with another absorption: {} continues the same "
        "command, and {} begins another one from a file",
        path, request_.names()("resume"), request_.names()("start")));
  if (resumes && !request_.strength) settings_.strength = start.strength;
  if (request_.find == Sought::emission) {
    start_ = samples_of(start.emission, absorption_);
  } else if (start.temperature.empty() || start.absorption.empty()) {
    start_emission_ = start.emission;  // it was stopped before there were temperatures
  } else {
    start_temperature_ = start.temperature;
    start_absorption_ = start.absorption;
    start_emission_ = start.emission;
  }
}

/// Samples of the linear problem: emission, or source functions.
std::vector<double> Reconstructor::samples_of(std::vector<double> emission,
                                              const std::vector<double>& absorption) const {
  for (std::size_t j = 0; j < absorption.size(); ++j)
    emission[j] = absorption[j] > 0 ? emission[j] / absorption[j] : 0;
  return samples_of_places(*unknowns_, emission);
}

ReconstructResult Reconstructor::frame(
    const FrameMeasurements& measurements, const Execution& execution,
    const std::function<void(const ReconstructionState&)>& watch) {
  // Refining takes the first half of the progress.
  const bool refines = !refinement_ && !request_.refine.empty();
  if (refines) refine(measurements, part_of_progress(execution, 0, 0.5));
  const FrameMeasurements corrected = corrected_exposures(measurements, refinement_);
  const Execution rest = refines ? part_of_progress(execution, 0.5, 0.5) : execution;
  settings_.watch = watch;
  ReconstructResult result =
      request_.find == Sought::emission ? linear(corrected, rest) : thermal(corrected, rest);
  settings_.watch = nullptr;
  if (refinement_) {
    result.corrections = refinement_->corrections;
    result.settled = refinement_->settled;
  }
  settings_.strength = result.figures.strength;
  result.input = input_of(measurements, absorption_);
  result.uncut_block = uncut_block(result.figures, windowed(views(), corrected[0]), corrected[0],
                                   unknowns_->bounds(), settings_.rays.channel, rest);
  for (const Measurement& measurement : measurements[0])
    result.scale_error = std::max(result.scale_error, measurement.scale_error);
  return result;
}

std::vector<CameraView> Reconstructor::views() const {
  std::vector<CameraView> result = cameras_.views();
  for (std::size_t v = 0; v < result.size(); ++v)
    if (refinement_ && refinement_->scenes[v]) result[v].scene = refinement_->scenes[v].get();
  return result;
}

std::vector<CameraSpec> Reconstructor::camera_specs() const {
  std::vector<CameraSpec> specs;
  for (std::size_t v = 0; v < cameras_.cameras.size(); ++v) {
    specs.push_back(cameras_.cameras[v].scene->scene.camera);
    if (!refinement_ || !refinement_->scenes[v]) continue;
    const CameraSpec& refined = refinement_->scenes[v]->scene.camera;
    specs.back().position = refined.position;
    specs.back().up = refined.up;
    specs.back().focus = refined.focus;
  }
  return specs;
}

void Reconstructor::refine(const FrameMeasurements& measurements, const Execution& execution) {
  refinement_ = refine_cameras(linear_input(measurements), settings_, request_.refine, execution);
  settings_.refined = refinement_->corrections;
  if (!refinement_->settled)
    execution.warn(request_.names()("refine") +
                   ": the corrections have not settled; the model is wrong by more than they can "
                   "mend");
}

ReconstructionInput Reconstructor::linear_input(const FrameMeasurements& measurements) const {
  ReconstructionInput input;
  input.views = views();
  input.measurements = measurements[0];
  input.unknowns = unknowns_.get();
  input.absorption = absorption_;
  input.start = start_;
  input.prior = prior_;
  input.support = support_;
  input.spread_at = request_.spreads;
  input.built = request_.built;
  return input;
}

ReconstructResult Reconstructor::linear(const FrameMeasurements& measurements,
                                        const Execution& execution) {
  ReconstructionInput input = linear_input(measurements);
  ReconstructResult result;
  const SourceFunction source = channel_source(cameras_.first().scene, cameras_.channels[0]);
  // Behind filters each part of the stop has a source function of its own.
  if (parts_of_stop(cameras_.channels[0]).empty()) input.source = &source;
  result.figures = reconstruct(input, settings_, execution);
  result.estimate = estimate_flame(result.figures, *unknowns_, absorption_, source);
  start_ = result.figures.values;
  return result;
}

/// The parts of a channel that the filters in each camera's pupil pass; empty: there are none.
std::vector<std::vector<ThermalPart>> Reconstructor::parts_of_stop(std::size_t channel) const {
  std::vector<std::vector<ThermalPart>> parts;
  bool any = false;
  for (const ReconstructCamera& camera : cameras_.cameras) {
    parts.push_back(thermal_parts(camera.scene->scene, channel));
    any = any || !parts.back().empty();
    if (request_.unknowns.absorption_of_scene)
      take_absorption_of_scene(*camera.scene, channel, *unknowns_, parts.back());
  }
  if (!any) parts.clear();
  return parts;
}

ReconstructResult Reconstructor::thermal(const FrameMeasurements& measurements,
                                         const Execution& execution) {
  ThermalInput input;
  input.views = views();
  input.unknowns = unknowns_.get();
  input.absorption = absorption_;
  input.support = support_;
  input.start_temperature = start_temperature_;
  if (absorption_.empty()) input.start_absorption = start_absorption_;
  input.start_emission = start_emission_;
  const std::vector<double> ratios = absorption_ratios(request_, cameras_);
  for (std::size_t k = 0; k < cameras_.channels.size(); ++k)
    input.channels.push_back({static_cast<int>(cameras_.channels[k]), measurements[k],
                              channel_source(cameras_.first().scene, cameras_.channels[k]),
                              ratios[k], parts_of_stop(cameras_.channels[k])});
  ThermalSettings settings;
  settings.linear = settings_;
  const bool tests = settings_.test_model && input.channels[0].parts.empty();
  ThermalReconstruction found =
      reconstruct_thermal(input, settings, part_of_progress(execution, 0, tests ? kUntested : 1));
  ReconstructResult result;
  result.figures = std::move(found.figures);
  result.figures.resolved = std::move(found.resolved_temperature);
  result.resolved_absorption = std::move(found.resolved_absorption);
  result.estimate = std::move(found.estimate);
  start_temperature_ = result.estimate.temperature;
  start_absorption_ = result.estimate.absorption;
  start_emission_ = result.estimate.emission;
  if (result.figures.complete && tests)
    test_thermal(measurements, found.linear_strength,
                 part_of_progress(execution, kUntested, 1 - kUntested), result);
  return result;
}

/// Tests the cameras by the emission of the first channel, with the absorption that was found.
/// @param strength of a linear reconstruction; negative: it is chosen
void Reconstructor::test_thermal(const FrameMeasurements& measurements, double strength,
                                 const Execution& execution, ReconstructResult& result) const {
  ReconstructionInput input = linear_input(measurements);
  input.absorption = result.estimate.absorption;
  input.start = samples_of(result.estimate.emission, input.absorption);
  input.prior.clear();
  input.spread_at.clear();
  ReconstructionSettings settings = settings_;
  settings.draws = 0;
  settings.probes = std::min(settings.probes, 4);
  settings.strength = strength;
  settings.watch = nullptr;
  settings.test_absorption = !absorption_.empty();  // none if it is a result
  try {
    Reconstruction tested = reconstruct(input, settings, execution);
    result.figures.suspects = std::move(tested.suspects);
    result.figures.grid_share = tested.grid_share;
    result.figures.light_outside = std::move(tested.light_outside);
    if (!tested.camera_deviation.empty())
      add_deviation(tested.camera_deviation,
                    channel_source(cameras_.first().scene, cameras_.channels[0]), result.estimate);
  } catch (const Cancelled&) {
    return;  // temperatures and deviations are all there
  } catch (const std::exception& error) {
    execution.warn(std::string("the cameras were not tested: ") + error.what());
  }
}

Report Reconstructor::report(const ReconstructResult& result, const std::string& output,
                             const Execution& execution) const {
  ReconstructionSettings asked = settings_;
  asked.strength = request_.strength.value_or(-1);  // that of settings_ may have been chosen
  warn_of(result.figures, asked, request_.names(), execution);
  Report report;
  std::vector<std::string> cameras;
  for (const ReconstructCamera& camera : cameras_.cameras) cameras.push_back(camera.what);
  const UnknownKind kind = request_.unknowns.kind;
  const std::string words = verdict(result, *unknowns_, kind, cameras);
  report.add("in words", words, "verdict", words);
  for (const std::string& line : what_is_wrong(result, kind, cameras)) execution.warn(line);
  report_suspects(result, cameras, report);
  std::string names = cameras_.channel_name(0);
  for (std::size_t k = 1; k < cameras_.channels.size(); ++k)
    names += ", " + cameras_.channel_name(k);
  report.add("channel", names, "channel", names);
  report.add("cameras", std::to_string(cameras_.cameras.size()), "cameras",
             cameras_.cameras.size());
  if (request_.unknowns.fitted_block) {
    const Box& box = *request_.unknowns.fitted_block;
    const Vec3 centre = 0.5 * (box.lower + box.upper), size = box.upper - box.lower;
    report.add(
        "block", readable_point(size) + " about " + readable_point(centre) + ", by the pictures",
        "block", {{"center", {centre.x, centre.y, centre.z}}, {"size", {size.x, size.y, size.z}}});
  }
  if (request_.unknowns.fitted_axis) {
    const auto& [p, w] = *request_.unknowns.fitted_axis;
    report.add("axis",
               fmt::format("through {}, {}, {} along {:.4f}, {:.4f}, {:.4f}",
                           readable(p.x, Dimension::length), readable(p.y, Dimension::length),
                           readable(p.z, Dimension::length), w.x, w.y, w.z),
               "axis", {{"point", {p.x, p.y, p.z}}, {"direction", {w.x, w.y, w.z}}});
  }
  report_reconstruction(result, *unknowns_, report);
  if (result.scale_error > 0) {
    const SourceFunction source = channel_source(cameras_.first().scene, cameras_.channels[0]);
    // Two unknown quantities take both channels, whose scales err apart from each other.
    report_scale(result, request_.find == Sought::both ? nullptr : &source, *unknowns_, report);
  }
  if (truth_) report_errors(result.estimate, *truth_, *unknowns_, report);
  if (cameras.size() == 1 && kind == UnknownKind::voxels)
    warn_single_camera(result.figures, *unknowns_,
                       half_angle(cameras_.first(), *unknowns_, settings_.rays), request_.names(),
                       execution, report);
  if (!result.figures.complete)
    report.add(
        "stopped",
        "early: this is what was reached by then; " + request_.names()("resume") + " goes on",
        "complete", false);
  if (!output.empty()) report.add("written", output, "output", output);
  return report;
}

std::string camera_text(const std::string& name) {
  return name.empty() ? "the scene" : "camera \"" + name + "\" of the scene";
}

std::unique_ptr<const FlameReconstruction> reconstruct_flame(const ReconstructRequest& request,
                                                             std::vector<CameraPicture> pictures,
                                                             const Execution& execution,
                                                             const ReconstructWatch& watch) {
  static_cast<void>(reconstruction_settings(request, 1));  // before any work
  if (pictures.empty()) throw UsageError("a reconstruction needs a camera and its picture");
  std::vector<ReconstructCamera> cameras;
  std::vector<std::string> names;
  std::vector<LightField> fields;
  for (CameraPicture& one : pictures) {
    cameras.push_back({one.scene, one.camera});
    names.push_back(one.name);
    fields.push_back(std::move(one.picture));
  }
  auto found = std::make_unique<FlameReconstruction>();
  found->cameras = reconstruct_cameras(request, std::move(cameras), fields.front(), names);
  const FrameMeasurements measured = measure_frame(request, found->cameras, fields, names);
  found->reconstructor =
      std::make_unique<Reconstructor>(request, found->cameras, measured, execution);
  warn_of_pictures(measured, names, execution);
  std::function<void(const ReconstructionState&)> told;
  if (watch) told = [&](const ReconstructionState& state) { watch(state, found->unknowns()); };
  found->result = found->reconstructor->frame(measured, execution, told);
  found->report = found->reconstructor->report(found->result, "", execution);
  return found;
}

}  // namespace plenoflame
