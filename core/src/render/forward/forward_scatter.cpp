// Bundles in media that scatter.
#include <algorithm>
#include <limits>

#include "plenoflame/base/constants.h"
#include "plenoflame/sampling/sobol.h"
#include "render/forward/bundle_collisions.h"
#include "render/forward/forward_work.h"
#include "render/transport/phase_function.h"
#include "sampling/directions.h"

namespace plenoflame {
namespace {

constexpr std::uint64_t kCollisionSeed = 0x636f6c6c696465u;  ///< apart from the bundles' numbers

}  // namespace

/// Moves all bundles to their next scattering or reflection; absorbed and escaped bundles end.
/// @param step number of the place along the bundles' paths
void SurfaceBundles::meet_places(std::vector<Bundle>& bundles, std::uint64_t step, Work& work,
                                 ForwardChunk& chunk) const {
  BundleCollisions collisions(scene_, *majorants_);
  std::vector<double> happens;  // density without the path's transmittance, per bundle and node
  work.segments.clear();
  const bool grey = work.segments.is_grey();
  std::size_t kept = 0;
  for (Bundle bundle : bundles) {
    SurfaceHit hit;
    const bool ends =
        scene_.surfaces && scene_.surfaces->intersect(bundle.ray, 0, kInfinity, bundle.from, hit);
    NoiseStream noise(mix64(settings_.seed ^ kCollisionSeed) + step,
                      static_cast<std::uint64_t>(bundle.index));
    const BundleCollisions::Event event =
        collisions.next(bundle.ray, ends ? hit.t : kInfinity, bundle.driver, noise);
    if (event.fate == BundleCollisions::Fate::absorbed) continue;
    bundle.scatterer = event.scatterer;
    const Ray way = bundle.ray;
    if (bundle.scatterer) {
      bundle.ray.origin = way.at(event.t);
      bundle.from = {};
    } else {
      if (!ends || !(hit.reflectivity > 0) || !bundle.lights_surfaces) continue;
      if (bundle.reflections == scene_.scene.render.reflections) continue;
      ++bundle.reflections;
      bundle.weight *= hit.reflectivity;
      bundle.ray.origin = hit.point;
      bundle.normal = hit.normal;
      bundle.from = hit.where;
    }
    if (!grey) {
      work.segments.add(way, bundle.scatterer ? event.t : hit.t);
      for (std::size_t c = 0; c < work.channels; ++c)
        happens.push_back(event.scattering ? event.scattering[c] : 1);
    }
    bundles[kept++] = bundle;
  }
  bundles.resize(kept);
  if (grey) return;
  // Light at every node takes the path of the hero wavelength, so that only densities differ. Each
  // weight is the node's density over the mean of all, for any hero wavelength.
  work.segments.integrate(false, chunk.work.medium);
  for (std::size_t i = 0; i < kept; ++i) {
    const std::size_t before = bundles[i].spectrum;
    double* const now = &happens[i * work.channels];
    double mean = 0;
    for (std::size_t c = 0; c < work.channels; ++c) {
      now[c] *= work.segments.transmittance(i, c);
      mean += work.shares[before + c] * now[c];
    }
    mean /= static_cast<double>(work.channels);
    bundles[i].spectrum = work.spectra.size();
    for (std::size_t c = 0; c < work.channels; ++c) {
      const double change = mean > 0 ? now[c] / mean : 0;
      work.spectra.push_back(work.spectra[before + c] * change);
      work.shares.push_back(work.shares[before + c] * change);
    }
  }
}

/// Adds the arrivals to the chunk, and keeps the spectra of bundles that are still on their way.
void SurfaceBundles::make_room(std::vector<Bundle>& bundles, Work& work,
                               ForwardChunk& chunk) const {
  deposit(work, chunk);
  const auto keep = [&](std::vector<double>& values) {
    std::vector<double> kept;
    kept.reserve(bundles.size() * work.channels);
    for (const Bundle& b : bundles)
      kept.insert(kept.end(), &values[b.spectrum], &values[b.spectrum] + work.channels);
    values = std::move(kept);
  };
  keep(work.spectra);
  keep(work.shares);
  std::size_t next = 0;
  for (Bundle& b : bundles) b.spectrum = work.channels * next++;
}

/// Traces from place to place, until every bundle is absorbed or has escaped. @return false when
/// stopped
bool SurfaceBundles::scatter(std::vector<Bundle>& bundles, Work& work, ForwardChunk& chunk) const {
  for (std::uint64_t step = 0; !bundles.empty(); ++step) {
    if (stop_.stop_requested()) return false;
    meet_places(bundles, step, work, chunk);
    const std::uint64_t block = 4 + 2 * step;
    for (const Bundle& b : bundles)
      send_to_camera(b, !b.scatterer, b.scatterer ? 1 : 1 / constants::pi, block, work, chunk);
    std::erase_if(bundles, [&](Bundle& b) {
      const double u = number(b.index, block + 1, 0), v = number(b.index, block + 1, 1);
      if (!b.scatterer) return !send_on(endless_->find(b.from.surface), u, v, block + 1, b);
      const double cosine = draw_cosine(b.scatterer->spec, u);
      b.ray.direction = normalize(cone_direction(b.ray.direction, 1 - cosine, v));
      return false;
    });
    if (work.arrived.size() >= most_waiting_) make_room(bundles, work, chunk);
  }
  return true;
}

}  // namespace plenoflame
