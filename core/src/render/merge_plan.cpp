#include "render/merge_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/film/reopened.h"
#include "plenoflame/scene/scene_differences.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame {
namespace {

constexpr std::size_t kMostNamed = 8;  ///< parts named in one message

/// The same light field with empty images.
LightField without_pixels(LightField field) {
  for (LightFieldChannel& channel : field.channels) channel.flux = channel.standard_error = {};
  for (auto& [name, image] : field.layers) image = {};
  return field;
}

MergePiece read_piece(const MergeInput& picture) {
  const std::string& path = picture.name;
  MergePiece piece{path,
                   picture.field,
                   picture.field ? without_pixels(*picture.field) : read_light_field_header(path),
                   {}};
  const LightField& field = piece.header;
  if (field.unit != "W" || field.scene_text.empty() || !field.numbers.contains("render.replicates"))
    throw InputError(path + ": is no picture of plenoflame render");
  if (!field.complete)
    throw InputError(
        fmt::format("{}: was stopped and is not complete; resume its rendering first", path));
  const auto part = field.texts.find(kPartOfPicture);
  if (part == field.texts.end()) return piece;
  try {
    piece.part = part_from(part->second);
  } catch (const UsageError& error) {
    throw InputError(fmt::format("{}: {}: {}", path, kPartOfPicture, error.what()));
  }
  return piece;
}

std::string text_of(const PixelWindow& w) {
  return fmt::format("{},{},{},{}", w.x, w.y, w.width, w.height);
}

/// The first key in which the scenes differ. Defaults of a run are ignored, since the pictures
/// state the values that were used.
std::optional<SceneDifference> scene_difference(const MergePiece& a, const MergePiece& b) {
  if (a.header.scene_text == b.header.scene_text) return std::nullopt;
  const std::set<std::string> defaults{"render.estimator", "render.samples", "render.seed"};
  const Scene before = parse_scene(a.header.scene_text, a.path).scene;
  const Scene after = parse_scene(b.header.scene_text, b.path).scene;
  for (const SceneDifference& difference : scene_differences(before, after))
    if (!defaults.contains(difference.path)) return difference;
  return std::nullopt;
}

/// Numbers and texts that may differ between the parts of a picture.
bool may_differ(const std::string& key) {
  const std::set<std::string> keys{"exposure.energy", "frame.run", kTileSamples, kPartOfPicture,
                                   kMergedPicture};
  return keys.contains(key);
}

/// @return the first key whose value differs
template <class Value>
std::string differing_key(const std::map<std::string, Value>& a,
                          const std::map<std::string, Value>& b) {
  for (const auto& [key, value] : a)
    if (const auto other = b.find(key);
        !may_differ(key) && (other == b.end() || !(other->second == value)))
      return key;
  for (const auto& [key, value] : b)
    if (!may_differ(key) && !a.contains(key)) return key;
  return "";
}

void check_same(const MergePiece& first, const MergePiece& piece) {
  const LightField &a = first.header, &b = piece.header;
  const auto refuse = [&](const std::string& what, const std::string& then,
                          const std::string& now) {
    throw InputError(fmt::format("{} does not belong to {}: {} {} there and {} here", piece.path,
                                 first.path, what, then.empty() ? "is missing" : "is " + then,
                                 now.empty() ? "is missing" : "is " + now));
  };
  if (const auto difference = scene_difference(first, piece))
    refuse(difference->path, difference->before, difference->after);
  if (a.version != b.version) refuse("the version of Plenoflame", a.version, b.version);
  if (a.estimator != b.estimator) refuse("the estimator", a.estimator, b.estimator);
  if (const std::string key = differing_key(a.numbers, b.numbers); !key.empty()) {
    const auto value = [&](const LightField& field) {
      const auto found = field.numbers.find(key);
      return found == field.numbers.end() ? std::string() : fmt::format("{}", found->second);
    };
    refuse(key, value(a), value(b));
  }
  if (const std::string key = differing_key(a.texts, b.texts); !key.empty()) {
    const auto value = [&](const LightField& field) {
      const auto found = field.texts.find(key);
      return found == field.texts.end() ? std::string() : "'" + found->second + "'";
    };
    refuse(key, value(a), value(b));
  }
  const auto names = [](const LightField& field) {
    std::string list;
    for (const auto& layer : field.layers) list += (list.empty() ? "" : ", ") + layer.first;
    return list;
  };
  if (names(a) != names(b)) refuse("the list of layers", names(a), names(b));
}

std::string list_of(const std::vector<int>& numbers) {
  std::string list;
  for (std::size_t i = 0; i < std::min(numbers.size(), kMostNamed); ++i)
    list += (i == 0 ? "" : ", ") + std::to_string(numbers[i]);
  if (numbers.size() > kMostNamed) list += fmt::format(" and {} more", numbers.size() - kMostNamed);
  return list;
}

std::string what_is(const MergePiece& piece) {
  return piece.part.is_whole() ? "the whole window" : "part " + to_string(piece.part);
}

/// @param pieces of one seed and window, by part
void check_parts(const std::vector<MergePiece>& pieces) {
  const LightField& first = pieces.front().header;
  const int count = pieces.front().part.count;
  for (std::size_t i = 1; i < pieces.size(); ++i) {
    const MergePiece &a = pieces[i - 1], &b = pieces[i];
    if (a.part.count != b.part.count)
      throw InputError(
          fmt::format("{} is {} and {} is {}, of the same seed: give the parts of one division",
                      a.path, what_is(a), b.path, what_is(b)));
    if (a.part == b.part)
      throw InputError(
          fmt::format("{} and {} are both {} {} with seed {}, so the same rays: give one of them, "
                      "or render one with another seed",
                      a.path, b.path, what_is(a), text_of(first.window), first.seed));
    if (a.header.samples != b.header.samples)
      throw InputError(
          fmt::format("{} has {} samples and {} has {}: parts of one picture have the same", a.path,
                      a.header.samples, b.path, b.header.samples));
  }
  std::set<int> present;
  for (const MergePiece& piece : pieces) present.insert(piece.part.number);
  std::vector<int> missing;
  for (int number = 1; number <= count; ++number)
    if (!present.contains(number)) missing.push_back(number);
  if (missing.empty()) return;
  throw InputError(fmt::format("{} of the {} parts {} missing: {} (seed {}, window {})",
                               missing.size(), count, missing.size() == 1 ? "is" : "are",
                               list_of(missing), first.seed, text_of(first.window)));
}

bool overlap(const PixelWindow& a, const PixelWindow& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

/// A pixel of `all` that no window contains.
std::pair<int, int> bare_pixel(const PixelWindow& all, const std::vector<PixelWindow>& windows) {
  // Coverage can change only where a window begins or ends.
  std::set<int> columns{all.x}, rows{all.y};
  for (const PixelWindow& w : windows) {
    columns.insert({w.x, w.x + w.width});
    rows.insert({w.y, w.y + w.height});
  }
  for (const int row : rows)
    for (const int column : columns) {
      const PixelWindow pixel{column, row, 1, 1};
      if (overlap(pixel, all) &&
          std::none_of(windows.begin(), windows.end(),
                       [&](const PixelWindow& w) { return overlap(w, pixel); }))
        return {column, row};
    }
  return {all.x, all.y};
}

/// The rectangle that the windows of a seed cover.
PixelWindow whole_of(const std::vector<std::vector<MergePiece>>& pieces) {
  std::vector<PixelWindow> windows;
  for (const auto& parts : pieces) windows.push_back(parts.front().header.window);
  double area = 0;
  int left = windows[0].x, top = windows[0].y, right = left, bottom = top;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const PixelWindow& w = windows[i];
    for (std::size_t j = 0; j < i; ++j)
      if (overlap(windows[j], w))
        throw InputError(fmt::format(
            "{} and {} overlap (windows {} and {}) and have the same seed: windows are put side by "
            "side",
            pieces[j].front().path, pieces[i].front().path, text_of(windows[j]), text_of(w)));
    area += static_cast<double>(w.width) * w.height;
    left = std::min(left, w.x);
    top = std::min(top, w.y);
    right = std::max(right, w.x + w.width);
    bottom = std::max(bottom, w.y + w.height);
  }
  const PixelWindow all{left, top, right - left, bottom - top};
  if (area < static_cast<double>(all.width) * all.height) {
    const auto [column, row] = bare_pixel(all, windows);
    throw InputError(
        fmt::format("the windows do not make up a rectangle: none of the files holds "
                    "the pixel in column {}, row {}",
                    column, row));
  }
  return all;
}

}  // namespace

MergePlan make_merge_plan(const std::vector<MergeInput>& pictures) {
  if (pictures.empty()) throw InputError("there is no picture to merge");
  std::vector<MergePiece> pieces;
  for (const MergeInput& picture : pictures) {
    pieces.push_back(read_piece(picture));
    if (pictures.size() > 1 && pieces.back().header.texts.contains(kMergedPicture))
      throw InputError(picture.name +
                       ": is merged already; merge the pictures that it is made of, all at once");
  }
  for (const MergePiece& piece : pieces) check_same(pieces.front(), piece);
  const auto key = [](const MergePiece& piece) {
    const PixelWindow& w = piece.header.window;
    return std::tuple(piece.header.seed, w.y, w.x, w.width, w.height, piece.part.count,
                      piece.part.number, piece.path);
  };
  std::sort(pieces.begin(), pieces.end(),
            [&](const MergePiece& a, const MergePiece& b) { return key(a) < key(b); });
  MergePlan plan;
  for (MergePiece& piece : pieces) {
    auto& windows = plan.seeds[piece.header.seed];
    if (windows.empty() || !(windows.back().front().header.window == piece.header.window))
      windows.emplace_back();
    windows.back().push_back(std::move(piece));
  }
  for (const auto& [seed, windows] : plan.seeds) {
    for (const auto& parts : windows) check_parts(parts);
    const PixelWindow all = whole_of(windows);
    if (seed == plan.seeds.begin()->first) plan.window = all;
    if (!(all == plan.window))
      throw InputError(
          fmt::format("the pictures of seed {} hold the window {}, those of seed {} {}",
                      plan.seeds.begin()->first, text_of(plan.window), seed, text_of(all)));
  }
  return plan;
}

}  // namespace plenoflame
