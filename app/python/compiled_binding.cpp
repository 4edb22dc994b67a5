#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "compiled_handle.h"
#include "figures_json.h"
#include "plenoflame/base/error.h"
#include "values.h"

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
  py::class_<Run, Runnable> camera(module, "CompiledCamera");
  attributes(camera, &Run::settings, "error", &CompileSettings::error, "samples",
             &CompileSettings::samples, "level", &CompileSettings::level, "seed",
             &CompileSettings::seed, "margin", &CompileSettings::margin, "window",
             &CompileSettings::window, "region", &CompileSettings::region);
  camera.def(py::init<>())
      .def_readwrite("scene", &Run::scene)
      .def("read",
           [](Run& r, const std::string& path) {
             r.rays = std::make_shared<const CompiledCamera>(read_bundle(path));
           })
      .def("write",
           [](const Run& r, const std::string& path) {
             if (!r.rays) throw Cancelled();
             write_bundle(path, *r.rays);
           })
      .def_property_readonly("figures", [](const Run& r) {
        return r.rays ? compiled_camera_json(*r.rays) : std::string();
      });
}

}  // namespace plenoflame::python
