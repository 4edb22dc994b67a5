// A part of TileTracer: queues the rays of pairs of a pixel and a microlens. A pair needs little
// work and much state, so the whole loop is one function for the compiler.
#include <algorithm>

#include "render/tracer/backward_tile.h"

namespace plenoflame {

/// Queues points [offset, offset + count) of an entry of the level's pool for pixel().
template <class Real>
[[gnu::always_inline]] inline void TileTracer<Real>::queue(int column, int row,
                                                           const SampleLevel& level, int entry,
                                                           int offset, int count,
                                                           std::uint64_t key) {
  const SobolPool& pool = *level.pool;
  KernelPixel<Real>& made = pixel();
  for (int d = 0; d < SobolPool::kDimensions; ++d) {
    made.fractions[d] = pool.fractions(entry, d) + offset;
    __builtin_prefetch(made.fractions[d]);
  }
  made.replicate_numbers = pool.replicate_numbers() + offset;
  made.first = count_;
  made.count = count;
  ++queued_count_;
  // Written in place: a copy of data that are still being written would have to wait for them.
  PixelRays& pending = pending_[static_cast<std::size_t>(pending_count_++)];
  pending.column = column;
  pending.row = row;
  pending.first = count_;
  pending.count = count;
  pending.offset = offset;
  pending.points = pool.points();
  pending.log2_points = level.log2_points;
  pending.scale = level.scale;
  log2_points_ = std::max(log2_points_, level.log2_points);
  if (keeps_groups_) [[unlikely]]
    groups_.push_back({count_, count, offset, level.pool_level, entry, key});
  count_ += count;
}

/// Queues the rays of pixel(), which is complete except for the points.
template <class Real>
[[gnu::always_inline]] inline void TileTracer<Real>::place_pair(int column, int row,
                                                                const SampleLevel& level,
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
  queue(column, row, level, entry, 0, std::min(total, kBlockRays), random[0]);
  for (int offset = kBlockRays; offset < total; offset += kBlockRays) {
    const KernelPixel<Real> each = queued_.front();
    flush();  // the pixel was alone in the block, and will be in the next
    pixel() = each;
    queue(column, row, level, entry, offset, std::min(total - offset, kBlockRays), random[0]);
  }
}

template <class Real>
void TileTracer<Real>::add_pair(int column, int row, const SampleLevel& level,
                                const PairRandom& random) {
  place_pair(column, row, level, random);
}

/// Converts the lit columns and rows of a pixel to shares of the blur.
/// @param k number of the pixel
/// @param radius of the lit disc [m]
/// @return level of the lit share of all places from which the pixel records light
template <class Real>
int TileTracer<Real>::spread_pixel(const KernelRows& rows, std::size_t k, double radius,
                                   KernelPixel<Real>& made) const {
  const SensorBlur& blur = *plan_.blur;
  const double x = rows_.x[k], y = rows_.y[k], reach = 0.5 * rows.pitch_y + rows.blur_y;
  const auto column = [&](double at) { return blur.share((at - x) / rows.pitch); };
  const auto row = [&](double at) { return blur.share((at - y) / rows.pitch_y); };
  const double left = column(rows_.x_low[k]), right = column(rows_.x_low[k] + rows_.x_width[k]);
  const double top = row(std::max(y - reach, rows.centre_y - radius)),
               bottom = std::max(top, row(std::min(y + reach, rows.centre_y + radius)));
  made.x_low = static_cast<Real>(left);
  made.x_width = static_cast<Real>(right - left);
  made.y0 = static_cast<Real>(top);
  made.y1 = static_cast<Real>(bottom);
  made.x = static_cast<Real>(x);
  made.y = static_cast<Real>(y);
  return WorthLevels::of((right - left) * (bottom - top));
}

/// Adds the pixels of rows behind the microlens of the frame.
template <class Real>
void TileTracer<Real>::add_rows(const KernelRows& rows) {
  const int all = rows.rows * rows.count;
  if (!beam_) std::fill_n(rows_.visibility.begin(), all, static_cast<int>(kSeesSomething));
  std::array<int, kRowsPixels> seen;
  int count = 0, lit = 0;
  for (int i = 0; i < all; ++i) {
    const auto k = static_cast<std::size_t>(i);
    seen[static_cast<std::size_t>(count)] = i;
    // Without branches, which the processor could not predict.
    const int gets_light = rows_.x_width[k] > 0 ? 1 : 0;
    lit += gets_light;
    count += gets_light & (rows_.visibility[k] != kSeesNone ? 1 : 0);
  }
  counters_.pairs_skipped += lit - count;
  const double half = 0.5 * rows.pitch_y + rows.blur_y;
  const int last_level = static_cast<int>(plan_.levels.size()) - 1;
  for (int n = 0; n < count; ++n) {
    const auto k = static_cast<std::size_t>(seen[static_cast<std::size_t>(n)]);
    const double y = rows_.y[k];
    if (rows_.visibility[k] == kNeedsExactTest && !beam_->may_meet({rows_.x[k], y})) {
      counters_.pairs_skipped += 1;
      continue;
    }
    const int sector = rows_.sector[k];
    const CutColumn& cuts = node_.cuts.sector(sector);
    KernelPixel<Real>& made = pixel();
    made.x_low = static_cast<Real>(rows_.x_low[k]);
    made.x_width = static_cast<Real>(rows_.x_width[k]);
    made.y0 = static_cast<Real>(y - half);
    made.y1 = static_cast<Real>(y + half);
    const double radius = rows.closes[sector];
    made.radius2 = static_cast<Real>(radius * radius);
    const auto opens = static_cast<double>(cuts.opens);
    made.cuts = rows_.far2[k] <= opens * opens ? &whole_ : &cuts;
    int worth = rows_.level[k];
    if (plan_.blur) [[unlikely]]
      worth = std::max(worth, spread_pixel(rows, k, radius, made));
    const SampleLevel& level = plan_.levels[static_cast<std::size_t>(std::min(worth, last_level))];
    PairRandom random;
    for (std::size_t word = 0; word < kRowWords; ++word) random[word] = rows_.random[word][k];
    const std::uint64_t place = rows_.place[k];
    place_pair(static_cast<int>(place >> 32), static_cast<int>(place & 0xffffffffu), level, random);
  }
}

template void TileTracer<float>::add_rows(const KernelRows&);
template void TileTracer<double>::add_rows(const KernelRows&);
template int TileTracer<float>::spread_pixel(const KernelRows&, std::size_t, double,
                                             KernelPixel<float>&) const;
template int TileTracer<double>::spread_pixel(const KernelRows&, std::size_t, double,
                                              KernelPixel<double>&) const;
template void TileTracer<float>::add_pair(int, int, const SampleLevel&, const PairRandom&);
template void TileTracer<double>::add_pair(int, int, const SampleLevel&, const PairRandom&);

}  // namespace plenoflame
