#include "model/jobs/flame_cache.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "plenoflame/volumes/load_medium.h"

namespace plenoflame::desktop {
namespace {

/// Mark that changes with a flame's file; empty for flames without one.
InputFile file_of(const FlameSpec& flame, const std::string& folder) {
  return flame.kind == FlameKind::vdb ? input_file(flame.file, folder) : InputFile{};
}

}  // namespace

void FlameCache::next_generation() {
  const std::lock_guard lock(mutex_);
  ++generation_;
  std::erase_if(entries_, [&](const Entry& e) { return e.generation + 2 < generation_; });
}

MediumLoader FlameCache::loader() {
  return [this](const FlameSpec& flame, const std::string& folder,
                const std::vector<SourceFunction>& channels,
                const Execution& execution) { return load(flame, folder, channels, execution); };
}

std::shared_ptr<const Medium> FlameCache::load(const FlameSpec& flame, const std::string& folder,
                                               const std::vector<SourceFunction>& channels,
                                               const Execution& execution) {
  FlameSpec unnamed = flame;
  unnamed.name.clear();
  for (EllipsoidSpec& layer : unnamed.layers) layer.name.clear();
  const InputFile file = file_of(flame, folder);
  {
    const std::lock_guard lock(mutex_);
    for (Entry& entry : entries_)
      if (entry.flame == unnamed && entry.folder == folder && entry.channels == channels &&
          entry.file == file) {
        entry.generation = generation_;
        return entry.medium;
      }
  }
  std::shared_ptr<const Medium> medium = load_medium(flame, folder, channels, execution);
  const std::lock_guard lock(mutex_);
  ++loads_;
  entries_.push_back({unnamed, folder, channels, file, medium, generation_});
  return medium;
}

}  // namespace plenoflame::desktop
