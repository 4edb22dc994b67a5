#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "camera/block_tracing.h"
#include "plenoflame/render/render.h"
#include "plenoflame/sampling/sobol.h"
#include "render/sampling/backward_kernel.h"
#include "render/sampling/point_range.h"
#include "render/sampling/sensor_blur.h"
#include "render/sampling/worth_levels.h"
#include "render/tracer/backward_surfaces.h"
#include "render/tracer/radiance_table.h"
#include "render/transport/scatter_walk.h"
#include "render/visibility/pixel_row_kernel.h"
#include "render/visibility/scene_beams.h"

namespace plenoflame {

/// Entry points of the kernels for one instruction set.
template <class Real>
struct BackwardKernels {
  void (*generate)(const KernelFrame<Real>&, const KernelPixel<Real>*, int, Real,
                   const KernelBlock<Real>&);
  void (*multiply)(const Real*, const Real*, int, Real*);
  void (*add_neighbours)(const Real*, int, int, Real*);
  double (*sum)(const Real*, const Real*, int);
  void (*set_up_rows)(const KernelRows&, const KernelRowPixels&);
};

template <class Real>
BackwardKernels<Real> backward_kernels(Isa isa);

using SobolPools = std::vector<SobolPool>;

/// Pixels of one worth.
struct SampleLevel {
  const SobolPool* pool = nullptr;
  int pool_level = 0;
  double scale = 1;      ///< weight of a sum, relative to a sum over all points
  int log2_points = -1;  ///< logarithm of the pool's points, as in PixelRays
};

/// Everything that is the same for all tiles; immutable.
template <class Real>
struct BackwardPlan {
  const CompiledScene* scene = nullptr;
  const Medium* medium = nullptr;  ///< medium of the scene
  /// The medium alone lights rays, along their whole lines; else paths in the world are followed.
  bool takes_lines = false;
  const RenderSettings* settings = nullptr;
  BackwardKernels<Real> kernels;
  CameraKernels<Real> optics;
  KernelCamera<Real> camera;
  std::vector<KernelMicrolens<Real>> microlenses;
  /// The entry of `microlenses` for rays that pass between them (clear arrays; -1: opaque), and
  /// their aim plane in front of the array [m].
  int between_type = -1;
  Real between_z = 0;
  Vec3 anchor;                        ///< [m] world
  const SceneBeams* beams = nullptr;  ///< nullptr: nothing is skipped
  /// Bounds of the pixels behind a microlens; nullptr: none is skipped alone.
  const PixelBeams* pixel_beams = nullptr;
  RadianceTable* table = nullptr;  ///< may replace the medium; single precision only
  /// The pools that all plans of a range share, one per level. Level k has 2^-k of the points, for
  /// pixels with less worth.
  std::shared_ptr<const SobolPools> pools_of_range;
  const SobolPools& pools() const { return *pools_of_range; }
  std::vector<SampleLevel> levels;                ///< one entry per level
  std::vector<WorthLevels> worths;                ///< for each type of microlens
  std::unique_ptr<BackwardSurfacePlan> surfaces;  ///< nullptr: no surfaces, no surroundings
  const ScatterPlan* scatter = nullptr;           ///< nullptr: nothing scatters
  PointRange points;
  /// [m] Largest reach of a micro-image from its microlens, with the displacement of its centre.
  double reach = 0;
  std::optional<SensorBlur> blur;     ///< none: pixels record only light that arrives on them
  KernelBlur<Real> blur_of_pixels{};  ///< with blur
};

/// Makes the plan of a BackwardPass for one precision. Plan and tracers keep pointers to all
/// arguments.
/// @param medium of the scene, or its replacement
/// @param pools of another plan of the same settings and range; nullptr: new ones are made
template <class Real>
BackwardPlan<Real> make_pass_plan(const CompiledScene& scene, const Medium& medium,
                                  const RenderSettings& settings, const PointRange& range,
                                  const PathLight& light,
                                  std::shared_ptr<const SobolPools> pools = nullptr);

}  // namespace plenoflame
