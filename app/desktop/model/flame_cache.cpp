#include "model/flame_cache.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "plenoflame/volumes/flame_file.h"

namespace plenoflame::desktop {
namespace {

/// A medium that several compiled scenes share.
class SharedMedium : public Medium {
 public:
  explicit SharedMedium(std::shared_ptr<const Medium> medium) : medium_(std::move(medium)) {}
  int channel_count() const override { return medium_->channel_count(); }
  bool is_grey() const override { return medium_->is_grey(); }
  void absorptions(Vec3 world, double* each) const override { medium_->absorptions(world, each); }
  Box bounds() const override { return medium_->bounds(); }
  std::vector<Box> occupied() const override { return medium_->occupied(); }
  bool is_costly() const override { return medium_->is_costly(); }
  double feature_size() const override { return medium_->feature_size(); }
  void integrate(const RayBatch<float>& rays, const MediumOptions& options,
                 RadianceBatch<float> out, MediumCounters& counters) const override {
    medium_->integrate(rays, options, out, counters);
  }
  void integrate(const RayBatch<double>& rays, const MediumOptions& options,
                 RadianceBatch<double> out, MediumCounters& counters) const override {
    medium_->integrate(rays, options, out, counters);
  }
  MediumSample sample(Vec3 world) const override { return medium_->sample(world); }
  double source(int channel, double temperature) const override {
    return medium_->source(channel, temperature);
  }
  double coefficients(Vec3 world, double* emission) const override {
    return medium_->coefficients(world, emission);
  }
  void append_breakpoints(const Ray& ray, std::vector<double>& t) const override {
    medium_->append_breakpoints(ray, t);
  }
  std::string description() const override { return medium_->description(); }

 private:
  std::shared_ptr<const Medium> medium_;
};

/// When a flame's file was written; 0: there is none.
long long modified_time(const FlameSpec& flame, const std::string& folder) {
  if (flame.kind != FlameKind::vdb) return 0;
  std::error_code error;
  const auto time =
      std::filesystem::last_write_time(std::filesystem::path(folder) / flame.file, error);
  return error ? 0 : static_cast<long long>(time.time_since_epoch().count());
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

std::unique_ptr<Medium> FlameCache::load(const FlameSpec& flame, const std::string& folder,
                                         const std::vector<SourceFunction>& channels,
                                         const Execution& execution) {
  FlameSpec unnamed = flame;
  unnamed.name.clear();
  for (EllipsoidSpec& layer : unnamed.layers) layer.name.clear();
  const long long modified = modified_time(flame, folder);
  {
    const std::lock_guard lock(mutex_);
    for (Entry& entry : entries_)
      if (entry.flame == unnamed && entry.folder == folder && entry.channels == channels &&
          entry.modified == modified) {
        entry.generation = generation_;
        return std::make_unique<SharedMedium>(entry.medium);
      }
  }
  std::shared_ptr<const Medium> medium = flame.kind == FlameKind::vdb
                                             ? load_flame(flame, folder, channels, execution)
                                             : load_core_medium(flame, folder, channels, execution);
  const std::lock_guard lock(mutex_);
  ++loads_;
  entries_.push_back({unnamed, folder, channels, modified, medium, generation_});
  return std::make_unique<SharedMedium>(medium);
}

}  // namespace plenoflame::desktop
