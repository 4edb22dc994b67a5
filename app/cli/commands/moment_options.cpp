#include "commands/moment_options.h"
#include "commands/add_option.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "messages.h"
#include "options.h"
#include "plenoflame/base/error.h"

namespace plenoflame::cli {
namespace {

constexpr std::size_t kMostNamed = 6;  ///< files in one message
constexpr int kMostFrames = 1000000;

int frame_option(const std::string& name, const std::string& text) {
  return whole_number_option(name, text, 0, 1000000000);
}

}  // namespace

void add_moment_options(CLI::App& command, MomentChoice& choice) {
  auto* const frame = add_option(command, "--frame", choice.frame, "N",
                                 "Frame, at the beginning of its exposure (the first)");
  add_option(command, "--time", choice.time, "TIME", "Time since the first frame, e.g. 2.5ms")
      ->excludes(frame);
}

SceneDocument at_moment(const SceneDocument& document, const MomentChoice& choice) {
  if (!choice.given()) {
    if (!changes_with_time(document.scene)) return document;
    say("the scene changes with time, and this is its first frame; choose another with --frame or "
        "--time");
    return {first_moment(document.scene, document.positions), document.positions};
  }
  const char* const name = choice.frame.empty() ? "--time" : "--frame";
  if (!changes_with_time(document.scene))
    throw UsageError(std::string(name) + ": no flame of the scene changes with time");
  const SceneTimeline timeline(document);
  SceneDocument moment = document;
  moment.scene = choice.frame.empty() ? timeline.at_time(time_option("--time", choice.time))
                                      : timeline.at_frame(frame_option("--frame", choice.frame));
  return moment;
}

FrameRange frame_range_option(const std::string& name, const std::string& text) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == ':')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  if (parts.size() > 3) throw UsageError(name + ": write A:B, A:B:STEP or A, not '" + text + "'");
  FrameRange range;
  range.first = range.last = frame_option(name, parts[0]);
  if (parts.size() > 1) range.last = frame_option(name, parts[1]);
  if (parts.size() > 2) range.step = whole_number_option(name, parts[2], 1, 1000000000);
  if (range.last < range.first)
    throw UsageError(fmt::format("{}: the last frame, {}, comes before the first, {}", name,
                                 range.last, range.first));
  if ((range.last - range.first) / range.step >= kMostFrames)
    throw UsageError(fmt::format("{}: {} are more than {} frames", name, text, kMostFrames));
  return range;
}

std::string with_frame(const std::string& path, int frame) {
  const std::filesystem::path whole(path);
  return (whole.parent_path() /
          fmt::format("{}.{:04}{}", whole.stem().string(), frame, whole.extension().string()))
      .string();
}

double time_option(const std::string& name, const std::string& text) {
  return quantity_option(name, text, Dimension::time);
}

void check_frames(const SceneTimeline& timeline, const FrameRange& frames,
                  const SceneDocument& document) {
  // Checks the first and the last frame: if both lie within the series, all do.
  static_cast<void>(timeline.begin_of(frames.first));
  static_cast<void>(timeline.begin_of(frames.last));
  const std::vector<std::string> missing =
      timeline.missing_files(frames.first, frames.last, frames.step);
  if (missing.empty()) return;
  std::string list;
  for (std::size_t i = 0; i < missing.size() && i < kMostNamed; ++i)
    list.append(i == 0 ? "" : ", ").append(missing[i]);
  if (missing.size() > kMostNamed) list += fmt::format(" and {} more", missing.size() - kMostNamed);
  std::size_t flame = 0;
  for (const SceneTimeline::FlameTime& time : timeline.flames())
    if (!time.missing.empty()) flame = time.flame;
  throw InputError(
      document.positions.find(fmt::format("flames[{}].file", flame)),
      fmt::format("{} of the files for frames {} to {} {} missing: {}", missing.size(),
                  frames.first, frames.last, missing.size() == 1 ? "is" : "are", list));
}

}  // namespace plenoflame::cli
