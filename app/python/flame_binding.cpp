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
#include "setting_tuples.h"
#include "values.h"
#include "voxels.h"
#include "vtk_commands.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;
using Data = std::shared_ptr<Voxels>;

Data voxels_of_fields(const std::vector<VoxelField>& fields, const std::string& file,
                      const Execution& execution) {
  LatticeFields found = on_one_lattice(fields, file, "grid", execution);
  return std::make_shared<Voxels>(
      Voxels{voxel_place(found.transform, found.box), std::move(found.arrays)});
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
    const FlameFields flame = flame_of(*input, temperature, absorption, ambient, execution.stop);
    warn_of_others(flame.lines, execution);
    write_flame(path, flame, options);
  }
  Data input;
  std::string path, temperature = "temperature", absorption = "absorption";
  double ambient = 293.15;
  bool half = false;

 private:
  void warn_of_others(const std::vector<VoxelField>& lines, const Execution& execution) const {
    std::string others, known;
    for (const VoxelArray& array : input->arrays)
      if (array.name != temperature && array.name != absorption &&
          std::none_of(lines.begin(), lines.end(),
                       [&](const VoxelField& line) { return line.name == array.name; }))
        others += (others.empty() ? "" : ", ") + array.name;
    for (const LineGrid& line : line_grids())
      known += (known.empty() ? "" : ", ") + std::string(line.name);
    if (!others.empty())
      execution.warn(path + ": not written: " + others + "; arrays of emission lines are named " +
                     known);
  }
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
py::array array_of(const Data& voxels, const VoxelArray& array) {
  const auto [nx, ny, nz] = voxels->place.size;
  const auto size = static_cast<py::ssize_t>(sizeof(float));
  const auto x = static_cast<py::ssize_t>(nx), y = static_cast<py::ssize_t>(ny),
             z = static_cast<py::ssize_t>(nz);
  return py::array_t<float>({x, y, z}, {size, size * x, size * x * y}, array.values.data(),
                            py::cast(voxels));
}

Data voxels_from(const std::array<std::size_t, 3>& size, Vec3 origin,
                 const std::array<double, 3>& spacing, const std::array<Vec3, 3>& directions) {
  const Data out = std::make_shared<Voxels>();
  out->place.size = size;
  out->place.origin = origin;
  out->place.spacing = spacing;
  out->place.direction = directions;
  return out;
}

void bind_voxels(py::module_& module) {
  py::class_<Voxels, Data>(module, "Voxels")
      .def(py::init(&voxels_from))
      .def("add",
           [](Voxels& v, const std::string& name,
              const py::array_t<float, py::array::f_style | py::array::forcecast>& values) {
             for (py::ssize_t k = 0; k < 3; ++k)
               if (values.ndim() != 3 || static_cast<std::size_t>(values.shape(k)) !=
                                             v.place.size[static_cast<std::size_t>(k)])
                 throw UsageError("the array '" + name + "' has another size than the voxels");
             v.arrays.push_back({name, {values.data(), values.data() + values.size()}});
           })
      .def_property_readonly("arrays",
                             [](const Data& voxels) {
                               py::dict arrays;
                               for (const VoxelArray& array : voxels->arrays)
                                 arrays[py::str(array.name)] = array_of(voxels, array);
                               return arrays;
                             })
      .def_property_readonly("origin", [](const Voxels& v) { return v.place.origin; })
      .def_property_readonly("spacing",
                             [](const Voxels& v) { return py::tuple(py::cast(v.place.spacing)); })
      .def_property_readonly("directions", [](const Voxels& v) { return v.place.direction; });
}

/// The properties of vtkPlenoflameFlameImport.
py::dict properties_of(const FlameImportRequest& r) {
  py::dict all;
  if (!r.solution.empty()) all["SolutionFileName"] = r.solution;
  all["TemperatureArray"] = r.temperature;
  all["TemperatureUnit"] = r.temperature_unit;
  all["TemperatureScale"] = r.temperature_scale;
  all["AbsorptionArray"] = r.absorption;
  all["AbsorptionUnit"] = r.absorption_unit;
  all["SootArray"] = r.soot;
  all["SootFunction"] = r.soot_function;
  all["Wavelength"] = r.wavelength;
  all["ConstantAbsorption"] = r.constant;
  all["VoxelSize"] = r.voxel_size;
  all["Bounds"] = r.bounds;
  all["LengthScale"] = r.length_scale;
  return all;
}

void bind_import(py::module_& module) {
  using R = FlameImportRequest;
  py::class_<R>(module, "FlameImport")
      .def(py::init<>())
      .def("set_option", [](R& r, const std::string& setting,
                            const std::string& text) { set_setting(r, kNames, setting, text); })
      .def_static("settings", &settings_alone<R>)
      .def_property_readonly("properties", &properties_of);
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
  bind_import(module);
  module.def("flame_generators", &generators_json);
  py::class_<FlameGenerator, Runnable>(module, "FlameGenerator")
      .def(py::init<>())
      .def_readwrite("name", &FlameGenerator::name)
      .def_readwrite("parameters", &FlameGenerator::parameters)
      .def_readonly("output", &FlameGenerator::output);
  py::class_<FlameReader, Runnable>(module, "FlameReader")
      .def(py::init<>())
      .def_readwrite("path", &FlameReader::path)
      .def_readwrite("grid", &FlameReader::grid)
      .def_readonly("output", &FlameReader::output);
  py::class_<FlameWriter, Runnable>(module, "FlameWriter")
      .def(py::init<>())
      .def_readwrite("input", &FlameWriter::input)
      .def_readwrite("path", &FlameWriter::path)
      .def_readwrite("temperature", &FlameWriter::temperature)
      .def_readwrite("absorption", &FlameWriter::absorption)
      .def_readwrite("ambient", &FlameWriter::ambient)
      .def_readwrite("half", &FlameWriter::half);
  py::class_<FlameSource, Runnable>(module, "FlameSource")
      .def(py::init<>())
      .def_readwrite("scene", &FlameSource::scene)
      .def_readwrite("resolution", &FlameSource::resolution)
      .def_readonly("output", &FlameSource::output);
}

}  // namespace plenoflame::python
