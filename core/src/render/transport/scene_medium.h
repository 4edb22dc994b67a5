#pragma once
#include <memory>

#include "plenoflame/media/medium.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// The scene's medium; without flames an empty one, around the surfaces or else around the point
/// that the camera is focused on.
class SceneMedium {
 public:
  explicit SceneMedium(const CompiledScene& scene);
  const Medium& get() const { return medium_; }

 private:
  std::unique_ptr<Medium> empty_;
  const Medium& medium_;
};

/// Tells whether any ray can carry light.
bool has_content(const CompiledScene& scene);

}  // namespace plenoflame
