#pragma once
#include <memory>
#include <optional>

#include "plenoflame/scene/compile.h"
#include "render/visibility/beam_bounds.h"
#include "render/visibility/occupied_region.h"
#include "render/visibility/pixel_beams.h"

namespace plenoflame {

/// The microlenses of a camera, and the pixels behind them, that can see anything of its scene. All
/// passes of a rendering share one object.
class SceneBeams {
 public:
  /// @return nullptr if light may come from everywhere, also along paths that windows bend
  static std::unique_ptr<const SceneBeams> make(const CompiledScene& scene);
  /// The same for world boxes in place of what the scene contains.
  static std::unique_ptr<const SceneBeams> make(const CompiledScene& scene, std::vector<Box> lit);
  SceneBeams(const CompiledScene& scene, const std::vector<Box>& lit);
  SceneBeams(const SceneBeams&) = delete;
  SceneBeams& operator=(const SceneBeams&) = delete;

  const BeamBounds& lenses() const { return lenses_; }  ///< without array: pixels
  /// Behind microlenses; nullptr: not known
  const PixelBeams* pixels() const { return pixels_.get(); }
  const std::optional<BeamBounds>& between() const { return between_; }  ///< clear arrays only

 private:
  OccupiedRegion region_;
  BeamBounds lenses_;
  std::unique_ptr<const PixelBeams> pixels_;
  std::optional<BeamBounds> between_;
};

}  // namespace plenoflame
