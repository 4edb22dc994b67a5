#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "figures_json.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/scene_schema.h"
#include "plenoflame/scene/validate.h"
#include "runnable.h"
#include "scene_handle.h"
#include "setting_tuples.h"
#include "sweep_request.h"
#include "voxels.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;

void bind_values(py::class_<SceneHandle, std::shared_ptr<SceneHandle>>& scene) {
  scene.def_property_readonly("text", [](const SceneHandle& s) { return write_scene(s.scene()); })
      .def("write_file",
           [](const SceneHandle& s, const std::string& file) { write_scene_file(file, s.scene()); })
      .def_property_readonly("paths", [](const SceneHandle& s) { return scene_paths(s.scene()); })
      .def("value",
           [](const SceneHandle& s, const std::string& key) { return get_text(s.scene(), key); })
      .def("value_json",
           [](const SceneHandle& s, const std::string& key) { return value_json(s.scene(), key); })
      .def("set_value", [](SceneHandle& s, const std::string& key,
                           const std::string& text) { set_text(s.change(), key, text); })
      .def("list_size",
           [](const SceneHandle& s, const std::string& key) { return list_size(s.scene(), key); })
      // A negative place becomes one that is too large, and its message says what there is.
      .def("insert",
           [](SceneHandle& s, const std::string& key, int position) {
             insert_item(s.change(), key, static_cast<std::size_t>(position));
           })
      .def("remove", [](SceneHandle& s, const std::string& key, int position) {
        erase_item(s.change(), key, static_cast<std::size_t>(position));
      });
}

/// The keys of the scene's schema, and what is said about each there.
py::list schema() {
  py::list keys;
  for (const SchemaKey& key : schema_keys())
    keys.append(py::make_tuple(key.path, key.description, si_unit(key.dimension), range_text(key)));
  return keys;
}

/// The runs that a request asks for.
struct Sweep {
  SweepRequest request;
  SweepRuns runs;

  const SweepRun& values(std::size_t run) const { return runs.values.at(run); }
};

void bind_sweep(py::module_& module) {
  py::class_<Sweep>(module, "Sweep")
      .def(py::init([] {
        return Sweep{{.names = kNames}, {}};
      }))
      .def("set_option",
           [](Sweep& s, const std::string& setting, const std::string& text) {
             set_setting(s.request, kNames, setting, text);
           })
      .def_static("settings", &settings_alone<SweepRequest>)
      .def("draw", [](Sweep& s) { s.runs = runs_of(s.request); })
      .def("__len__", [](const Sweep& s) { return s.runs.values.size(); })
      .def("run",
           [](const Sweep& s, std::size_t run) {
             py::list values;
             for (const SweepValue& value : s.values(run))
               values.append(py::make_tuple(value.key, value.value));
             return py::make_tuple(values, py::bool_(s.runs.test.at(run)),
                                   seed_of_run(*s.request.seed, static_cast<int>(run)));
           })
      .def("refuse",
           [](const Sweep& s, std::size_t run, std::size_t place, const std::string& why) {
             throw InputError(s.values(run).at(place).position, why);
           });
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<SceneHandle, std::shared_ptr<SceneHandle>> scene(module, "Scene");
  scene.def(py::init<>())
      .def(py::init<const SceneHandle&>())
      .def("read_file", &SceneHandle::read_file)
      .def("read_text", &SceneHandle::read_text)
      .def("take_warnings", [](SceneHandle& s) { return std::exchange(s.warnings, {}); })
      .def("set_flame",
           [](SceneHandle& s, const std::string& name, const Voxels& voxels, double ambient) {
             s.set_flame(name, flame_of(voxels, "temperature", "absorption", ambient, {}));
           })
      .def("validate",
           [](SceneHandle& s) {
             for (const SceneIssue& issue : validate(s.document()))
               s.warnings.push_back(to_string(issue));
           })
      .def("design_json", [](const SceneHandle& s) {
        validate(s.document());
        return design_json(s.scene_of_camera());
      });
  bind_values(scene);
  scene
      .def_property_readonly("cameras",
                             [](const SceneHandle& s) { return camera_names(s.scene()); })
      .def_property("camera", &SceneHandle::camera, &SceneHandle::set_camera)
      .def_property_readonly("frames", &SceneHandle::frames)
      .def("move_to_time", &SceneHandle::move_to_time)
      .def("move_to_frame", &SceneHandle::move_to_frame)
      .def_property_readonly(
          "columns", [](const SceneHandle& s) { return s.scene_of_camera().camera.sensor.columns; })
      .def_property_readonly(
          "rows", [](const SceneHandle& s) { return s.scene_of_camera().camera.sensor.rows; })
      .def_property_readonly("channels", [](const SceneHandle& s) {
        std::vector<std::string> names;
        for (const ChannelSpec& channel : s.scene().channels) names.push_back(channel.name);
        return names;
      });
  module.def("schema", &schema);
  bind_sweep(module);
}

}  // namespace plenoflame::python
