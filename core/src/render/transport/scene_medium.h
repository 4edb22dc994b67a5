#pragma once
#include <memory>

#include "plenoflame/media/medium.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// The scene's medium. Without flames it is an empty medium, around the surfaces or else around the
/// point on which the camera is focused.
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
