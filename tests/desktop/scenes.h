#pragma once
#include <string>

namespace plenoflame::desktop::test {

/// The paper's earlier camera, but with a sensor that is rendered in a blink.
inline std::string small_scene_text() {
  return R"([camera]
preset = "paper-previous-60x60"

[camera.sensor]
columns = 200
rows = 180
pixel_pitch = "100 um"

[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]

[render]
samples = 32
)";
}

}  // namespace plenoflame::desktop::test
