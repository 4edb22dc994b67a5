#pragma once
#include <string>
#include <vector>

#include "plenoflame/scene/camera_spec.h"
#include "plenoflame/scene/channel_spec.h"
#include "plenoflame/scene/flame_spec.h"
#include "plenoflame/scene/light_spec.h"
#include "plenoflame/scene/render_spec.h"
#include "plenoflame/scene/solid_spec.h"
#include "plenoflame/scene/window_spec.h"

/// The scene as plain values, SI units, as a file states it. Nothing here computes; validation and
/// reading live in scene_file.h, the compiled forms in camera/ and media/.
namespace plenoflame {

struct Scene {
  std::string file;   ///< where it was read from; relative paths start there; empty: none
  CameraSpec camera;  ///< the one that looks at it; a default one where `cameras` has any
  /// The cameras if several look at the scene, each with its own name. Functions that use a scene,
  /// from compile() on, use one camera: for_camera() in cameras.h chooses it.
  std::vector<CameraSpec> cameras = {};
  std::vector<FlameSpec> flames;
  std::vector<SolidSurfaceSpec> surfaces;
  std::vector<WindowSpec> windows = {};
  std::vector<LightSpec> lights;
  std::vector<ChannelSpec> channels{ChannelSpec{}};
  RenderSpec render;
  DevelopSpec develop;
  friend bool operator==(const Scene&, const Scene&) = default;
};

}  // namespace plenoflame
