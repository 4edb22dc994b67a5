// The compiled part of the Python package: objects that are set up, run, and then give their
// results. The Python layer (plenoflame/) makes functions with keywords of them.
#include <pybind11/pybind11.h>

#include <exception>
#include <string>
#include <vector>

#include "plenoflame/base/error.h"
#include "runnable.h"
#include "watched_run.h"

namespace plenoflame::python {

namespace py = pybind11;

void run_watched(Runnable& runnable, const py::function& on_progress,
                 const py::function& on_warning) {
  std::vector<std::string> warnings;
  std::exception_ptr failure;
  {
    const py::gil_scoped_release release;
    const auto watch = [&](double fraction) {
      const py::gil_scoped_acquire acquire;
      return py::cast<int>(on_progress(fraction)) != 0;
    };
    try {
      watched_run(runnable.threads, watch, warnings,
                  [&](const Execution& execution) { runnable.run(execution); });
    } catch (...) {
      failure = std::current_exception();
    }
  }
  for (const std::string& warning : warnings) on_warning(warning);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace plenoflame::python

PYBIND11_MODULE(_core, module) {
  namespace py = pybind11;
  using namespace plenoflame::python;
  module.doc() = "Plenoflame's library; use the package plenoflame instead.";
  // Everything that the library throws, in the words of the command line.
  static const py::exception<plenoflame::Error> failure(module, "Failure", PyExc_RuntimeError);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const py::error_already_set&) {
      throw;
    } catch (const py::builtin_exception&) {
      throw;
    } catch (...) {
      PyErr_SetString(failure.ptr(), plenoflame::message_of_current_exception(kNames).c_str());
    }
  });
  py::class_<Runnable>(module, "Runnable")
      .def_readwrite("threads", &Runnable::threads)
      .def("run", &run_watched);
  bind_scene(module);
  bind_camera(module);
  bind_light_field(module);
  bind_light_field_filters(module);
  bind_calibrations(module);
  bind_measurements(module);
  bind_rays(module);
  bind_ray_stream(module);
  bind_flames(module);
  bind_inverse(module);
}
