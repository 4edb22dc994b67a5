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
#include "voxels.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;

void bind_values(py::class_<SceneHandle, std::shared_ptr<SceneHandle>>& scene) {
  const auto path = py::arg("path");
  scene.def_property_readonly("text", [](const SceneHandle& s) { return write_scene(s.scene()); })
      .def(
          "write_file",
          [](const SceneHandle& s, const std::string& file) { write_scene_file(file, s.scene()); },
          path)
      .def_property_readonly("paths", [](const SceneHandle& s) { return scene_paths(s.scene()); })
      .def(
          "value",
          [](const SceneHandle& s, const std::string& key) { return get_text(s.scene(), key); },
          path)
      .def(
          "value_json",
          [](const SceneHandle& s, const std::string& key) { return value_json(s.scene(), key); },
          path)
      .def(
          "set_value",
          [](SceneHandle& s, const std::string& key, const std::string& text) {
            set_text(s.change(), key, text);
          },
          path, py::arg("text"))
      .def(
          "list_size",
          [](const SceneHandle& s, const std::string& key) { return list_size(s.scene(), key); },
          path)
      // A negative place becomes one that is too large, and its message says what there is.
      .def(
          "insert",
          [](SceneHandle& s, const std::string& key, int position) {
            insert_item(s.change(), key, static_cast<std::size_t>(position));
          },
          path, py::arg("position"))
      .def(
          "remove",
          [](SceneHandle& s, const std::string& key, int position) {
            erase_item(s.change(), key, static_cast<std::size_t>(position));
          },
          path, py::arg("position"));
}

/// The keys of the scene's schema, and what is said about each there.
py::list schema() {
  py::list keys;
  for (const SchemaKey& key : schema_keys())
    keys.append(py::make_tuple(key.path, key.description, si_unit(key.dimension), range_text(key)));
  return keys;
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<SceneHandle, std::shared_ptr<SceneHandle>> scene(module, "Scene");
  scene.def(py::init<>())
      .def(py::init<const SceneHandle&>(), py::arg("other"))
      .def(
          "read_file", [](SceneHandle& s, const std::string& path) { s.read_file(path); },
          py::arg("path"))
      .def(
          "read_text",
          [](SceneHandle& s, const std::string& text, const std::string& name) {
            s.read_text(text, name);
          },
          py::arg("text"), py::arg("name"))
      .def("take_warnings", [](SceneHandle& s) { return std::exchange(s.warnings, {}); })
      .def(
          "set_flame",
          [](SceneHandle& s, const std::string& name, const Voxels& voxels, double ambient) {
            s.set_flame(name, flame_of(voxels, "temperature", "absorption", ambient, {}));
          },
          py::arg("name"), py::arg("voxels"), py::arg("ambient"))
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
      .def_property(
          "camera", [](const SceneHandle& s) { return s.camera(); },
          [](SceneHandle& s, const std::string& name) { s.set_camera(name); })
      .def_property_readonly("frames", [](const SceneHandle& s) { return s.frames(); })
      .def(
          "move_to_time", [](SceneHandle& s, double time) { s.move_to_time(time); },
          py::arg("seconds"))
      .def(
          "move_to_frame", [](SceneHandle& s, int frame) { s.move_to_frame(frame); },
          py::arg("number"))
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
}

}  // namespace plenoflame::python
