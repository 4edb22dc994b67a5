#include "render/paths/ray_path_npz.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#include "lightfield/export/array_files.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// An array with `components` numbers for each ray; value(i, k) returns them.
template <class Number, class Value>
NamedArray array_of(const char* name, const RayPaths& paths, std::size_t components, Value value) {
  const std::size_t n = paths.rays.size();
  std::vector<Number> values;
  values.reserve(n * components);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < components; ++k) values.push_back(static_cast<Number>(value(i, k)));
  NamedArray array{name, "", "", {n}, std::move(values)};
  if (components > 1) array.shape.push_back(components);
  return array;
}

double component(Vec3 v, std::size_t k) {
  return k == 0 ? v.x : k == 1 ? v.y : v.z;
}

/// The vertex on surface 0, where a ray leaves the camera or enters it. Other rays have none.
const RayVertex* front_of(const RayPaths& paths, const RayPath& ray) {
  for (std::size_t k = ray.first; k < ray.first + ray.count; ++k)
    if (paths.vertices[k].surface == 0) return &paths.vertices[k];
  return nullptr;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

}  // namespace

std::string ray_path_npz(const RayPaths& paths) {
  const auto& rays = paths.rays;
  for (const RayPath& ray : rays)
    if (std::max({std::abs(ray.lens.q), std::abs(ray.lens.r)}) >
            std::numeric_limits<std::int16_t>::max() ||
        ray.type > std::numeric_limits<std::int8_t>::max())
      throw InputError("the microlenses have numbers that do not fit into the .npz of rays");
  const std::size_t channels = paths.channels.size();
  const auto first = [&](std::size_t i) { return paths.vertices[rays[i].first].position; };
  const auto last = [&](std::size_t i) {
    return paths.vertices[rays[i].first + rays[i].count - 1].position;
  };
  std::vector<NamedArray> arrays;
  arrays.push_back(array_of<float>(
      "start", paths, 3, [&](std::size_t i, std::size_t k) { return component(first(i), k); }));
  arrays.push_back(array_of<float>("front", paths, 3, [&](std::size_t i, std::size_t k) {
    const RayVertex* front = front_of(paths, rays[i]);
    return front ? component(front->position, k) : std::numeric_limits<double>::quiet_NaN();
  }));
  arrays.push_back(array_of<float>(
      "end", paths, 3, [&](std::size_t i, std::size_t k) { return component(last(i), k); }));
  arrays.push_back(array_of<std::int32_t>("pixel", paths, 2, [&](std::size_t i, std::size_t k) {
    return k == 0 ? rays[i].column : rays[i].row;
  }));
  arrays.push_back(array_of<std::int16_t>("microlens", paths, 2, [&](std::size_t i, std::size_t k) {
    return k == 0 ? rays[i].lens.q : rays[i].lens.r;
  }));
  arrays.push_back(array_of<std::int8_t>("type", paths, 1,
                                         [&](std::size_t i, std::size_t) { return rays[i].type; }));
  arrays.push_back(array_of<std::int8_t>("status", paths, 1, [&](std::size_t i, std::size_t) {
    return static_cast<int>(rays[i].status.status);
  }));
  arrays.push_back(array_of<float>("weight", paths, 1,
                                   [&](std::size_t i, std::size_t) { return rays[i].weight; }));
  arrays.push_back(array_of<float>("optical_thickness", paths, 1, [&](std::size_t i, std::size_t) {
    return rays[i].optical_thickness;
  }));
  NamedArray radiance =
      array_of<float>("radiance", paths, channels,
                      [&](std::size_t i, std::size_t k) { return paths.radiance_of(i, k); });
  radiance.shape = {rays.size(), channels};
  arrays.push_back(std::move(radiance));
  arrays.push_back({"wavelength", "m", "", {channels}, paths.wavelengths});
  return npz_bytes(arrays, {{"channels", joined(paths.channels)}});
}

}  // namespace plenoflame
