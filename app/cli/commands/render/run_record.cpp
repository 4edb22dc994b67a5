#include "commands/render/run_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands/render/estimator_name.h"
#include "commands/scene_input.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "plenoflame/film/checkpoint.h"
#include "plenoflame/film/reopened.h"
#include "plenoflame/math/readable.h"
#include "plenoflame/scene/scene_differences.h"
#include "plenoflame/scene/validate.h"

namespace plenoflame::cli {

std::vector<InputFile> files_of(const std::vector<SceneMoment>& moments) {
  std::vector<InputFile> files;
  for (const SceneMoment& moment : moments)
    for (InputFile& file : input_files(moment.scene))
      if (std::none_of(files.begin(), files.end(),
                       [&](const InputFile& other) { return other.name == file.name; }))
        files.push_back(std::move(file));
  return files;
}

namespace {

constexpr std::size_t kMostDifferences = 6;  ///< differences in one message

Isa isa_named(const std::string& text) {
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512})
    if (name(isa) == text) return isa;
  throw InputError("unknown instruction set");
}

std::string text_of(const PixelWindow& w) {
  return w.width > 0 ? fmt::format("{},{},{},{}", w.x, w.y, w.width, w.height) : "the whole sensor";
}

std::string yes_or_no(bool value) {
  return value ? "yes" : "no";
}

/// Names each difference between a run and its continuation.
class Differences {
 public:
  void add(const std::string& what, const std::string& then, const std::string& now) {
    if (then == now) return;
    if (++count_ > kMostDifferences) return;
    text_ += fmt::format("{}{} was {} and is {}", text_.empty() ? "" : "; ", what,
                         then.empty() ? "not given" : then, now.empty() ? "not given" : now);
  }
  void refuse(const std::string& path) const {
    if (count_ == 0) return;
    throw InputError(fmt::format(
        "{} belongs to a run with other options: {}{}; use those of the run to continue it, or "
        "render again without --resume",
        path, text_,
        count_ > kMostDifferences ? fmt::format("; and {} more", count_ - kMostDifferences) : ""));
  }

 private:
  std::size_t count_ = 0;
  std::string text_;
};

void compare_options(const RenderOptions& options, const RunRecord& record, Differences& found) {
  const RenderSettings& then = record.settings;
  if (options.estimator)
    found.add("--estimator", name_of(then.estimator), name_of(*options.estimator));
  if (options.seed) found.add("--seed", std::to_string(then.seed), std::to_string(*options.seed));
  if (options.window) found.add("--window", text_of(then.window), text_of(*options.window));
  if (options.part) found.add("--part", to_string(then.part), to_string(*options.part));
  if (options.white) found.add("--white", yes_or_no(record.white), "yes");
  if (!options.control_variate)
    found.add("--no-control-variate", yes_or_no(!then.control_variate), "yes");
}

void compare_machines(const RunRecord& record, const std::vector<SceneMoment>& moments,
                      Differences& found) {
  found.add("Plenoflame's version", record.version, std::string(version()));
  if (!is_supported(record.settings.isa))
    found.add("the instruction set", std::string(name(record.settings.isa)),
              std::string(name(best_isa())));
  if (moments.size() != record.moments)
    found.add("the number of moments of the exposure", std::to_string(record.moments),
              std::to_string(moments.size()));
  const std::vector<InputFile> now = files_of(moments);
  for (const InputFile& file : record.files) {
    const auto same = std::find_if(now.begin(), now.end(),
                                   [&](const InputFile& other) { return other.name == file.name; });
    if (same == now.end() || *same == file) continue;  // another name is a difference of the scene
    found.add(fmt::format("file '{}'", file.name),
              fmt::format("of {} bytes, changed at {}", file.size, file.modified),
              same->size == 0
                  ? std::string("not there")
                  : fmt::format("of {} bytes, changed at {}", same->size, same->modified));
  }
}

SceneInTime in_time(SceneDocument document) {
  SceneInTime scene{std::move(document)};
  if (changes_with_time(scene.document.scene))
    scene.timeline = std::make_shared<const SceneTimeline>(scene.document);
  return scene;
}

/// The scene of the only camera that the options choose, and when they ask for it.
SceneInTime asked_scene(const RenderOptions& options) {
  SceneInTime now = in_time(
      choose_cameras(read_valid_scene(options.scene, options.set), options.scene, options.cameras)
          .front()
          .document);
  if (now.timeline) now.begin = begin_of(*now.timeline, options.time);
  return now;
}

SceneInTime scene_of(const RenderOptions& options, const RunRecord& record,
                     const SceneInTime* asked, Differences& found) {
  SceneInTime then = in_time(parse_scene(record.scene_text, record.scene_file));
  if (const auto begin = record.numbers.find("exposure.begin"); begin != record.numbers.end())
    then.begin = begin->second;
  if (options.scene.empty()) {
    static_cast<void>(validate(then.document));
    return then;
  }
  SceneInTime now = asked ? *asked : asked_scene(options);
  if (!then.timeline && now.timeline) {
    // The begin of an exposure is within its first moment; so is what it is rendered at.
    now.document.scene = now.timeline->at_time(now.begin);
    now.timeline = nullptr;
  } else if (then.timeline && then.begin != now.begin) {
    found.add("the beginning of the exposure", readable(then.begin, Dimension::time),
              readable(now.begin, Dimension::time));
  }
  if (record.white) now.document.scene.flames.clear();
  for (const SceneDifference& difference :
       scene_differences(then.document.scene, now.document.scene))
    found.add(difference.path, difference.before, difference.after);
  return now;
}

/// The record of the run that made a complete picture, from the picture's attributes.
RunRecord record_of(const LightField& picture, const std::string& path) {
  if (picture.scene_text.empty())
    throw InputError(path + " holds no scene, so it cannot be continued");
  RunRecord record;
  record.version = picture.version;
  record.scene_text = picture.scene_text;
  record.scene_file = std::filesystem::absolute(path).string();
  record.settings.estimator =
      picture.estimator == "forward" ? Estimator::forward : Estimator::backward;
  record.settings.seed = picture.seed;
  record.settings.window = picture.window;
  if (const auto part = picture.texts.find(kPartOfPicture); part != picture.texts.end())
    record.settings.part = part_from(part->second);
  record.white = picture.texts.contains("white");
  for (const char* key : {"exposure.time", "exposure.begin", "frame.number"})
    if (const auto known = picture.numbers.find(key); known != picture.numbers.end())
      record.numbers[key] = known->second;
  if (const auto run = picture.texts.find("frame.run"); run != picture.texts.end())
    record.texts[run->first] = run->second;
  return record;
}

/// Samples per replicate of the tiles that the run is about.
std::vector<double> samples_of_part(const Continuation& run) {
  const Part& part = run.record.settings.part;
  std::vector<double> samples;
  for (int t = 0; t < run.film.tile_count(); ++t)
    if (part_of_tile(t, run.film.tiles_across(), part.count) == part.number - 1)
      samples.push_back(run.film.tile_samples(t));
  if (samples.empty()) samples.push_back(0);
  return samples;
}

/// A state whose tiles have more samples than the run asks for is none: what it asks for would
/// never be reached.
void check_samples(const Continuation& run, const std::string& path) {
  const RenderSettings& settings = run.record.settings;
  for (const auto* counts : {&run.film.all_tile_samples(), &run.film.tile_goals()})
    for (const double count : *counts)
      if (count * settings.replicates > settings.samples)
        throw FileError(path + ": is damaged; start the run again without it");
}

/// Moments of an exposure that are done have their samples: none can be added any more.
void check_same_goal(const RenderOptions& options, const RenderSettings& settings) {
  const auto refuse = [](const char* name, const std::string& then) {
    throw UsageError(
        fmt::format("{} cannot change: the run averages several moments, and some are done; use {} "
                    "as before, or render again without --resume",
                    name, then));
  };
  if (options.samples && *options.samples != settings.samples)
    refuse("--samples", std::to_string(settings.samples));
  if (options.target_error && *options.target_error != settings.target_error)
    refuse("--target-error",
           settings.target_error > 0 ? fmt::format("{:g} %", 100 * settings.target_error) : "none");
}

/// The parts of an exposure's state, from the films that are kept of it.
ExposureState exposure_of(const RunRecord& record, std::vector<Film> films,
                          const std::string& path) {
  if (films.size() != record.moments + 1 || record.exposure.done >= record.moments)
    throw FileError(path + ": is damaged; start the run again without it");
  ExposureState state;
  state.progress = record.exposure;
  state.sums = std::move(films.front());
  films.erase(films.begin());
  state.films = std::move(films);
  return state;
}

}  // namespace

std::vector<SceneMoment> SceneInTime::moments() const {
  if (!timeline) return {{document.scene, 1}};
  return timeline->exposure(begin);
}

double begin_of(const SceneTimeline& timeline, std::optional<double> time) {
  if (time) return *time;
  return timeline.frame_rate() > 0 ? timeline.begin_of(timeline.first_frame())
                                   : timeline.first_time();
}

std::string to_text(const RunRecord& record) {
  const RenderSettings& s = record.settings;
  nlohmann::ordered_json json;
  json["version"] = record.version;
  json["scene"] = record.scene_text;
  json["scene_file"] = record.scene_file;
  json["files"] = nlohmann::json::array();
  for (const InputFile& file : record.files)
    json["files"].push_back({file.name, file.size, file.modified});
  json["estimator"] = name_of(s.estimator);
  json["samples"] = s.samples;
  json["replicates"] = s.replicates;
  json["seed"] = s.seed;
  json["target_error"] = s.target_error;
  json["time_limit"] = s.time_limit;
  json["window"] = {s.window.x, s.window.y, s.window.width, s.window.height};
  json["part"] = to_string(s.part);
  json["skip"] = s.skip;
  json["control_variate"] = s.control_variate;
  json["isa"] = name(s.isa);
  json["white"] = record.white;
  json["truth"] = record.truth;
  json["stats"] = record.stats;
  json["compression"] = record.compression;
  json["seconds"] = record.seconds;
  json["numbers"] = record.numbers;
  json["texts"] = record.texts;
  json["moments"] = record.moments;
  const ExposureProgress& exposure = record.exposure;
  json["exposure"] = {{"pass", exposure.pass},       {"target", exposure.target},
                      {"done", exposure.done},       {"samples", exposure.samples},
                      {"reached", exposure.reached}, {"complete", exposure.complete},
                      {"seconds", exposure.seconds}};
  // Names of files need not be UTF-8.
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

RunRecord record_from(const std::string& text, const std::string& path) {
  try {
    const auto json = nlohmann::json::parse(text);
    RunRecord record;
    RenderSettings& s = record.settings;
    record.version = json.at("version").get<std::string>();
    record.scene_text = json.at("scene").get<std::string>();
    record.scene_file = json.at("scene_file").get<std::string>();
    for (const auto& file : json.at("files"))
      record.files.push_back({file.at(0).get<std::string>(), file.at(1).get<std::uintmax_t>(),
                              file.at(2).get<std::int64_t>()});
    s.estimator = json.at("estimator").get<std::string>() == "forward" ? Estimator::forward
                                                                       : Estimator::backward;
    s.samples = json.at("samples").get<int>();
    s.replicates = json.at("replicates").get<int>();
    s.seed = json.at("seed").get<std::uint64_t>();
    s.target_error = json.at("target_error").get<double>();
    s.time_limit = json.at("time_limit").get<double>();
    const auto& window = json.at("window");
    s.window = {window.at(0).get<int>(), window.at(1).get<int>(), window.at(2).get<int>(),
                window.at(3).get<int>()};
    s.part = part_from(json.at("part").get<std::string>());
    s.skip = json.at("skip").get<bool>();
    s.control_variate = json.at("control_variate").get<bool>();
    s.isa = isa_named(json.at("isa").get<std::string>());
    record.white = json.at("white").get<bool>();
    record.truth = json.at("truth").get<bool>();
    record.stats = json.at("stats").get<std::string>();
    record.compression = json.at("compression").get<std::string>();
    record.seconds = json.at("seconds").get<double>();
    record.numbers = json.at("numbers").get<std::map<std::string, double>>();
    record.texts = json.at("texts").get<std::map<std::string, std::string>>();
    record.moments = json.at("moments").get<std::size_t>();
    const auto& exposure = json.at("exposure");
    record.exposure = {exposure.at("pass").get<int>(),         exposure.at("target").get<double>(),
                       exposure.at("done").get<std::size_t>(), exposure.at("samples").get<double>(),
                       exposure.at("reached").get<bool>(),     exposure.at("complete").get<bool>(),
                       exposure.at("seconds").get<double>()};
    if (s.samples < 1 || s.samples > kMostBundles || s.replicates < 1 || s.replicates > 64 ||
        !(s.target_error >= 0 && s.target_error < 1) || !(s.time_limit >= 0) ||
        !(record.seconds >= 0))
      throw InputError("a number that no run has");
    return record;
  } catch (const std::exception&) {
    throw FileError(
        path +
        ": is damaged or from another version of Plenoflame; start the run again without it");
  }
}

Continuation read_continuation(const RenderOptions& options, const SceneInTime* now) {
  if (!now && !options.scene.empty() &&
      choose_cameras(read_valid_scene(options.scene, options.set), options.scene, options.cameras)
              .size() > 1)
    throw UsageError("--resume continues one file at a time; choose its camera with --camera");
  if (options.scene.empty() && !options.set.empty())
    throw UsageError("--set with --resume needs SCENE");
  const std::string state = state_path(options.resume);
  Continuation run;
  Differences found;
  if (std::filesystem::exists(state)) {
    const std::string key = read_checkpoint_key(state);
    run.record = record_from(key, state);
    compare_options(options, run.record, found);
    run.scene = scene_of(options, run.record, now, found);
    compare_machines(run.record, run.scene.moments(), found);
    found.refuse(state);
    if (run.record.moments > 1)
      run.exposure = exposure_of(run.record, read_checkpoint_films(state, key), state);
    else
      run.film = read_checkpoint(state, key);
    check_samples(run, state);
    return run;
  }
  if (!std::filesystem::exists(options.resume))
    throw FileError(state + ": no such file, and no '" + options.resume +
                    "' either: there is no run to continue");
  run.picture = read_light_field(options.resume);
  if (!run.picture->complete)
    throw FileError(state + ": no such file; '" + options.resume +
                    "' is not complete and cannot be continued without it");
  if (run.picture->numbers.contains("exposure.moments"))
    throw InputError("'" + options.resume +
                     "' is the mean of several moments, so no samples can be added; render it "
                     "again with more samples");
  if (run.picture->texts.contains(kMergedPicture))
    throw InputError(
        "'" + options.resume +
        "' is merged from pictures that differ in their samples or seeds; render one more, with "
        "another --seed, and merge it with them");
  run.record = record_of(*run.picture, options.resume);
  compare_options(options, run.record, found);
  run.scene = scene_of(options, run.record, now, found);
  found.refuse(options.resume);
  run.film = film_of(*run.picture);
  run.record.settings.replicates = run.film.replicates();
  const std::vector<double> tiles = samples_of_part(run);
  const double most = *std::max_element(tiles.begin(), tiles.end()) * run.film.replicates();
  run.record.settings.samples = static_cast<int>(std::min(most, double{kMostBundles}));
  return run;
}

RenderSettings continued_settings(const RenderOptions& options, const Continuation& run) {
  RenderSettings settings = run.record.settings;
  const bool forward = settings.estimator == Estimator::forward;
  settings.skip = settings.skip && options.skip;
  if (run.exposure) {
    check_same_goal(options, settings);
    if (options.time_limit) settings.time_limit = *options.time_limit;
    return settings;
  }
  const std::vector<double> tiles = samples_of_part(run);
  const auto [least, most] = std::minmax_element(tiles.begin(), tiles.end());
  if (options.target_error) settings.target_error = *options.target_error;
  if (options.time_limit)
    settings.time_limit = *options.time_limit;
  else if (settings.time_limit > 0)
    settings.time_limit = std::max(settings.time_limit - run.record.seconds, 1.0);
  // Samples that a complete picture already has add nothing.
  const bool adds =
      options.samples && (!run.picture || *options.samples > *most * settings.replicates);
  if (options.samples && *options.samples < *most * settings.replicates)
    throw UsageError(fmt::format("--samples: the picture has {} already; give more",
                                 *most * settings.replicates));
  if (adds) {
    settings.samples = *options.samples;
  } else if (options.target_error || (run.picture && options.time_limit)) {
    settings.samples = options.samples.value_or(forward ? kMostBundles : kMostSamples);
  } else if (run.picture) {
    if (!options.truth)
      throw UsageError(
          fmt::format("--resume: '{}' is complete; to extend it, add --samples above {}, "
                      "--target-error, --time-limit or --truth",
                      options.resume, *most * settings.replicates));
    // No part of the picture lacks any of these.
    settings.samples = std::max(1, static_cast<int>(*least)) * settings.replicates;
  }
  return settings;
}

}  // namespace plenoflame::cli
