#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "render/sampling/aligned_columns.h"
#include "render/tracer/backward_plan.h"
#include "render/tracer/traced_rays.h"

namespace plenoflame {

/// Random bits of pixel, microlens and seed.
using PairRandom = std::array<std::uint64_t, kRowWords>;

/// The results for rows of pixels (KernelRowPixels).
struct PixelRows {
  template <class Number>
  using Array = std::array<Number, kRowsPixels + kRowLanes>;
  alignas(64) Array<double> x, y, x_low, x_width, far2;
  alignas(64) Array<int> level, sector, visibility;
  alignas(64) Array<std::uint64_t> place;
  alignas(64) std::array<Array<std::uint64_t>, kRowWords> random;

  KernelRowPixels arrays();
};

/// Draws the rays of a tile's pixels and traces them through the camera; one object per worker
/// thread.
template <class Real>
class TileTracer {
 public:
  /// @param plan and consumer are kept by reference
  TileTracer(const BackwardPlan<Real>& plan, RayConsumer<Real>& consumer);
  /// Passes all rays of the tile's pixels to the consumer. @param index of the film's tiles
  void trace(int index, const PixelWindow& tile);
  /// Counts of rays, pairs and skipped work, and the seconds of the optics.
  const WorkCounters& counters() const { return counters_; }

 private:
  void add_microlens(LensIndex lens);
  void add_bare_pixel(int column, int row, const PupilTable& table, const BeamBounds* beams,
                      int type);
  void end_at_microlenses(int first, int count);
  void add_rows(const KernelRows& rows);
  int spread_pixel(const KernelRows& rows, std::size_t k, double radius,
                   KernelPixel<Real>& made) const;
  void set_blur();
  void add_pair(int column, int row, const SampleLevel& level, const PairRandom& random);
  void place_pair(int column, int row, const SampleLevel& level, const PairRandom& random);
  void queue(int column, int row, const SampleLevel& level, int entry, int offset, int count,
             std::uint64_t key);
  void generate_queued();
  void flush_keeping(const KernelPixel<Real>& made);
  void flush();

  const BackwardPlan<Real>& plan_;
  RayConsumer<Real>& consumer_;
  const bool shows_drawn_, keeps_groups_;
  PixelWindow tile_;  ///< the tile in work
  KernelFrame<Real> frame_{};
  /// The frame's cuts, to which queued rays refer.
  PupilNode node_;
  CutColumn whole_{};
  PixelRows rows_;
  /// The microlens' beam, if its pixels are tested one by one.
  std::optional<PixelBeam> beam_;
  KernelBeam kernel_beam_{};
  LensIndex lens_;                    ///< microlens of the frame; (0, 0): none
  int type_ = 0;                      ///< type of this microlens
  KernelMicrolens<Real> own_lens_{};  ///< of the frame, if lenses of a type differ
  bool has_own_lens_ = false;
  /// The first queued_count_ entries are pixels of the frame without rays so far; the next one is
  /// being filled in.
  std::vector<KernelPixel<Real>> queued_;
  int queued_count_ = 0;
  KernelPixel<Real>& pixel() { return queued_[static_cast<std::size_t>(queued_count_)]; }
  /// The first pending_count_ entries are the pixels whose rays are in the block.
  std::vector<PixelRays> pending_;
  int pending_count_ = 0;
  std::span<const PixelRays> pending() const {
    return {pending_.data(), static_cast<std::size_t>(pending_count_)};
  }
  int count_ = 0;        ///< rays in the block
  int log2_points_ = 0;  ///< largest value of the pending pixels
  AlignedColumns<Real> columns_;
  std::vector<int> codes_;
  KernelBlock<Real> block_{};
  std::vector<RayGroup> groups_;  ///< of the pending pixels, for code that follows light
  WorkCounters counters_;
};

}  // namespace plenoflame
