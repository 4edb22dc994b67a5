#pragma once
#include <cstddef>
#include <functional>
#include <span>

#include "plenoflame/base/execution.h"
#include "plenoflame/camera/microlens_lattice.h"
#include "plenoflame/math/ray_batch.h"
#include "plenoflame/optics/ray_status.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// Rays of some pixels of one tile, behind the camera. Every array has `size` entries, one per ray;
/// the arrays of `rays` are padded to rays.size. The data are valid during the call only.
///
/// A pixel's flux in a channel is the sum over all its rays of etendue * radiance.
///
/// If windows bend rays, each ray has a line for every straight stretch in air. Blocks of all first
/// lines, at the camera, come first; blocks of all second lines follow, and so on. The etendue of a
/// line excludes the light that the windows before it remove. The radiance of a line is that of its
/// own stretch, attenuated by the flames before it. The sum above holds.
template <class Real>
struct RayBlock {
  /// The window is cut into tiles of Film::kTile x Film::kTile pixels, numbered row by row from its
  /// top left corner. All rays of a pixel are in blocks of the same tile.
  int tile = 0;
  int sequence = 0;  ///< number of the block within its tile, from 0
  /// Number of the spectral path: one for each wavelength if glasses disperse, else 0.
  int path = 0;
  /// The scene as the rays of this path see it, with its medium, lights and spectral weights (mix).
  const CompiledScene* scene = nullptr;
  int size = 0;

  std::span<const int> columns, rows;  ///< the pixel, counted on the whole sensor
  std::span<const int> replicates;     ///< the replicate of the ray
  std::span<const LensIndex> lenses;   ///< the microlens; (0, 0) without one
  std::span<const int> types;          ///< type of the microlens; -1 without one
  /// Part of the stop that the ray passes (PupilFilters::part_at()); empty if no filter covers it.
  std::span<const int> pupil_parts;
  std::span<const TraceStatus> status;  ///< how the ray ended in the camera, and at which surface
  /// [m^2 sr] Weight of the ray's radiance in the flux of its pixel. It includes the transmission
  /// of the surfaces of lens and microlens. It is 0 for a ray that ended in the camera.
  std::span<const Real> etendue;
  /// [m^2 sr] Etendue of sensor and pupil that the ray represents, without losses in the camera.
  std::span<const Real> sampled_etendue;
  /// Lines in world axes, unit directions away from the camera, positions relative to rays.anchor.
  /// Light is collected from t_near, at the front of the camera, to t_far, at the first solid
  /// surface. Without a surface t_far is infinite. A ray that ended in the camera is an arbitrary
  /// line in front of it.
  RayBatch<Real> rays;

  /// [W/(m^2 sr)] of channel c of scene->scene.channels at [c * rays.size + i]: light of flames,
  /// solid surfaces and surroundings, also scattered. Empty for RayStreamContent::rays.
  std::span<const Real> radiance;
  /// Transmittance of the flames from t_near to t_far, first channel. Empty if `radiance` is.
  std::span<const Real> transmittance;

  /// The channel of the whole scene that a channel of this path's scene adds to.
  std::size_t channel_of_scene(std::size_t channel) const {
    return scene->film_channel.empty() ? channel
                                       : static_cast<std::size_t>(scene->film_channel[channel]);
  }
};

enum class RayStreamContent {
  rays,      ///< the rays alone: neither the medium nor surfaces are evaluated
  radiance,  ///< also the radiance of each ray
};

template <class Real>
using RayBlockConsumer = std::function<void(const RayBlock<Real>& block, int worker)>;

/// Traces the rays of the backward estimator for the picture of settings.window, and passes them to
/// `consumer`, a block at a time. The function uses samples, replicates, seed, window, skip and
/// instruction set of the settings. `Real` (float or double) is the precision.
///
/// The consumer is called from several threads; `worker` is the thread's number, from 0 to
/// execution.thread_count() - 1. One worker handles all blocks of a tile, in the order of
/// `sequence`. Sums per pixel therefore need no lock. They depend neither on the number of threads
/// nor on the window. Sums per tile do not depend on the number of threads.
///
/// With settings.skip, pixels and microlenses that cannot see the scene have no rays. If a pixel
/// sees little of a microlens, a random draw decides whether its rays are traced. The etendue of
/// traced rays then includes that of the others.
/// @param region of the scene, for settings.skip, in place of the scene's own content. If it is
/// empty, the content counts.
/// @return false when it was stopped through execution.stop
/// @throws UsageError for the forward estimator, a target error, a time limit, and settings that
/// render() refuses; exceptions of the consumer, after all threads have ended
template <class Real>
bool stream_rays(const CompiledScene& scene, const RenderSettings& settings,
                 const Execution& execution, const RayBlockConsumer<Real>& consumer,
                 RayStreamContent content = RayStreamContent::rays,
                 const std::vector<Box>& region = {});

}  // namespace plenoflame
