#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <utility>

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
  scene.def("GetText", [](const SceneHandle& s) { return write_scene(s.scene()); })
      .def("WriteFile",
           [](const SceneHandle& s, const std::string& path) { write_scene_file(path, s.scene()); })
      .def("GetValue",
           [](const SceneHandle& s, const std::string& path) { return get_text(s.scene(), path); })
      .def("SetValue", [](SceneHandle& s, const std::string& path,
                          const std::string& text) { set_text(s.change(), path, text); })
      .def("GetValueAsJson", [](const SceneHandle& s,
                                const std::string& path) { return value_json(s.scene(), path); })
      .def("GetNumberOfPaths", [](const SceneHandle& s) { return scene_paths(s.scene()).size(); })
      .def("GetPath",
           [](const SceneHandle& s, std::size_t i) { return scene_paths(s.scene()).at(i); })
      .def("GetListSize",
           [](const SceneHandle& s, const std::string& path) { return list_size(s.scene(), path); })
      // A negative place becomes one that is too large, and its message says what there is.
      .def("InsertListItem",
           [](SceneHandle& s, const std::string& path, int position) {
             insert_item(s.change(), path, static_cast<std::size_t>(position));
           })
      .def("RemoveListItem", [](SceneHandle& s, const std::string& path, int position) {
        erase_item(s.change(), path, static_cast<std::size_t>(position));
      });
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
      .def("ReadFile", [](SceneHandle& s, const std::string& path) { s.read_file(path); })
      .def("ReadText", [](SceneHandle& s, const std::string& text,
                          const std::string& name) { s.read_text(text, name); })
      .def("DeepCopy", [](SceneHandle& s, const SceneHandle& other) { s = other; })
      .def("TakeWarnings", [](SceneHandle& s) { return std::exchange(s.warnings, {}); })
      .def("SetFlameImage",
           [](SceneHandle& s, const std::string& name, const Voxels& voxels, double ambient) {
             s.set_flame(name, flame_of(voxels, "temperature", "absorption", ambient, {}));
           })
      .def("Validate",
           [](SceneHandle& s) {
             for (const SceneIssue& issue : validate(s.document()))
               s.warnings.push_back(to_string(issue));
           })
      .def("GetDesignAsJson", [](const SceneHandle& s) {
        validate(s.document());
        return design_json(s.scene_of_camera());
      });
  bind_values(scene);
  scene
      .def("GetNumberOfCameras",
           [](const SceneHandle& s) { return camera_names(s.scene()).size(); })
      .def("GetCameraName",
           [](const SceneHandle& s, std::size_t i) { return camera_names(s.scene()).at(i); })
      .def("SetCamera", [](SceneHandle& s, const std::string& name) { s.set_camera(name); })
      .def("GetCamera", [](const SceneHandle& s) { return s.camera(); })
      .def("GetFirstFrame", [](const SceneHandle& s) { return s.frames().first; })
      .def("GetLastFrame", [](const SceneHandle& s) { return s.frames().second; })
      .def("MoveToTime", [](SceneHandle& s, double time) { s.move_to_time(time); })
      .def("MoveToFrame", [](SceneHandle& s, int frame) { s.move_to_frame(frame); })
      .def("GetNumberOfColumns",
           [](const SceneHandle& s) { return s.scene_of_camera().camera.sensor.columns; })
      .def("GetNumberOfRows",
           [](const SceneHandle& s) { return s.scene_of_camera().camera.sensor.rows; })
      .def("GetNumberOfChannels", [](const SceneHandle& s) { return s.scene().channels.size(); })
      .def("GetChannelName",
           [](const SceneHandle& s, std::size_t i) { return s.scene().channels.at(i).name; });
  module.def("GetSchema", &schema);
}

}  // namespace plenoflame::python
