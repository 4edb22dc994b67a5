#pragma once
#include <pybind11/pybind11.h>

#include "plenoflame/base/execution.h"
#include "settings.h"

namespace plenoflame::python {

/// An object that is set up and run, and then gives its result.
class Runnable {
 public:
  virtual ~Runnable() = default;
  /// Called without Python's lock, on a thread of its own.
  virtual void run(const Execution& execution) = 0;
  int threads = 0;  ///< 0: one per processor
};

/// How callers of the package write settings.
inline constexpr SettingNames kNames = {};

/// Runs it. @param on_progress called with the fraction done, on the calling thread; a true result
/// stops the run. It must not raise. @param on_warning called with each warning, at the end
void run_watched(Runnable& runnable, const pybind11::function& on_progress,
                 const pybind11::function& on_warning);

void bind_camera(pybind11::module_& module);
void bind_scene(pybind11::module_& module);
void bind_light_field(pybind11::module_& module);
void bind_light_field_filters(pybind11::module_& module);
void bind_calibrations(pybind11::module_& module);
void bind_measurements(pybind11::module_& module);
void bind_rays(pybind11::module_& module);
void bind_ray_stream(pybind11::module_& module);
void bind_flames(pybind11::module_& module);
void bind_inverse(pybind11::module_& module);

}  // namespace plenoflame::python
