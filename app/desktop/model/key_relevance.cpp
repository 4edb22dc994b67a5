#include "model/key_relevance.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "plenoflame/base/error.h"
#include "plenoflame/scene/scene_schema.h"

namespace plenoflame::desktop {
namespace {

/// Keys that have an effect only while another one has certain words. The first match counts.
struct Rule {
  std::string_view keys;   ///< in a table, separated by spaces; empty: all of the table
  std::string_view table;  ///< schema path
  std::string_view other;  ///< key that decides; begins with '.' when it stands in the same table
  std::string_view words;  ///< that it must have, separated by spaces
};

constexpr std::array kRules{
    Rule{"file interpolation", "flames[]", ".kind", "vdb"},
    Rule{"", "flames[].temperature", "flames[].kind", "vdb"},
    Rule{"", "flames[].absorption", "flames[].kind", "vdb"},
    Rule{"", "flames[].layers[]", "flames[].kind", "layered"},
    Rule{"", "flames[].layers", "flames[].kind", "layered"},
    Rule{"grid", "flames[].scattering", "flames[].kind", "vdb"},
    Rule{"asymmetry", "flames[].scattering", ".phase", "henyey_greenstein"},
    Rule{"wavelength", "flames[].lines[]", ".kind", "custom"},
    Rule{"exponent", "flames[].spectrum", ".kind", "power"},
    Rule{"index", "flames[].spectrum", ".kind", "soot"},
    Rule{"absorption_function", "flames[].spectrum", ".kind", "soot"},
    Rule{"table", "flames[].spectrum", ".kind", "table"},
    Rule{"radius", "surfaces[]", ".shape", "sphere cylinder cone disc"},
    Rule{"height caps", "surfaces[]", ".shape", "cylinder cone"},
    Rule{"extent", "surfaces[]", ".shape", "plane"},
    Rule{"size", "surfaces[]", ".shape", "box"},
    Rule{"file file_unit", "surfaces[]", ".shape", "mesh"},
    Rule{"reflectivity", "surfaces[].material", ".kind", "lambertian"},
    Rule{"temperature", "surfaces[].material", ".kind", "blackbody"},
    Rule{"radiance", "surfaces[].material", ".kind", "emitter"},
    Rule{"", "surfaces[].material.texture", "surfaces[].material.kind", "lambertian"},
    Rule{"file", "surfaces[].material.texture", ".kind", "image"},
    Rule{"fill", "surfaces[].material.texture", ".kind", "dots"},
    Rule{"diameter extent", "windows[]", ".shape", "plate wedge"},
    Rule{"angle", "windows[]", ".shape", "wedge"},
    Rule{"radius height", "windows[]", ".shape", "tube dome"},
    Rule{"position cone power", "lights[]", ".kind", "point"},
    Rule{"direction", "lights[]", ".kind", "point parallel"},
    Rule{"irradiance", "lights[]", ".kind", "parallel"},
    Rule{"radiance", "lights[]", ".kind", "environment"},
    Rule{"wavelength width", "channels[]", ".kind", "band line"},
    Rule{"response", "channels[]", ".kind", "named"},
    Rule{"file curve", "channels[]", ".kind", "curve"},
    Rule{"lens_distance", "camera.focus", ".mode", "distance"},
    Rule{"object_distance conjugate", "camera.focus", ".mode", "paraxial best"},
    Rule{"", "camera.array", ".present", "true"},
    Rule{"", "camera.array.types", "camera.array.present", "true"},
    Rule{"", "camera.array.types[]", "camera.array.present", "true"},
    Rule{"pitch_y", "camera.array", ".lattice", "square"},
    Rule{"diameter_y", "camera.array", ".aperture", "square"},
    Rule{"angle extent inner outer", "camera.pupil_filters[]", ".shape", "sector"},
    Rule{"corners", "camera.pupil_filters[]", ".shape", "polygon"},
};

bool contains_word(std::string_view words, std::string_view word) {
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    if (words.substr(0, end) == word) return true;
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return false;
}

/// Each of several cameras has the keys of the one.
std::string as_of_one_camera(std::string path) {
  constexpr std::string_view kOne = "cameras[]";
  if (path.starts_with(kOne)) path.replace(0, kOne.size(), "camera");
  return path;
}

/// A schema path with the indices that stand in `path`, from the front.
std::string with_indices(std::string_view schema, const std::string& path) {
  std::string out;
  std::size_t from = 0;
  for (std::size_t i = 0; i < schema.size(); ++i) {
    if (schema[i] != '[') {
      out += schema[i];
      continue;
    }
    const std::size_t open = path.find('[', from), close = path.find(']', open);
    if (close == std::string::npos) return {};
    out += path.substr(open, close - open + 1);
    from = close + 1;
    ++i;
  }
  return out;
}

}  // namespace

std::string irrelevance(const Scene& scene, const std::string& path) {
  const std::string own = parse_path(path).schema_path, schema = as_of_one_camera(own);
  const std::size_t dot = schema.rfind('.');
  const std::string table = dot == std::string::npos ? schema : schema.substr(0, dot),
                    key = dot == std::string::npos ? std::string() : schema.substr(dot + 1);
  for (const Rule& rule : kRules) {
    const bool whole = rule.keys.empty();
    if (whole ? schema != rule.table && table != rule.table
              : table != rule.table || !contains_word(rule.keys, key))
      continue;
    const bool beside = rule.other.front() == '.';
    std::string other =
        beside ? std::string(rule.table) + std::string(rule.other) : std::string(rule.other);
    if (schema == other) continue;  // the key that decides has an effect itself
    if (own != schema) other = "cameras[]" + other.substr(std::string_view("camera").size());
    other = with_indices(other, path);
    try {
      if (contains_word(rule.words, get_text(scene, other))) continue;
    } catch (const Error&) {  // there is no such key in this scene
      continue;
    }
    std::string words(rule.words);
    for (std::size_t at = 0; (at = words.find(' ', at)) != std::string::npos; at += 4)
      words.replace(at, 1, " or ");
    return "only where " + other + " is " + words;
  }
  if (schema == "camera.lens.focal_length" || schema == "camera.lens.diameter") {
    const std::string list = with_indices(own.substr(0, own.rfind('.')), path) + ".surfaces";
    if (list_size(scene, list) > 0) return "only where the lens has no surfaces";
  }
  return {};
}

}  // namespace plenoflame::desktop
