#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "render/tracer/ray_generator.h"

namespace plenoflame {

/// The results for rows of pixels (KernelRowPixels).
struct PixelRows {
  template <class Number>
  using Array = std::array<Number, kRowsPixels + kRowLanes>;
  alignas(64) Array<double> x, y, x_low, x_width, far2;
  alignas(64) Array<int> level, sector;
  alignas(64) Array<std::uint64_t> place;
  alignas(64) std::array<Array<std::uint64_t>, kRowWords> random;

  KernelRowPixels arrays();
};

/// Chooses which pixels of a tile look through which microlenses, and with how many points; one
/// object per worker thread. Ray generator and camera tracer follow.
template <class Real>
class PixelSampler {
 public:
  /// @param plan and consumer are kept by reference
  PixelSampler(const BackwardPlan<Real>& plan, RayConsumer<Real>& consumer)
      : plan_(plan), consumer_(consumer), generator_(plan, consumer, counters_) {}
  PixelSampler(const PixelSampler&) = delete;
  PixelSampler& operator=(const PixelSampler&) = delete;
  /// Passes all rays of the tile's pixels to the consumer. @param index of the film's tiles
  void trace(int index, const PixelWindow& tile);
  /// Counts of rays, pairs and skipped work, and the seconds of the optics.
  const WorkCounters& counters() const { return counters_; }

 private:
  void add_microlens(LensIndex lens);
  void add_rows(const KernelRows& rows);
  int spread_pixel(const KernelRows& rows, std::size_t k, double radius,
                   KernelPixel<Real>& made) const;
  void add_bare_pixels(const PupilTable& table, const BeamBounds* beams, int type);
  void add_bare_pixel(int column, int row, const PupilTable& table, const BeamBounds* beams,
                      int type);
  void set_blur(KernelFrame<Real>& frame) const;

  const BackwardPlan<Real>& plan_;
  RayConsumer<Real>& consumer_;
  WorkCounters counters_;
  RayGenerator<Real> generator_;
  PixelWindow tile_;  ///< the tile in work
  /// The cuts of the target, to which queued pixels refer.
  PupilNode node_;
  CutColumn whole_{};
  std::optional<PixelBeam> beam_;  ///< of the target's pixels
  PixelRows rows_;
};

}  // namespace plenoflame
