#include "plenoflame/scene/timeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "scene/files/file_series.h"
#include "scene/files/time_table.h"
#include "scene/scene_folder.h"
#include "scene/schema/nearest.h"

namespace plenoflame {
namespace {

constexpr double kMostPieces = 1e5;  ///< of one exposure

/// A time in units of frames. Times are sums and quotients of decimal numbers: one that is as near
/// to a frame's begin as their rounding is that begin.
double in_frames(double time, double rate) {
  constexpr double kRounding = 1e-9;
  const double frames = time * rate, whole = std::round(frames);
  return std::fabs(frames - whole) <= kRounding * std::max(1.0, std::fabs(whole)) ? whole : frames;
}

std::string in_words(double time) {
  return readable_quantity(time, Dimension::time, 6);
}

/// The number of a frame, as whole numbers of files.
int to_frame(double number) {
  constexpr double kMost = std::numeric_limits<int>::max();
  return static_cast<int>(std::clamp(number, -kMost, kMost));
}

struct Changing {
  std::size_t flame = 0;
  std::string key;  ///< path of the flame in its scene
  std::optional<FileSeries> series;
  double rate = 0;
  std::string table_file;
  std::optional<TimeTable> table;
};

Changing read_changing(const Scene& scene, std::size_t index, const PositionMap& positions) {
  const FlameSpec& flame = scene.flames[index];
  Changing changing;
  changing.flame = index;
  changing.key = "flames[" + std::to_string(index) + "]";
  const auto naming = [&](const std::string& key, auto&& action) {
    const SourcePosition here = positions.find(key);
    const std::string where = to_string(here);
    try {
      action();
    } catch (const InputError& error) {
      if (where.empty() || !error.position().file.empty()) throw;
      throw InputError(here, error.what());
    } catch (const FileError& error) {
      if (where.empty()) throw;
      throw FileError(where + ": " + error.what());
    }
  };
  if (flame.time.is_series()) {
    changing.rate = flame.time.frame_rate;
    naming(changing.key + ".file",
           [&] { changing.series.emplace(flame.file, folder_of(scene), flame.time.first_frame); });
  }
  if (!flame.time.table.empty()) {
    changing.table_file = flame.time.table;
    const std::string folder = folder_of(scene);
    const bool absolute = flame.time.table.starts_with('/') || folder.empty();
    naming(changing.key + ".time_table", [&] {
      changing.table.emplace(absolute ? flame.time.table : folder + "/" + flame.time.table);
    });
  }
  return changing;
}

}  // namespace

struct SceneTimeline::State {
  Scene scene;
  PositionMap positions;
  std::vector<Changing> flames;
  double rate = 0;  ///< of pictures
  double delay = 0, exposure = 0;
  int steps = 1, first_number = 0;

  double first_time() const {
    double first = -kInfinity;
    for (const Changing& flame : flames) {
      if (flame.series) first = std::max(first, 0.0);
      if (flame.table) first = std::max(first, flame.table->first_time());
    }
    return first;
  }
  double end_time() const {
    double end = kInfinity;
    for (const Changing& flame : flames) {
      if (flame.series) end = std::min(end, flame.series->size() / flame.rate);
      if (flame.table) end = std::min(end, flame.table->last_time());
    }
    return end;
  }
  [[noreturn]] void fail(const Changing& flame, const char* key, const std::string& message) const {
    throw InputError(positions.find(flame.key + key), message);
  }

  /// Tells whether all flames are known from one time to another (the same: an instant).
  void check(double begin, double end) const {
    const std::string what =
        end > begin ? "an exposure from " + in_words(begin) + " to " + in_words(end) + " reaches "
                    : in_words(begin) + " is ";
    for (const Changing& flame : flames) {
      if (flame.series) {
        const double size = flame.series->size();
        const std::string which =
            fmt::format("the series {}, whose files {} to {} last until {}",
                        quote_for_message(flame.series->pattern()), flame.series->first(),
                        flame.series->last(), in_words(size / flame.rate));
        if (in_frames(begin, flame.rate) < 0)
          fail(flame, ".file", what + "before the beginning of " + which);
        const double last = in_frames(end, flame.rate);
        if (last > size || (last == size && !(end > begin)))
          fail(flame, ".file", what + "beyond the end of " + which);
      }
      if (flame.table) {
        const double first = flame.table->first_time(), last = flame.table->last_time();
        const double rounding = 1e-9 * (std::fabs(first) + std::fabs(last));
        if (begin < first - rounding || end > last + rounding)
          fail(flame, ".time_table",
               fmt::format(
                   "{}{} {}, which holds from {} to {}", what,
                   begin < first - rounding ? "before the beginning of" : "beyond the end of",
                   quote_for_message(flame.table_file), in_words(first), in_words(last)));
      }
    }
  }

  int file_at(const Changing& flame, double time) const {
    const double place = std::floor(in_frames(time, flame.rate));
    return flame.series->first() +
           static_cast<int>(std::clamp(place, 0.0, flame.series->size() - 1.0));
  }

  /// The scene at a time that check() has found good.
  Scene at(double time) const {
    Scene now = scene;
    for (const Changing& flame : flames) {
      FlameSpec& spec = now.flames[flame.flame];
      if (flame.series) {
        const int number = file_at(flame, time);
        if (flame.series->is_missing(number))
          fail(flame, ".file",
               "the series " + quote_for_message(flame.series->pattern()) + " lacks the file " +
                   quote_for_message(flame.series->name(number)));
        spec.file = flame.series->name(number);
      }
      if (flame.table) spec = flame.table->at(time, std::move(spec));
      spec.time = {};
    }
    return now;
  }

  /// Times at which one of the flames changes within an exposure, with its begin and end.
  std::vector<double> cuts(double begin, double end) const {
    std::vector<double> times{begin, end};
    bool tables = false;
    for (const Changing& flame : flames) {
      tables = tables || flame.table;
      if (!flame.series) continue;
      const double from = in_frames(begin, flame.rate), to = in_frames(end, flame.rate);
      if (to - from > kMostPieces)
        fail(flame, ".frame_rate",
             fmt::format("an exposure of {} covers {:.3g} files of the series; is the rate right?",
                         in_words(end - begin), to - from));
      for (double k = std::floor(from) + 1; k < to; ++k) times.push_back(k / flame.rate);
    }
    for (int i = 1; tables && i < steps; ++i) times.push_back(begin + (end - begin) * i / steps);
    std::sort(times.begin(), times.end());
    std::vector<double> apart;
    for (const double time : times)
      if (apart.empty() || time - apart.back() > 1e-9 * (end - begin)) apart.push_back(time);
    apart.back() = end;
    return apart;
  }
};

bool changes_with_time(const Scene& scene) {
  return std::any_of(scene.flames.begin(), scene.flames.end(),
                     [](const FlameSpec& flame) { return flame.time.present(); });
}

SceneTimeline::SceneTimeline(const Scene& scene, const PositionMap& positions) {
  if (!changes_with_time(scene)) throw InputError("no flame of the scene changes with time");
  auto state = std::make_unique<State>();
  state->scene = scene;
  state->positions = positions;
  const SensorSpec& sensor =
      scene.cameras.empty() ? scene.camera.sensor : scene.cameras.front().sensor;
  state->rate = sensor.frame_rate;
  state->delay = sensor.exposure_begin;
  state->exposure = sensor.exposure_time;
  state->steps = sensor.exposure_steps;
  bool first = true;
  for (std::size_t i = 0; i < scene.flames.size(); ++i) {
    if (!scene.flames[i].time.present()) continue;
    state->flames.push_back(read_changing(scene, i, positions));
    const Changing& flame = state->flames.back();
    if (!flame.series || !first) continue;
    first = false;
    state->first_number = flame.series->first();
    if (!(state->rate > 0)) state->rate = flame.rate;
  }
  state_ = std::move(state);
}

SceneTimeline::~SceneTimeline() = default;
SceneTimeline::SceneTimeline(SceneTimeline&&) noexcept = default;

double SceneTimeline::frame_rate() const {
  return state_->rate;
}
double SceneTimeline::first_time() const {
  return state_->first_time();
}
double SceneTimeline::end_time() const {
  return state_->end_time();
}

int SceneTimeline::first_frame() const {
  const State& s = *state_;
  const double late = std::ceil(in_frames(s.first_time() - s.delay, s.rate));
  return s.first_number + (std::isfinite(late) ? std::max(0, to_frame(late)) : 0);
}

int SceneTimeline::last_frame() const {
  const State& s = *state_;
  double last = kInfinity;
  for (const Changing& flame : s.flames) {
    if (flame.series) {
      const double end = flame.series->size() / flame.rate - s.delay - s.exposure;
      const double frames = in_frames(end, s.rate);
      // An exposure that lasts no time cannot begin at the end.
      last = std::min(last, s.exposure > 0 ? std::floor(frames) : std::ceil(frames) - 1);
    }
    if (flame.table)
      last = std::min(
          last, std::floor(in_frames(flame.table->last_time() - s.delay - s.exposure, s.rate)));
  }
  return to_frame(s.first_number + last);
}

double SceneTimeline::begin_of(int frame) const {
  const State& s = *state_;
  if (!(s.rate > 0))
    throw InputError(s.positions.find("camera.sensor"),
                     "the frame rate is not known, since no flame is a series; set "
                     "camera.sensor.frame_rate, or give a time");
  const int first = first_frame(), last = last_frame();
  if (frame < first || frame > last)
    throw InputError(
        s.positions.find(s.flames.front().key),
        last < first
            ? fmt::format("there is no frame {}: the flames are known until {}, which is shorter "
                          "than an exposure",
                          frame, in_words(end_time()))
            : fmt::format(
                  "there is no frame {}: the flames are known until {}, for frames {} to {}", frame,
                  in_words(end_time()), first, last));
  return s.delay + (static_cast<double>(frame) - s.first_number) / s.rate;
}

int SceneTimeline::frame_at(double time) const {
  const State& s = *state_;
  if (!(s.rate > 0)) return s.first_number;
  return std::max(first_frame(),
                  to_frame(s.first_number + std::floor(in_frames(time - s.delay, s.rate))));
}

Scene SceneTimeline::at_time(double time) const {
  state_->check(time, time);
  return state_->at(time);
}

std::vector<SceneMoment> SceneTimeline::exposure(double begin) const {
  const State& s = *state_;
  const double end = begin + s.exposure;
  s.check(begin, end);
  if (!(s.exposure > 0)) return {{s.at(begin), 1}};
  const std::vector<double> times = s.cuts(begin, end);
  std::vector<SceneMoment> moments;
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    const double share = (times[i + 1] - times[i]) / s.exposure;
    Scene now = s.at(0.5 * (times[i] + times[i + 1]));
    if (!moments.empty() && moments.back().scene.flames == now.flames)
      moments.back().share += share;
    else
      moments.push_back({std::move(now), share});
  }
  if (moments.size() == 1) moments.front().share = 1;
  return moments;
}

std::vector<SceneTimeline::FlameTime> SceneTimeline::flames() const {
  std::vector<FlameTime> list;
  for (const Changing& flame : state_->flames) {
    FlameTime time;
    time.flame = flame.flame;
    if (flame.series) {
      time.files = flame.series->pattern();
      time.frame_rate = flame.rate;
      time.first = flame.series->first();
      time.last = flame.series->last();
      time.missing = flame.series->missing();
      int there = time.first;
      while (flame.series->is_missing(there)) ++there;
      time.first_file = flame.series->name(there);
    }
    if (flame.table) {
      time.table = flame.table_file;
      for (const std::string& column : flame.table->columns())
        time.table_columns.append(time.table_columns.empty() ? "" : ", ").append(column);
      time.table_first = flame.table->first_time();
      time.table_last = flame.table->last_time();
    }
    list.push_back(std::move(time));
  }
  return list;
}

std::vector<std::string> SceneTimeline::missing_files(int first, int last, int step) const {
  const State& s = *state_;
  std::vector<std::string> names;
  for (const Changing& flame : s.flames) {
    if (!flame.series || flame.series->missing().empty()) continue;
    std::vector<int> numbers;
    for (int frame = first; frame <= last; frame += step) {
      const double begin = begin_of(frame);
      const int from = s.file_at(flame, begin);
      const double end = std::ceil(in_frames(begin + s.exposure, flame.rate)) - 1;
      const int to = s.exposure > 0 ? flame.series->first() + to_frame(end) : from;
      for (int number = from; number <= to; ++number)
        if (flame.series->is_missing(number)) numbers.push_back(number);
      if (last - frame < step) break;
    }
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    for (const int number : numbers) names.push_back(flame.series->name(number));
  }
  return names;
}

Scene first_moment(const Scene& scene, const PositionMap& positions) {
  if (!changes_with_time(scene)) return scene;
  const SceneTimeline timeline(scene, positions);
  const bool frames = timeline.frame_rate() > 0 && timeline.first_frame() <= timeline.last_frame();
  return frames ? timeline.at_frame(timeline.first_frame())
                : timeline.at_time(timeline.first_time());
}

}  // namespace plenoflame
