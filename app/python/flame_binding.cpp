#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "arrays.h"
#include "plenoflame/base/error.h"
#include "plenoflame/media/medium_samples.h"
#include "plenoflame/volumes/flame_generators.h"
#include "plenoflame/volumes/grid_file.h"
#include "runnable.h"
#include "scene_handle.h"
#include "voxels.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;
using Data = std::shared_ptr<Voxels>;

/// Fields on one lattice; those on another are interpolated, with a warning.
Data voxels_of_fields(const std::vector<VoxelField>& fields, const std::string& file,
                      const Execution& execution) {
  const AffineTransform& transform = fields.front().index_to_world;
  const auto same = [&](const VoxelField& field) {
    return field.index_to_world.linear == transform.linear &&
           field.index_to_world.translation == transform.translation;
  };
  IndexBox box;
  for (const VoxelField& field : fields)
    if (same(field)) box.add(stored_box(field));
  if (box.empty())
    throw InputError(file.empty() ? "the flame is empty: every voxel has the background's value"
                                  : "'" + file + "': every voxel has the background's value");
  const Data out = std::make_shared<Voxels>();
  out->place = voxel_place(transform, box);
  for (const VoxelField& field : fields) {
    if (same(field)) {
      out->arrays.push_back(voxel_values(field, box));
      continue;
    }
    execution.warn("'" + file + "': " + field.name +
                   " has a lattice of its own and was interpolated; read it alone with "
                   "SetGridName() to keep it");
    out->arrays.push_back(interpolated_values(field, transform, box));
  }
  return out;
}

class FlameGenerator : public Runnable {
 public:
  void run(const Execution& execution) override {
    FlameFields flame = generate_flame(name, parameters, execution);
    flame.temperature.name = "temperature";
    flame.absorption.name = "absorption";
    std::vector<VoxelField> fields{std::move(flame.temperature), std::move(flame.absorption)};
    for (VoxelField& line : flame.lines) fields.push_back(std::move(line));
    output = voxels_of_fields(fields, "", execution);
  }
  std::string name;
  FlameValues parameters;
  Data output;
};

class FlameReader : public Runnable {
 public:
  void run(const Execution& execution) override {
    std::vector<VoxelField> fields;
    if (grid.empty())
      fields = read_flame_grids(path, execution);
    else
      fields.push_back(read_voxel_field(path, grid));
    output = voxels_of_fields(fields, path, execution);
  }
  std::string path, grid;
  Data output;
};

class FlameWriter : public Runnable {
 public:
  void run(const Execution& execution) override {
    GridWriteOptions options;
    options.half = half;
    options.stop = execution.stop;
    write_flame(path, flame_of(*input, temperature, absorption, ambient, execution.stop), options);
  }
  Data input;
  std::string path, temperature = "temperature", absorption = "absorption";
  double ambient = 293.15;
  bool half = false;
};

/// The flames of a scene on a lattice.
class FlameSource : public Runnable {
 public:
  void run(const Execution& execution) override {
    const auto compiled = scene->compile(execution);
    if (!compiled->medium) throw InputError("the scene has no flame");
    MediumSamples samples =
        sample_medium(*compiled->medium, SamplePlaces::nodes, resolution, execution);
    output = std::make_shared<Voxels>();
    if (samples.temperature.empty()) return;
    for (std::size_t k = 0; k < 3; ++k)
      output->place.size[k] = static_cast<std::size_t>(samples.count[k]);
    output->place.origin = samples.origin;
    output->place.spacing = {samples.step.x, samples.step.y, samples.step.z};
    output->place.direction = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    output->arrays = {{"absorption", std::move(samples.absorption)},
                      {"temperature", std::move(samples.temperature)}};
  }
  std::shared_ptr<SceneHandle> scene;
  int resolution = 128;
  Data output;
};

/// A view of an array as numpy [i, j, k]; it keeps the voxels.
py::object array_of(const Data& voxels, const std::string& name) {
  for (VoxelArray& array : voxels->arrays) {
    if (array.name != name) continue;
    const auto [nx, ny, nz] = voxels->place.size;
    const auto size = static_cast<py::ssize_t>(sizeof(float));
    const auto x = static_cast<py::ssize_t>(nx), y = static_cast<py::ssize_t>(ny),
               z = static_cast<py::ssize_t>(nz);
    return py::array_t<float>({x, y, z}, {size, size * x, size * x * y}, array.values.data(),
                              py::cast(voxels));
  }
  return py::none();
}

Data voxels_from(const std::array<std::size_t, 3>& size, const std::array<double, 3>& origin,
                 const std::array<double, 3>& spacing,
                 const std::array<std::array<double, 3>, 3>& direction) {
  const Data out = std::make_shared<Voxels>();
  out->place.size = size;
  out->place.origin = {origin[0], origin[1], origin[2]};
  out->place.spacing = spacing;
  for (std::size_t k = 0; k < 3; ++k)
    out->place.direction[k] = {direction[k][0], direction[k][1], direction[k][2]};
  return out;
}

void bind_voxels(py::module_& module) {
  py::class_<Voxels, Data>(module, "Voxels")
      .def(py::init(&voxels_from), py::arg("size"), py::arg("origin"), py::arg("spacing"),
           py::arg("direction"))
      .def("Add",
           [](Voxels& v, const std::string& name,
              const py::array_t<float, py::array::f_style | py::array::forcecast>& values) {
             for (py::ssize_t k = 0; k < 3; ++k)
               if (values.ndim() != 3 || static_cast<std::size_t>(values.shape(k)) !=
                                             v.place.size[static_cast<std::size_t>(k)])
                 throw UsageError("the array '" + name + "' has another size than the voxels");
             v.arrays.push_back({name, {values.data(), values.data() + values.size()}});
           })
      .def("Array", &array_of)
      .def("ArrayNames",
           [](const Voxels& v) {
             std::vector<std::string> names;
             for (const VoxelArray& array : v.arrays) names.push_back(array.name);
             return names;
           })
      .def("Size", [](const Voxels& v) { return py::tuple(py::cast(v.place.size)); })
      .def("Origin",
           [](const Voxels& v) {
             return py::make_tuple(v.place.origin.x, v.place.origin.y, v.place.origin.z);
           })
      .def("Spacing", [](const Voxels& v) { return py::tuple(py::cast(v.place.spacing)); })
      .def("Direction", [](const Voxels& v) {
        py::list axes;
        for (const Vec3& d : v.place.direction) axes.append(py::make_tuple(d.x, d.y, d.z));
        return axes;
      });
}

std::string generators_json() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const plenoflame::FlameGenerator& generator : flame_generators()) {
    nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
    for (const FlameParameter& p : generator.parameters())
      parameters.push_back({{"name", p.name},
                            {"about", p.about},
                            {"value", p.value},
                            {"unit", si_unit(p.dimension)}});
    list.push_back(
        {{"name", generator.name}, {"what", generator.what}, {"parameters", parameters}});
  }
  return list.dump();
}

}  // namespace

void bind_flames(py::module_& module) {
  bind_voxels(module);
  py::class_<FlameGenerator, Runnable>(module, "FlameGenerator")
      .def(py::init<>())
      .def_static("GetGeneratorsAsJson", &generators_json)
      .def("SetFlameName", [](FlameGenerator& g, const std::string& name) { g.name = name; })
      .def("SetParameter", [](FlameGenerator& g, const std::string& key,
                              const std::string& value) { g.parameters[key] = value; })
      .def("GetOutput", [](const FlameGenerator& g) { return g.output; });
  py::class_<FlameReader, Runnable>(module, "FlameReader")
      .def(py::init<>())
      .def("SetFileName", [](FlameReader& r, const std::string& path) { r.path = path; })
      .def("SetGridName", [](FlameReader& r, const std::string& name) { r.grid = name; })
      .def("GetOutput", [](const FlameReader& r) { return r.output; });
  py::class_<FlameWriter, Runnable>(module, "FlameWriter")
      .def(py::init<>())
      .def("SetInputData", [](FlameWriter& w, Data data) { w.input = std::move(data); })
      .def("SetFileName", [](FlameWriter& w, const std::string& path) { w.path = path; })
      .def("SetTemperatureArray", [](FlameWriter& w, const std::string& n) { w.temperature = n; })
      .def("SetAbsorptionArray", [](FlameWriter& w, const std::string& n) { w.absorption = n; })
      .def("SetAmbientTemperature", [](FlameWriter& w, double kelvin) { w.ambient = kelvin; })
      .def("SetHalf", [](FlameWriter& w, bool half) { w.half = half; });
  py::class_<FlameSource, Runnable>(module, "FlameSource")
      .def(py::init<>())
      .def("SetInputDataObject",
           [](FlameSource& s, std::shared_ptr<SceneHandle> scene) { s.scene = std::move(scene); })
      .def("SetResolution", [](FlameSource& s, int resolution) { s.resolution = resolution; })
      .def("GetOutput", [](const FlameSource& s) { return s.output; });
}

}  // namespace plenoflame::python
