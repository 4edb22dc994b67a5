#include "model/scene_values.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/optics/f_number.h"
#include "plenoflame/optics/first_order.h"
#include "plenoflame/scene/glass_indices.h"

namespace plenoflame::desktop {
namespace {

constexpr std::string_view kEnd = ".lens.f_number", kDiameterEnd = ".lens.diameter";

bool is_f_number(std::string_view path) {
  return path.ends_with(kEnd) && path.starts_with("camera");
}

/// The lens with its glasses' indices. @param indices of one of several cameras
MainLensSpec lens_of(Scene scene, SchemaIndices indices) {
  set_indices(scene);
  return indices.empty() ? scene.camera.lens : scene.cameras.at(indices.front()).lens;
}

SchemaValue f_number_of(const Scene& scene, SchemaIndices indices) {
  try {
    const FirstOrder lens = first_order(lens_of(scene, indices));
    const double number = lens.focal_length / lens.entrance_pupil_diameter;
    return number > 0 && std::isfinite(number) ? number : 0.0;
  } catch (const Error&) {  // an unknown glass, which is said elsewhere
    return 0.0;
  }
}

void set_f_number_of(Scene& scene, SchemaIndices indices, const SchemaValue& value) {
  // A stop that is given is only narrowed: this one is not.
  MainLensSpec whole = lens_of(scene, indices);
  const auto is_stop = [](const SurfaceSpec& surface) { return surface.stop; };
  const auto stop = std::find_if(whole.surfaces.begin(), whole.surfaces.end(), is_stop);
  (stop == whole.surfaces.end() ? whole.diameter : stop->diameter) = 0;
  set_f_number(whole, std::get<double>(value));
  MainLensSpec& lens = indices.empty() ? scene.camera.lens : scene.cameras.at(indices.front()).lens;
  if (stop == whole.surfaces.end())
    lens.diameter = whole.diameter;
  else
    std::find_if(lens.surfaces.begin(), lens.surfaces.end(), is_stop)->diameter = stop->diameter;
}

constexpr SchemaKey kFNumber{
    "camera.lens.f_number",
    ValueType::number,
    Dimension::none,
    {0, 1e6, true, false},
    {},
    "Focal length over the diameter of the entrance pupil: sets the diameter of the stop.",
    &f_number_of,
    &set_f_number_of};

}  // namespace

const SchemaKey* find_value(std::string_view path) {
  return is_f_number(path) ? &kFNumber : find_schema_key(path);
}

std::vector<std::string> value_paths(const Scene& scene) {
  std::vector<std::string> paths;
  for (const std::string& path : scene_paths(scene)) {
    paths.push_back(path);
    if (path.ends_with(kDiameterEnd))
      paths.push_back(path.substr(0, path.size() - kDiameterEnd.size()) + std::string(kEnd));
  }
  return paths;
}

std::string value_text(const Scene& scene, const std::string& path) {
  if (!is_f_number(path)) return get_text(scene, path);
  const double number = std::get<double>(f_number_of(scene, parse_path(path).indices));
  return number > 0 ? readable_quantity(number, Dimension::none) : std::string();
}

void set_value_text(Scene& scene, const std::string& path, const std::string& text) {
  if (!is_f_number(path)) return set_text(scene, path, text);
  if (text == value_text(scene, path)) return;  // the text is rounded, the stop is not
  const SchemaValue value = value_from_text(kFNumber, text);
  check_range(kFNumber, value);
  set_f_number_of(scene, parse_path(path).indices, value);
}

}  // namespace plenoflame::desktop
