#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <string>
#include <utility>

#include "compiled_handle.h"
#include "figures_json.h"
#include "plenoflame/base/error.h"

namespace plenoflame::python {

namespace py = pybind11;

void CompiledCameraRun::run(const Execution& execution) {
  if (!scene) throw UsageError("a compiled camera needs a scene");
  rays.reset();
  rays = std::make_shared<const CompiledCamera>(
      compile_camera(*scene->compile(execution), settings, execution));
}

void bind_compiled_camera(py::module_& module) {
  using Run = CompiledCameraRun;
  py::class_<Run, Runnable>(module, "CompiledCamera")
      .def(py::init<>())
      .def("SetScene",
           [](Run& r, std::shared_ptr<SceneHandle> scene) { r.scene = std::move(scene); })
      .def("SetError", [](Run& r, double error) { r.settings.error = error; })
      .def("SetSamples", [](Run& r, int samples) { r.settings.samples = samples; })
      .def("SetLevel", [](Run& r, int level) { r.settings.level = level; })
      .def("SetSeed", [](Run& r, std::uint64_t seed) { r.settings.seed = seed; })
      .def("SetMargin", [](Run& r, double margin) { r.settings.margin = margin; })
      .def("SetWindow",
           [](Run& r, int x, int y, int width, int height) {
             r.settings.window = {x, y, width, height};
           })
      .def("SetRegion",
           [](Run& r, const std::array<double, 3>& lower, const std::array<double, 3>& upper) {
             r.settings.region = {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
           })
      .def("Read",
           [](Run& r, const std::string& path) {
             r.rays = std::make_shared<const CompiledCamera>(read_bundle(path));
           })
      .def("Write",
           [](const Run& r, const std::string& path) {
             if (!r.rays) throw Cancelled();
             write_bundle(path, *r.rays);
           })
      .def("GetFiguresAsJson",
           [](const Run& r) { return r.rays ? compiled_camera_json(*r.rays) : std::string(); });
}

}  // namespace plenoflame::python
