#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "render/sampling/aligned_columns.h"
#include "render/tracer/camera_tracer.h"

namespace plenoflame {

/// Random bits of pixel, microlens and seed.
using PairRandom = std::array<std::uint64_t, kRowWords>;

/// Draws rays from pixels to a target, and hands them to the camera tracer in full blocks.
template <class Real>
class RayGenerator {
 public:
  /// All arguments are kept by reference. @param counters of pairs, and those of CameraTracer
  RayGenerator(const BackwardPlan<Real>& plan, RayConsumer<Real>& consumer, WorkCounters& counters);

  /// Draws the queued rays. The target, and the cuts that queued pixels refer to, may then change.
  void draw();
  RayTarget<Real>& target() { return target_; }
  /// The next pixel, to be filled in except for its points. It then goes to add().
  KernelPixel<Real>& pixel() { return queued_[static_cast<std::size_t>(queued_count_)]; }
  /// Queues the rays of pixel(): all points of an entry of the level's pool.
  [[gnu::always_inline]] void add(int column, int row, const SampleLevel& level,
                                  const PairRandom& random);
  /// Hands on all rays.
  void flush();

 private:
  /// Points [first, first + count) of an entry of a level's pool.
  struct Points {
    const SampleLevel& level;
    int entry, first, count;
  };
  [[gnu::always_inline]] void queue(int column, int row, const Points& points,
                                    const PairRandom& random);
  void flush_keeping(const KernelPixel<Real>& made);

  const BackwardPlan<Real>& plan_;
  CameraTracer<Real> tracer_;
  WorkCounters& counters_;
  const bool keeps_groups_;
  RayTarget<Real> target_;
  /// The first queued_count_ entries are pixels of the target without rays so far; the next one is
  /// being filled in.
  std::vector<KernelPixel<Real>> queued_;
  int queued_count_ = 0;
  /// The first pending_count_ entries are the pixels whose rays are in the block.
  std::vector<PixelRays> pending_;
  int pending_count_ = 0;
  int count_ = 0;        ///< rays in the block
  int log2_points_ = 0;  ///< largest value of the pending pixels
  AlignedColumns<Real> columns_;
  std::vector<int> codes_;
  KernelBlock<Real> block_{};
  std::vector<RayGroup> groups_;  ///< of the pending pixels, for code that follows light
};

template <class Real>
inline void RayGenerator<Real>::queue(int column, int row, const Points& points,
                                      const PairRandom& random) {
  const SobolPool& pool = *points.level.pool;
  KernelPixel<Real>& made = pixel();
  for (int d = 0; d < SobolPool::kDimensions; ++d) {
    made.fractions[d] = pool.fractions(points.entry, d) + points.first;
    __builtin_prefetch(made.fractions[d]);
  }
  made.replicate_numbers = pool.replicate_numbers() + points.first;
  made.first = count_;
  made.count = points.count;
  ++queued_count_;
  // Written in place: a copy of data that are still being written would have to wait for them.
  PixelRays& pending = pending_[static_cast<std::size_t>(pending_count_++)];
  pending.column = column;
  pending.row = row;
  pending.first = count_;
  pending.count = points.count;
  pending.offset = points.first;
  pending.points = pool.points();
  pending.log2_points = points.level.log2_points;
  pending.random = static_cast<std::uint32_t>(random[2]);  // the upper half chose the entry
  pending.scale = points.level.scale;
  log2_points_ = std::max(log2_points_, points.level.log2_points);
  if (keeps_groups_) [[unlikely]]
    groups_.push_back(
        {count_, points.count, points.first, points.level.pool_level, points.entry, random[0]});
  count_ += points.count;
}

template <class Real>
inline void RayGenerator<Real>::add(int column, int row, const SampleLevel& level,
                                    const PairRandom& random) {
  const SobolPool& pool = *level.pool;
  // The upper half of the product is evenly spread over the entries and needs no division.
  const int entry =
      static_cast<int>(((random[2] >> 32) * static_cast<std::uint64_t>(pool.entries())) >> 32);
  const int total = pool.replicates() * pool.points();
  {
    KernelPixel<Real>& made = pixel();
    for (std::size_t d = 0; d < 4; ++d) {
      const std::size_t bits = d % 2 * 32;
      made.shift[d] = static_cast<std::uint32_t>(random[d / 2] >> bits);
      made.second_shift[d] = static_cast<std::uint32_t>(random[3 + d / 2] >> bits);
    }
  }
  counters_.pairs += 1;
  // A pixel's rays are split only if a block cannot hold them. Their distribution over blocks must
  // not depend on neighbours, because results must not depend on the window.
  if (count_ + std::min(total, kBlockRays) > kBlockRays) [[unlikely]]
    flush_keeping(pixel());
  queue(column, row, {level, entry, 0, std::min(total, kBlockRays)}, random);
  for (int first = kBlockRays; first < total; first += kBlockRays) {
    const KernelPixel<Real> each = queued_.front();
    flush();  // the pixel was alone in the block, and will be in the next
    pixel() = each;
    queue(column, row, {level, entry, first, std::min(total - first, kBlockRays)}, random);
  }
}

}  // namespace plenoflame
