// Light fields of real cameras' pictures, and calibrations of cameras.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "board_calibration.h"
#include "camera_optimizer.h"
#include "light_field_camera.h"
#include "light_field_filter.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/imported_camera.h"
#include "plenoflame/scene/scene_file.h"
#include "pose_calibration.h"
#include "radiometry_calibration.h"
#include "raw_pictures.h"
#include "scene_handle.h"
#include "setting_tuples.h"
#include "white_calibration.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Rows of an array that have a number in messages: "corners[3]".
std::vector<NumberRow> rows_of(const std::string& name, const Numbers& table) {
  std::vector<NumberRow> rows;
  const auto values = table.unchecked<2>();
  for (py::ssize_t k = 0; k < values.shape(0); ++k)
    rows.push_back({{name + '[' + std::to_string(k) + ']'},
                    {values.data(k, 0), values.data(k, 0) + values.shape(1)}});
  return rows;
}

/// A request whose settings are rows.
template <class Request>
class Requested : public Runnable {
 public:
  static constexpr bool kReadsFiles = requires(Request r) { r.files; };
  Requested() {
    if constexpr (kReadsFiles)
      request.files.names = kNames;
    else
      request.names = kNames;
  }
  void set_option(const std::string& name, const std::string& text) {
    bool known = set_setting(request, kNames, name, text);
    if constexpr (kReadsFiles) known = known || set_setting(request.files, kNames, name, text);
    if (!known) throw UsageError("there is no setting " + kNames(name));
  }
  static py::list settings() {
    py::list list;
    add_settings<Request>(list);
    if constexpr (kReadsFiles) add_settings<RawFileOptions>(list);
    return list;
  }
  Request request;
  std::string figures;
};

/// A request about a camera.
template <class Request>
class OfCamera : public Requested<Request> {
 public:
  SceneDocument document() const {
    SceneDocument found = for_camera(camera->document(), camera->camera());
    check_camera_of(found, "the camera's scene");
    return found;
  }
  std::shared_ptr<SceneHandle> camera;  ///< null: it is not known
};

class RawImport : public OfCamera<RawPicturesRequest> {
 public:
  void run(const Execution& execution) override {
    RawPictures found = import_pictures(request, document(), execution);
    figures = found.report.json_text();
    output = std::make_shared<LightField>(std::move(found.light_field));
  }
  Field output;
};

class RadiometryRun : public OfCamera<RadiometryRequest> {
 public:
  void run(const Execution& execution) override {
    const RadiometryCalibration found = calibrate_radiometry(request, document(), execution);
    figures = found.report.json_text();
    output = radiometry_text(found.table);
  }
  std::string output;
};

class WhiteRun : public OfCamera<WhiteRequest> {
 public:
  void run(const Execution& execution) override {
    const SceneDocument known = camera ? document() : SceneDocument();
    WhiteCalibration found = calibrate_white(request, camera ? &known : nullptr, execution);
    figures = found.report.json_text();
    output = {std::move(found.camera), std::move(found.centres), std::move(found.radii)};
  }
  std::array<std::string, 3> output;  ///< scene, tables of centres and radii
};

class BoardRun : public OfCamera<BoardRequest> {
 public:
  void run(const Execution& execution) override {
    BoardCalibration found = calibrate_corners(request, document(), execution);
    figures = found.report.json_text();
    output = std::move(found.corners);
  }
  std::string output;  ///< table
};

class GeometryRun : public OfCamera<GeometryRequest> {
 public:
  void run(const Execution& execution) override {
    SceneDocument start = document();
    FoundGeometry found = calibrate_geometry(request, start, execution);
    figures = found.report.json_text();
    start.scene.camera = found.fit.camera;
    output = {write_scene(start.scene), std::move(found.poses), std::move(found.residuals)};
  }
  std::array<std::string, 3> output;  ///< scene, tables of poses and residuals
};

class RigRun : public Requested<RigRequest> {
 public:
  void run(const Execution& execution) override {
    const FoundRig found = calibrate_rig(request, execution);
    figures = found.report.json_text();
    output = write_scene(found.scene);
  }
  void add_camera(const SceneHandle& scene, const std::string& file, std::vector<NumberRow> poses) {
    const std::string what = "cameras[" + std::to_string(request.cameras.size()) + ']';
    request.cameras.push_back({what, file, scene.scene_of_camera(), std::move(poses)});
  }
  std::string output;  ///< scene
};

class OptimizeRun : public OfCamera<OptimizeRequest> {
 public:
  void run(const Execution& execution) override {
    const BetterCamera found = optimize_camera(request, document().scene.camera, execution.stop);
    figures = found.report.json_text();
    output = std::make_shared<SceneHandle>(*camera);
    output->change() = replace_camera(camera->scene(), found.camera);
  }
  std::shared_ptr<SceneHandle> output;
};

template <class Run>
py::class_<Run, Runnable> bind_request(py::module_& module, const char* name) {
  py::class_<Run, Runnable> made(module, name);
  made.def(py::init<>())
      .def("set_option", [](Run& r, const std::string& setting,
                            const std::string& text) { r.set_option(setting, text); })
      .def_static("settings", &Run::settings)
      .def_property_readonly("figures", [](const Run& r) { return r.figures; })
      .def_property_readonly("output", [](const Run& r) { return r.output; });
  if constexpr (requires(Run r) { r.camera; }) made.def_readwrite("camera", &Run::camera);
  return made;
}

/// @param pictures the list that takes the pictures themselves
template <class Run, class Request>
void bind_pictures(py::module_& module, const char* name,
                   std::vector<std::string> Request::*pictures) {
  bind_request<Run>(module, name).def("add_picture", [pictures](Run& r, const std::string& file) {
    (r.request.*pictures).push_back(file);
  });
}

/// @param settings "KEY=VALUE" of the scene
py::tuple camera_from(const std::vector<std::string>& files,
                      const std::vector<std::string>& settings, const std::string& format) {
  SceneSettings values;
  values.values = settings;
  values.option = "values";
  const ImportedScene found = import_camera_scene(files, values, format);
  return py::make_tuple(write_scene(found.scene), found.formats, found.notes, found.warnings);
}

}  // namespace

void bind_calibrations(py::module_& module) {
  bind_pictures<RawImport>(module, "RawImport", &RawPicturesRequest::raw);
  bind_pictures<RadiometryRun>(module, "Radiometry", &RadiometryRequest::sources);
  bind_pictures<WhiteRun>(module, "White", &WhiteRequest::white);
  bind_pictures<BoardRun>(module, "Boards", &BoardRequest::boards);
  bind_request<GeometryRun>(module, "Geometry")
      .def("set_corners", [](GeometryRun& r, const std::string& file) { r.request.corners = file; })
      .def("set_table", [](GeometryRun& r, const std::string& name, const Numbers& table) {
        r.request.tables[name] = rows_of(name, table);
      });
  bind_request<RigRun>(module, "Rig")
      .def("add_camera",
           [](RigRun& r, const SceneHandle& scene, const std::string& file,
              const std::string& poses) { r.add_camera(scene, file, read_poses(poses)); })
      .def("add_camera",
           [](RigRun& r, const SceneHandle& scene, const std::string& file, const Numbers& poses) {
             r.add_camera(scene, file, rows_of("poses", poses));
           });
  bind_request<OptimizeRun>(module, "Optimize");
  module.def("import_camera", &camera_from);
}

}  // namespace plenoflame::python
