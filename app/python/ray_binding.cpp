#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "arrays.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/ray_path_request.h"
#include "runnable.h"
#include "scene_handle.h"
#include "values.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;

class RayPathSource : public Runnable {
 public:
  void run(const Execution& execution) override {
    output = trace_ray_paths(*scene->compile(execution), request, execution);
  }
  std::shared_ptr<SceneHandle> scene;
  RayPathRequest request;
  RayPaths output;
};

/// value(i, k) gives component k of entry i; one component makes an array of one dimension.
template <class Number, class Value>
py::array array(std::size_t count, std::size_t components, bool flat, Value value) {
  std::vector<Number> values;
  values.reserve(count * components);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < components; ++k) values.push_back(value(i, k));
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(count)};
  if (!flat) shape.push_back(static_cast<py::ssize_t>(components));
  return given(std::move(values), shape);
}

/// The arrays of docs/rays.md, by name.
py::dict arrays_of(const RayPaths& paths) {
  const auto& rays = paths.rays;
  const auto& vertices = paths.vertices;
  const std::size_t n = rays.size(), channels = paths.channels.size(), m = vertices.size();
  py::dict out;
  const auto whole = [&](const char* name, auto value) {
    out[name] = array<int>(n, 1, true, [&](std::size_t i, std::size_t) { return value(rays[i]); });
  };
  const auto real = [&](const char* name, auto value) {
    out[name] =
        array<double>(n, 1, true, [&](std::size_t i, std::size_t) { return value(rays[i]); });
  };
  const auto along = [&](const char* name, double RayVertex::*value) {
    out[name] =
        array<double>(m, 1, true, [&](std::size_t i, std::size_t) { return vertices[i].*value; });
  };
  out["pixel"] = array<int>(n, 2, false, [&](std::size_t i, std::size_t k) {
    return k == 0 ? rays[i].column : rays[i].row;
  });
  out["microlens"] = array<int>(n, 2, false, [&](std::size_t i, std::size_t k) {
    return k == 0 ? rays[i].lens.q : rays[i].lens.r;
  });
  whole("type", [](const RayPath& ray) { return ray.type; });
  whole("status", [](const RayPath& ray) { return static_cast<int>(ray.status.status); });
  whole("ended_at", [](const RayPath& ray) { return ray.status.surface; });
  whole("solid", [](const RayPath& ray) { return ray.solid; });
  out["wavelength"] = array<double>(
      n, channels, false, [&](std::size_t, std::size_t k) { return paths.wavelengths[k]; });
  real("weight", [](const RayPath& ray) { return ray.weight; });
  out["radiance"] = array<double>(
      n, channels, false, [&](std::size_t i, std::size_t k) { return paths.radiance_of(i, k); });
  real("optical_thickness", [](const RayPath& ray) { return ray.optical_thickness; });
  out["surface"] =
      array<int>(m, 1, true, [&](std::size_t i, std::size_t) { return vertices[i].surface; });
  along("refractive_index", &RayVertex::index);
  along("distance", &RayVertex::distance);
  along("temperature", &RayVertex::temperature);
  along("absorption", &RayVertex::absorption);
  return out;
}

/// Everything that Python keeps of rays: plain values, so that they can be pickled.
py::dict plain(const RayPaths& paths) {
  py::dict out;
  const auto& vertices = paths.vertices;
  out["points"] = array<double>(vertices.size(), 3, false, [&](std::size_t i, std::size_t k) {
    const Vec3 p = vertices[i].position;
    return k == 0 ? p.x : k == 1 ? p.y : p.z;
  });
  out["offsets"] =
      array<std::int64_t>(paths.rays.size() + 1, 1, true, [&](std::size_t i, std::size_t) {
        return static_cast<std::int64_t>(
            i == 0 ? 0 : paths.rays[i - 1].first + paths.rays[i - 1].count);
      });
  out["surfaces"] = paths.surfaces;
  out["channels"] = paths.channels;
  out["arrays"] = arrays_of(paths);
  return out;
}

/// Numbers of a named array of rays, checked for their count.
template <class Number>
class Column {
 public:
  Column(const py::dict& arrays, const char* name, std::size_t count)
      : values_(
            py::array_t<Number, py::array::c_style | py::array::forcecast>::ensure(arrays[name])) {
    if (!values_ || static_cast<std::size_t>(values_.size()) != count)
      throw UsageError(std::string("the rays' array '") + name + "' has another size");
  }
  Number at(std::size_t i) const { return values_.data()[i]; }

 private:
  py::array_t<Number, py::array::c_style | py::array::forcecast> values_;
};

RayPaths paths_of(const py::dict& state) {
  const py::dict arrays = state["arrays"];
  const auto points =
      py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(state["points"]);
  const auto offsets = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(
      state["offsets"]);
  RayPaths paths;
  paths.surfaces = state["surfaces"].cast<std::vector<std::string>>();
  paths.channels = state["channels"].cast<std::vector<std::string>>();
  const auto n = static_cast<std::size_t>(offsets.size()) - 1;
  const auto m = static_cast<std::size_t>(points.size()) / 3;
  const std::size_t channels = paths.channels.size();
  const Column<int> pixel(arrays, "pixel", 2 * n), lens(arrays, "microlens", 2 * n),
      type(arrays, "type", n), status(arrays, "status", n), ended(arrays, "ended_at", n),
      solid(arrays, "solid", n), surface(arrays, "surface", m);
  const Column<double> wavelength(arrays, "wavelength", n * channels), weight(arrays, "weight", n),
      radiance(arrays, "radiance", n * channels), thickness(arrays, "optical_thickness", n),
      index(arrays, "refractive_index", m), distance(arrays, "distance", m),
      temperature(arrays, "temperature", m), absorption(arrays, "absorption", m);
  for (std::size_t c = 0; c < channels; ++c)
    paths.wavelengths.push_back(n > 0 ? wavelength.at(c) : 0);
  for (std::size_t i = 0; i < n; ++i) {
    RayPath ray;
    ray.column = pixel.at(2 * i);
    ray.row = pixel.at(2 * i + 1);
    ray.lens = {lens.at(2 * i), lens.at(2 * i + 1)};
    ray.type = type.at(i);
    ray.status = {static_cast<RayStatus>(status.at(i)), ended.at(i)};
    ray.solid = solid.at(i);
    ray.weight = weight.at(i);
    ray.optical_thickness = thickness.at(i);
    ray.first = static_cast<std::size_t>(offsets.at(static_cast<py::ssize_t>(i)));
    ray.count = static_cast<std::size_t>(offsets.at(static_cast<py::ssize_t>(i + 1))) - ray.first;
    paths.rays.push_back(ray);
    for (std::size_t c = 0; c < channels; ++c)
      paths.radiance.push_back(radiance.at(i * channels + c));
  }
  for (std::size_t i = 0; i < m; ++i) {
    RayVertex vertex;
    vertex.position = {points.data()[3 * i], points.data()[3 * i + 1], points.data()[3 * i + 2]};
    vertex.surface = surface.at(i);
    vertex.index = index.at(i);
    vertex.distance = distance.at(i);
    vertex.temperature = temperature.at(i);
    vertex.absorption = absorption.at(i);
    paths.vertices.push_back(vertex);
  }
  return paths;
}

}  // namespace

void bind_rays(py::module_& module) {
  using Source = RayPathSource;
  using Request = RayPathRequest;
  py::class_<Source, Runnable> source(module, "RayPathSource");
  attributes(source, &Source::request, "pixels", &Request::pixels, "microlenses",
             &Request::microlenses, "points", &Request::points, "random", &Request::random_pixels,
             "chief", &Request::chief_rays, "rays_per_pixel", &Request::rays_per_pixel,
             "rays_per_point", &Request::rays_per_point, "flame_samples", &Request::flame_samples,
             "seed", &Request::seed, "statuses", &Request::statuses, "lens_type", &Request::type,
             "most", &Request::most);
  source.def(py::init<>())
      .def_readwrite("scene", &Source::scene)
      .def_property_readonly("output", [](const Source& s) { return plain(s.output); });
  module.def("write_rays", [](const std::string& path, const py::dict& state) {
    write_ray_paths(path, paths_of(state));
  });
}

}  // namespace plenoflame::python
