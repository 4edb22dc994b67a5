#pragma once
#include "plenoflame/render/render.h"
#include "support/cameras.h"

namespace plenoflame::test {

/// The light field of a part of the sensor, without standard errors.
inline LightField rendered(const CompiledScene& scene, PixelWindow window, int samples) {
  RenderSettings settings;
  settings.samples = samples;
  settings.window = window;
  settings.standard_error = false;
  return render(scene, settings, threads(2)).light_field;
}

}  // namespace plenoflame::test
