#pragma once
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "plenoflame/media/medium.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/input_files.h"

namespace plenoflame::desktop {

/// Keeps the flames of the last scene that was compiled, so that a change elsewhere does not load
/// them again. Flames in files are reloaded when the file has changed. Safe to use from several
/// threads.
class FlameCache {
 public:
  /// A loader for compile(); the cache must outlive it.
  MediumLoader loader();
  /// Forgets flames that the last two compilations did not use.
  void next_generation();
  int loads() const { return loads_; }  ///< flames that were really loaded

 private:
  struct Entry {
    FlameSpec flame;
    std::string folder;
    std::vector<SourceFunction> channels;  ///< with the wavelengths that stand for them
    InputFile file;
    std::shared_ptr<const Medium> medium;
    int generation = 0;
  };
  std::shared_ptr<const Medium> load(const FlameSpec& flame, const std::string& folder,
                                     const std::vector<SourceFunction>& channels,
                                     const Execution& execution);
  std::mutex mutex_;
  std::vector<Entry> entries_;
  int generation_ = 0, loads_ = 0;
};

}  // namespace plenoflame::desktop
