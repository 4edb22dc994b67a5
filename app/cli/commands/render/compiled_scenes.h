#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "plenoflame/scene/compile.h"

namespace plenoflame::cli {

/// The picture that a scene is rendered for.
struct SceneUse {
  std::size_t view = 0;  ///< number of the camera whose pictures follow each other
  double begin = 0;      ///< [s] of the exposure
};

/// The compiled scenes of a run. Every camera and every pass over an exposure's moments uses the
/// exposure's scenes again. The next picture of a view shares much with its previous one. Both are
/// kept as long as memory allows.
class CompiledScenes {
 public:
  using Compile = std::function<CompiledScene(const EarlierScenes&)>;

  /// The scene, compiled: as it is kept, or by `compile`, which may take over from what it is
  /// given. Valid until the next call.
  const CompiledScene& of(const Scene& scene, const SceneUse& use, const Compile& compile);
  void clear() { kept_.clear(); }

 private:
  struct Kept {
    Scene scene;  ///< as it was given
    SceneUse use;
    std::unique_ptr<const CompiledScene> compiled;
  };
  /// True for the newest of its view.
  bool is_last(std::size_t index) const;
  void drop();

  std::vector<Kept> kept_;  ///< the newest is the last
  double largest_ = 0;      ///< [byte] that a scene took
};

}  // namespace plenoflame::cli
