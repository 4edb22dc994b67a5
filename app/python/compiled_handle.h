#pragma once
#include <array>
#include <memory>

#include "plenoflame/render/compiled_camera.h"
#include "runnable.h"
#include "scene_handle.h"

namespace plenoflame::python {

/// A camera whose rays are found once, or read from a file.
class CompiledCameraRun : public Runnable {
 public:
  void run(const Execution& execution) override;

  std::shared_ptr<SceneHandle> scene;
  CompileSettings settings;
  std::shared_ptr<const CompiledCamera> rays;  ///< nullptr: none yet
};

void bind_compiled_camera(pybind11::module_& module);

}  // namespace plenoflame::python
