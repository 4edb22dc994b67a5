#include "commands/render/compiled_scenes.h"

#include <algorithm>
#include <utility>

#include "plenoflame/base/available_memory.h"

namespace plenoflame::cli {

const CompiledScene& CompiledScenes::of(const Scene& scene, const SceneUse& use,
                                        const Compile& compile) {
  const auto same = std::find_if(kept_.begin(), kept_.end(),
                                 [&](const Kept& kept) { return kept.scene == scene; });
  if (same != kept_.end()) {
    same->use = use;
    std::rotate(same, same + 1, kept_.end());
    return *kept_.back().compiled;
  }
  EarlierScenes earlier;
  for (auto kept = kept_.rbegin(); kept != kept_.rend(); ++kept)
    earlier.push_back(kept->compiled.get());
  const double before = available_memory();
  kept_.push_back({scene, use, std::make_unique<const CompiledScene>(compile(earlier))});
  largest_ = std::max(largest_, before - available_memory());
  drop();
  return *kept_.back().compiled;
}

bool CompiledScenes::is_last(std::size_t index) const {
  return std::none_of(kept_.begin() + static_cast<std::ptrdiff_t>(index) + 1, kept_.end(),
                      [&](const Kept& later) { return later.use.view == kept_[index].use.view; });
}

/// Drops unneeded scenes: earlier exposures of the view, and other cameras' scenes
/// whose flames the newest has, too. The newest of each view stays.
void CompiledScenes::drop() {
  const Kept& newest = kept_.back();
  constexpr double kRoom = 2;  // scenes of the same size must fit, one beside a picture's film
  const bool is_tight = available_memory() < kRoom * largest_;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    const Kept& kept = kept_[i];
    const bool is_wanted =
        kept.use.begin == newest.use.begin && kept.scene.flames != newest.scene.flames && !is_tight;
    if (!is_wanted && !is_last(i)) kept_[i].compiled.reset();
  }
  std::erase_if(kept_, [](const Kept& kept) { return !kept.compiled; });
}

}  // namespace plenoflame::cli
