#pragma once
#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "camera/block_tracing.h"
#include "plenoflame/film/film.h"
#include "plenoflame/render/render.h"
#include "plenoflame/sampling/sobol.h"
#include "render/backward_kernel.h"
#include "render/backward_surfaces.h"
#include "render/pixel_row_kernel.h"
#include "render/point_range.h"
#include "render/radiance_table.h"
#include "render/scatter_walk.h"
#include "render/scene_beams.h"
#include "render/worth_levels.h"

namespace plenoflame {

/// Entry points of the kernels for one instruction set.
template <class Real>
struct BackwardKernels {
  void (*generate)(const KernelPatch<Real>&, const KernelPixel<Real>*, int, Real,
                   const KernelBlock<Real>&);
  void (*multiply)(const Real*, const Real*, int, Real*);
  void (*add_neighbours)(const Real*, int, int, Real*);
  double (*sum)(const Real*, const Real*, int);
  void (*survey_rows)(const KernelRows&, const KernelRowPixels&);
  void (*judge_rows)(const KernelRows&, const KernelBeam&, const KernelRowPixels&);
};

template <class Real>
BackwardKernels<Real> backward_kernels(Isa isa);

using SobolPools = std::vector<SobolPool>;

/// At most 2^this times less than a point of each randomisation.
inline constexpr int kMostSparseLevels = 2;

/// Pixels of one worth.
struct SampleLevel {
  const SobolPool* pool = nullptr;
  int pool_level = 0;
  /// Only one of 2^so many randomisations gets a point; each counts for the others.
  int sparse = 0;
  double scale = 1;    ///< what a sum counts, compared with one over all points
  int doublings = -1;  ///< of the pool's points, as in RaysOfPixel
};

/// Everything that is the same for all tiles; immutable.
template <class Real>
struct BackwardPlan {
  const CompiledScene* scene = nullptr;
  const Medium* medium = nullptr;  ///< the scene's
  const RenderSettings* settings = nullptr;
  BackwardKernels<Real> kernels;
  CameraKernels<Real> optics;
  KernelCamera<Real> camera;
  std::vector<KernelMicrolens<Real>> microlenses;
  /// Of `microlenses`, for rays that pass between them (clear arrays; -1: opaque); their aim plane
  /// in front of the array [m].
  int between_type = -1;
  Real between_z = 0;
  Vec3 anchor;                        ///< [m] world
  const SceneBeams* beams = nullptr;  ///< nullptr: nothing is skipped
  RadianceTable* table = nullptr;     ///< may stand in for the medium; single precision only
  /// For all plans of a range. One pool per level: level k has 2^-k of the points, for pixels worth
  /// less.
  std::shared_ptr<const SobolPools> pools_of_range;
  const SobolPools& pools() const { return *pools_of_range; }
  /// So many levels follow on which not every randomisation gets a point.
  int sparse_levels = 0;
  std::vector<SampleLevel> levels;                ///< all of them
  std::vector<WorthLevels> worths;                ///< of each type of microlens
  std::unique_ptr<BackwardSurfacePlan> surfaces;  ///< nullptr: no surfaces, no surroundings
  const ScatterPlan* scatter = nullptr;           ///< nullptr: nothing scatters
  std::uint32_t first = 0;                        ///< number of the first point
  double reach = 0;  ///< [m] how far from its microlens a micro-image may extend, centre included
};

/// What a BackwardPass goes by in a precision. @param medium the scene's, or what stands in
/// for it @param light of surfaces; nullptr without them @param scatter nullptr: nothing scatters.
/// Plan and tracers keep pointers to all of them
template <class Real>
BackwardPlan<Real> make_pass_plan(const CompiledScene& scene, const Medium& medium,
                                  const RenderSettings& settings, const PointRange& range,
                                  const SurfaceLightPlan* light, const ScatterPlan* scatter);

/// Rays of one pixel that lie together in a block.
struct RaysOfPixel {
  int column, row, first, count;
  int offset;     ///< number of the first one among those of pixel and microlens
  int points;     ///< so many of those numbers belong to one randomisation, then to the next
  int doublings;  ///< points are 2^this, where that is 1, 2, 4 or 8; else -1
  double scale;   ///< what they count for
};

inline constexpr int kMostDoublings = 3;
/// RaysOfPixel::doublings of so many points.
constexpr int doublings_of(int points) {
  for (int k = 0; k <= kMostDoublings; ++k)
    if (points == 1 << k) return k;
  return -1;
}

/// Receives the rays of a tracer, for those who want more of them than their sum.
template <class Real>
class RaySink {
 public:
  virtual ~RaySink() = default;
  /// Entries [first, first + count) of the block are rays of the patch at the aim plane, relative
  /// to the centre of its microlens, with the weights they were drawn with, before any optics.
  /// @param type of the microlens; -1: between the lenses
  virtual void drawn(const KernelPatch<Real>& patch, int type, const KernelBlock<Real>& block,
                     int first, int count) = 0;
  /// The same entries, behind optics and medium: all are rays of one pixel. Each adds scale *
  /// weight
  /// * radiance to it. Channel c of entry i is radiance[c * stride + i].
  virtual void finished(const RaysOfPixel& rays, const Real* radiance, int stride,
                        const Real* transmittance) = 0;
};

/// Numbers counted by one worker.
struct TileCounters {
  double rays = 0, rays_reached = 0, pairs = 0, pixels_skipped = 0, tiles_skipped = 0;
  double pairs_left_to_chance = 0, pairs_skipped = 0;
  double seconds_generate = 0, seconds_optics = 0, seconds_medium = 0, seconds_surfaces = 0;
  MediumCounters medium;
  RadianceTableCounters table;
};

/// Of the replicates that get a point: for all of them.
inline constexpr std::uint64_t kAllReplicates = ~std::uint64_t{0};

/// Random bits of pixel, microlens and seed.
using PairRandom = std::array<std::uint64_t, kRowWords>;

/// What is found of rows of pixels (KernelRowPixels).
struct PixelRows {
  template <class Number>
  using Array = std::array<Number, kRowsPixels + kRowLanes>;
  alignas(64) Array<double> x, y, x_low, x_width, far2;
  alignas(64) Array<int> level, sector, verdict;
  alignas(64) Array<std::uint64_t> place;
  alignas(64) std::array<Array<std::uint64_t>, kRowWords> random;

  KernelRowPixels arrays();
};

/// Traces the pixels of a tile; one per worker thread.
template <class Real>
class TileTracer {
 public:
  TileTracer(const BackwardPlan<Real>& plan, Film& film);
  /// @param tile of the film
  void render(int tile);
  /// From now on shows all rays to `sink` (nullptr: none).
  void show_rays_to(RaySink<Real>* sink) { sink_ = sink; }
  const TileCounters& counters() const { return counters_; }

 private:
  void add_microlens(LensIndex lens);
  void add_bare_pixel(int column, int row, const PupilTable& table, const BeamBounds* beams,
                      int type);
  void end_at_microlenses(int first, int count);
  void add_rows(const KernelRows& rows);
  std::uint64_t chosen_replicates(std::uint64_t random, int sparse) const;
  void add_pair(int column, int row, const SampleLevel& level, std::uint64_t chosen,
                const PairRandom& random);
  void place_pair(int column, int row, const SampleLevel& level, std::uint64_t chosen,
                  const PairRandom& random);
  void queue(int column, int row, const SampleLevel& level, int entry, int offset, int count,
             std::uint64_t key);
  void generate_queued();
  void flush_keeping(const KernelPixel<Real>& made);
  void flush();
  void integrate(int padded);
  bool integrate_by_table(int padded);
  void add_scattered();
  double not_negative(double sum, double scale);
  void sum_rays(const Real* radiance);
  void add_to_film(int channel);

  const BackwardPlan<Real>& plan_;
  Film& film_;
  RaySink<Real>* sink_ = nullptr;
  int tile_index_ = 0;
  PixelWindow tile_;  ///< that is being rendered
  KernelPatch<Real> patch_{};
  /// Of the patch: what is queued refers to their cuts.
  PupilNode node_;
  CutColumn whole_{};
  PixelRows rows_;
  /// Of the microlens, where its pixels are looked at one by one.
  std::optional<PixelBeam> beam_;
  KernelBeam kernel_beam_{};
  int type_ = 0;                      ///< of the patch
  KernelMicrolens<Real> own_lens_{};  ///< of the patch, where lenses of a type differ
  bool has_own_lens_ = false;
  /// Pixels of the patch whose rays are still to be made, so many; the next one is being filled in.
  std::vector<KernelPixel<Real>> queued_;
  int queued_count_ = 0;
  KernelPixel<Real>& pixel() { return queued_[static_cast<std::size_t>(queued_count_)]; }
  /// Pixels whose rays are in the block, so many.
  std::vector<RaysOfPixel> pending_;
  int pending_count_ = 0;
  std::span<const RaysOfPixel> pending() const {
    return {pending_.data(), static_cast<std::size_t>(pending_count_)};
  }
  int count_ = 0;  ///< rays in the block
  std::vector<Real> storage_;
  std::vector<int> codes_;
  /// Of the block's rays what each adds, and the sums of 2, 4 and 8 from each on.
  std::vector<std::vector<Real>> sums_of_rays_;
  int doublings_ = 0;  ///< so many of them are needed
  KernelBlock<Real> block_{};
  std::unique_ptr<ScatterWalk> scatter_;          ///< nullptr: nothing scatters
  std::unique_ptr<SurfaceBlock<Real>> surfaces_;  ///< nullptr as in the plan
  std::vector<RayGroup> groups_;                  ///< for what follows light: what is pending
  Real* radiance_ = nullptr;
  Real* transmittance_ = nullptr;
  int transmittance_stride_ = 0;  ///< of the nodes; 0: one for all
  Real* fair_factor_ = nullptr;
  std::unique_ptr<RadianceTable::Worker> table_worker_;
  TileCounters counters_;
};

}  // namespace plenoflame
