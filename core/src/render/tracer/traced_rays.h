#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "plenoflame/camera/microlens_lattice.h"
#include "plenoflame/film/film.h"
#include "render/sampling/backward_kernel.h"
#include "render/tracer/backward_surfaces.h"

namespace plenoflame {

/// Rays of one pixel that are consecutive in a block.
struct PixelRays {
  int column, row, first, count;
  int offset;            ///< number of the first ray among those of pixel and microlens
  int points;            ///< rays per replicate, one replicate after the other
  int log2_points;       ///< points are 2^this if they are 1, 2, 4 or 8; else -1
  std::uint32_t random;  ///< bits of pixel, microlens and seed that chose none of the rays
  double scale;          ///< factor on their sum
};

inline constexpr int kMostLog2Points = 3;
/// PixelRays::log2_points for a number of points.
constexpr int log2_points_of(int points) {
  for (int k = 0; k <= kMostLog2Points; ++k)
    if (points == 1 << k) return k;
  return -1;
}

/// Rays as they are drawn, before any optics: entries [first, first + count) of the block. They
/// start at the aim plane, relative to the centre of their microlens, and have the weights of their
/// draw.
template <class Real>
struct DrawnRays {
  const KernelFrame<Real>& frame;
  LensIndex lens;  ///< (0, 0) for rays without a microlens
  int type;        ///< of the microlens; -1: none
  const KernelBlock<Real>& block;
  int first, count;
};

/// A block of rays behind the camera: lines in world axes, relative to the plan's anchor.
template <class Real>
struct TracedRays {
  const KernelBlock<Real>& block;
  int count;                          ///< rays
  int padded;                         ///< number with the repeated rays that fill the last vector
  std::span<const PixelRays> pixels;  ///< pixels of all rays, in their order
  /// The same with their random numbers, for code that follows light; otherwise empty.
  const std::vector<RayGroup>& groups;
  int log2_points;  ///< largest value of the pixels; at least 0
};

/// Receives the rays of a CameraTracer, a block at a time.
template <class Real>
class RayConsumer {
 public:
  virtual ~RayConsumer() = default;
  /// The following blocks belong to this tile. @param index of the film's tiles
  virtual void begin_tile(int index, const PixelWindow& tile) = 0;
  /// Called for all rays of a block before it is traced, if wants_drawn() is true.
  virtual void drawn(const DrawnRays<Real>&) {}
  virtual bool wants_drawn() const { return false; }
  virtual void traced(const TracedRays<Real>& rays) = 0;
};

}  // namespace plenoflame
