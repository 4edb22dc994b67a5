#include "commands/render/render_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "commands/moment_options.h"
#include "commands/part_option.h"
#include "commands/scene_input.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/optics/f_number.h"

namespace plenoflame::cli {
namespace {

/// The entry of LightField::texts that says what a frame is of.
constexpr const char* kFrameRun = "frame.run";

/// Narrows the stop for --f-numbers.
void stop_down(MainLensSpec& lens, double f_number) {
  try {
    set_f_number(lens, f_number);
  } catch (const InputError& error) {
    throw UsageError(std::string("--f-numbers: ") + error.what());
  }
}

/// "white.exr", "f5.6" -> "white-f5.6.exr".
std::string with_ending(const std::string& path, const std::string& ending) {
  const std::filesystem::path whole(path);
  return (whole.parent_path() / (whole.stem().string() + "-" + ending + whole.extension().string()))
      .string();
}

std::string f_number_text(double f_number) {
  char text[32];
  std::snprintf(text, sizeof text, "f%g", f_number);
  return text;
}

Picture with_ending(const Picture& picture, const std::string& ending) {
  Picture named = picture;
  named.options.output = with_ending(picture.options.output, ending);
  if (!picture.options.stats.empty())
    named.options.stats = with_ending(picture.options.stats, ending);
  return named;
}

/// A picture at each of the f-numbers.
std::vector<Picture> with_f_numbers(const Picture& picture) {
  const std::vector<double>& numbers = picture.options.f_numbers;
  if (numbers.empty()) return {picture};
  std::vector<Picture> pictures;
  for (const double number : numbers) {
    const std::string ending = f_number_text(number);
    Picture stopped = with_ending(picture, ending);
    stop_down(stopped.document.scene.camera.lens, number);
    for (const Picture& other : pictures)
      if (other.options.output == stopped.options.output)
        throw UsageError(fmt::format("--f-numbers: f/{:g} is given twice", number));
    pictures.push_back(std::move(stopped));
  }
  return pictures;
}

/// A picture of each requested frame or of the requested time; by default, of the first frame.
std::vector<Picture> with_frames(const Picture& picture) {
  const RenderOptions& options = picture.options;
  const bool asked = options.frames || options.time;
  if (!changes_with_time(picture.document.scene)) {
    if (asked)
      throw UsageError(std::string(options.frames ? "--frames" : "--time") +
                       ": no flame of the scene changes with time");
    return {picture};
  }
  const auto timeline = std::make_shared<const SceneTimeline>(picture.document);
  if (!options.frames) {
    Picture one = picture;
    one.timeline = timeline;
    one.begin = begin_of(*timeline, options.time);
    if (!options.time && timeline->frame_rate() > 0) one.frame = timeline->first_frame();
    return {one};
  }
  check_frames(*timeline, *options.frames, picture.document);
  std::vector<Picture> pictures;
  const FrameRange& frames = *options.frames;
  for (int i = 0; i <= (frames.last - frames.first) / frames.step; ++i) {
    Picture one = picture;
    const int frame = frames.first + i * frames.step;
    one.timeline = timeline;
    one.frame = frame;
    one.begin = timeline->begin_of(frame);
    one.options.all_frames = options.output;
    one.options.output = with_frame(options.output, frame);
    if (!options.stats.empty()) one.options.stats = with_frame(options.stats, frame);
    pictures.push_back(std::move(one));
  }
  return pictures;
}

/// FNV-1a, 64 bits (Fowler, Noll, Vo 1991): the same text on every machine.
std::uint64_t hash_of(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

/// All that decides what the frame is, but for the contents of files.
std::string run_text(const Picture& picture, const RenderSettings& s) {
  std::string scenes;
  for (const SceneMoment& moment : picture.moments())
    scenes += fmt::format("{} {}\n", moment.share, write_scene(moment.scene));
  return fmt::format(
      "scene {:016x}; estimator {}; samples {}; target error {}; time limit {} s; seed {}; window "
      "{},{},{},{}; skip {}; control variate {}; truth {}",
      hash_of(scenes), s.estimator == Estimator::forward ? "forward" : "backward", s.samples,
      s.target_error, s.time_limit, s.seed, s.window.x, s.window.y, s.window.width, s.window.height,
      s.skip, s.control_variate, picture.options.truth);
}

/// The differences between two such texts, entry by entry.
std::string differences(const std::string& then, const std::string& now) {
  const auto entries = [](const std::string& text) {
    std::vector<std::string> list;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find("; ", at), text.size());
      list.push_back(text.substr(at, end - at));
      at = end + 2;
    }
    return list;
  };
  const std::vector<std::string> before = entries(then), after = entries(now);
  std::string text;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const std::string old = i < before.size() ? before[i] : "";
    if (old == after[i]) continue;
    text += text.empty() ? "" : "; ";
    text += after[i].starts_with("scene ") ? "the scene is another one"
                                           : old + " then, " + after[i] + " now";
  }
  return text;
}

}  // namespace

std::vector<Picture> pictures_of(const RenderOptions& options) {
  SceneDocument document = read_valid_scene(options.scene, options.set);
  if (options.white) document.scene.flames.clear();
  const bool several = !document.scene.cameras.empty();
  const std::vector<CameraScene> cameras = choose_cameras(document, options.scene, options.cameras);
  const bool named = several && !(options.output_given && options.cameras.size() == 1);
  std::vector<std::vector<Picture>> views;  // each in the order of its frames
  for (const CameraScene& camera : cameras) {
    Picture one{{camera.document}, options};
    if (named) one = with_ending(one, camera.document.scene.camera.name);
    for (const Picture& stopped : with_f_numbers(one)) {
      views.push_back(with_frames(stopped));
      for (Picture& picture : views.back()) {
        if (options.part) picture = with_ending(picture, part_ending(*options.part));
        picture.view = views.size() - 1;
      }
    }
  }
  std::vector<Picture> pictures;
  for (std::size_t frame = 0; frame < views.front().size(); ++frame)
    for (std::vector<Picture>& view : views) pictures.push_back(std::move(view[frame]));
  return pictures;
}

void add_exposure(const Picture& picture, const RenderSettings& settings, RunRecord& record) {
  const double exposure = picture.document.scene.camera.sensor.exposure_time;
  if (exposure > 0 && !picture.options.white) record.numbers["exposure.time"] = exposure;
  if (!picture.timeline) return;
  record.numbers["exposure.begin"] = picture.begin;
  if (picture.frame) record.numbers["frame.number"] = *picture.frame;
  if (picture.options.frames) record.texts[kFrameRun] = run_text(picture, settings);
}

void put_exposure(const RunRecord& record, double flux, LightField& field) {
  for (const auto& [key, value] : record.numbers) field.numbers[key] = value;
  for (const auto& [key, value] : record.texts) field.texts[key] = value;
  if (const auto time = record.numbers.find("exposure.time"); time != record.numbers.end())
    field.numbers["exposure.energy"] = flux * time->second;
}

bool frame_is_done(const Picture& picture, const RenderSettings& settings) {
  const std::string& path = picture.options.output;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return false;
  const LightField field = read_light_field_header(path);
  if (!field.complete) return false;
  const auto run = field.texts.find(kFrameRun);
  const std::string then = run == field.texts.end() ? "" : run->second;
  const std::string now = run_text(picture, settings);
  if (then.empty())
    throw InputError("'" + path +
                     "' is not a frame of this run; move it away, or render without --resume");
  if (then != now)
    throw InputError(
        fmt::format("'{}' is a frame of a run with other options: {}; use the same options, or "
                    "render again without --resume",
                    path, differences(then, now)));
  if (field.version != version())
    throw InputError(fmt::format(
        "'{}' was rendered by Plenoflame {}, and this is {}; render again without --resume", path,
        field.version, version()));
  const auto made = std::filesystem::last_write_time(path, error);
  const std::filesystem::path folder =
      std::filesystem::path(picture.document.scene.file).parent_path();
  for (const SceneMoment& moment : picture.moments())
    for (const FlameSpec& flame : moment.scene.flames) {
      if (flame.file.empty()) continue;
      const auto changed = std::filesystem::last_write_time(folder / flame.file, error);
      if (!error && changed > made) return false;
    }
  return true;
}

}  // namespace plenoflame::cli
