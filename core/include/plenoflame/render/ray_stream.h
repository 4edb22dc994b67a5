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
/// those of `rays` are padded to rays.size. All of it is valid during the call only.
///
/// A pixel's flux in a channel is the sum over all its rays of etendue * radiance.
///
/// If windows bend rays, each has a line for every straight stretch in air: blocks of all first
/// ones, at the camera, are followed by blocks of all second ones, and so on. The etendue of a line
/// is without what the windows before it keep, its radiance is that of its own stretch as the
/// flames before it let it through, and the sum above holds.
template <class Real>
struct RayBlock {
  /// The window is cut into tiles of Film::kTile x Film::kTile pixels, numbered row by row from its
  /// top left corner. All rays of a pixel are in blocks of the same tile.
  int tile = 0;
  int sequence = 0;  ///< number of the block within its tile, from 0
  /// The way through the camera: one for each wavelength where glasses disperse, else 0.
  int path = 0;
  /// The scene as the rays of this path see it, with its medium, lights and spectral weights (mix).
  const CompiledScene* scene = nullptr;
  int size = 0;

  std::span<const int> columns, rows;  ///< the pixel, counted on the whole sensor
  std::span<const int> replicates;     ///< the independent randomisation that the ray belongs to
  std::span<const LensIndex> lenses;   ///< the microlens; (0, 0) without one
  std::span<const int> types;          ///< type of the microlens; -1: without one
  /// Part of the stop that the ray goes through (PupilFilters::part_at()); empty where no filter
  /// covers any.
  std::span<const int> pupil_parts;
  std::span<const TraceStatus> status;  ///< how the ray ended in the camera, and at which surface
  /// [m^2 sr] weight of the ray's radiance in the flux of its pixel, transmission of the surfaces
  /// of lens and microlens included; 0 for a ray that ended in the camera.
  std::span<const Real> etendue;
  /// [m^2 sr] the same before the camera: the etendue of sensor and pupil that the ray stands for.
  std::span<const Real> sampled_etendue;
  /// Lines in world axes, unit directions away from the camera, positions relative to rays.anchor.
  /// Light is collected from t_near, at the front of the camera, to t_far, at the first solid
  /// surface; infinite where there is none. A ray that ended in the camera is some line in front of
  /// it.
  RayBatch<Real> rays;

  /// [W/(m^2 sr)] of channel c of scene->scene.channels at [c * rays.size + i]: light of flames,
  /// solid surfaces and surroundings, also scattered. Empty for RayStreamContent::rays.
  std::span<const Real> radiance;
  /// Flames from t_near to t_far let it through, first channel. Empty as `radiance` is.
  std::span<const Real> transmittance;

  /// The channel of the whole scene that a channel of this path's scene adds to.
  std::size_t channel_of_scene(std::size_t channel) const {
    return scene->film_channel.empty() ? channel
                                       : static_cast<std::size_t>(scene->film_channel[channel]);
  }
};

enum class RayStreamContent {
  rays,      ///< the rays alone: no medium is integrated, no light of surfaces is followed
  radiance,  ///< also the radiance that each carries
};

template <class Real>
using RayBlockConsumer = std::function<void(const RayBlock<Real>& block, int worker)>;

/// Traces the rays from which the backward estimator makes the picture of settings.window, and
/// hands them to `consumer`, a block at a time. The settings' samples, replicates, seed, window,
/// skip and instruction set hold; `Real` (float or double) is the precision.
///
/// The consumer is called from several threads, of which `worker` counts the number, from 0 to
/// execution.thread_count() - 1; one worker handles all blocks of a tile, in the order of
/// `sequence`. What the consumer adds up per pixel therefore needs no lock and does not depend on
/// the number of threads, nor on the window; what it adds up per tile does not depend on threads.
///
/// With settings.skip pixels and microlenses that cannot see the scene have no rays, and where a
/// pixel sees little of a microlens chance decides whether its rays are drawn; their etendue then
/// counts for those that are not.
/// @param region  where the scene is, for settings.skip, in place of the scene's own content;
/// empty:
///                by its content. Windows bend what is seen: scenes that have some skip nothing
///                then
/// @return false when it was stopped through execution.stop
/// @throws UsageError for the forward estimator, a target error, a time limit, and whatever
/// render() refuses; what the consumer throws, after all threads have ended
template <class Real>
bool stream_rays(const CompiledScene& scene, const RenderSettings& settings,
                 const Execution& execution, const RayBlockConsumer<Real>& consumer,
                 RayStreamContent content = RayStreamContent::rays,
                 const std::vector<Box>& region = {});

}  // namespace plenoflame
