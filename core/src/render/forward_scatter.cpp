// Bundles in media that scatter.
#include <algorithm>
#include <limits>

#include "plenoflame/base/constants.h"
#include "plenoflame/sampling/sobol.h"
#include "render/bundle_collisions.h"
#include "render/forward_work.h"
#include "render/phase_function.h"
#include "sampling/directions.h"

namespace plenoflame {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr std::uint64_t kCollisionSeed = 0x636f6c6c696465u;  ///< apart from the bundles' numbers

}  // namespace

/// All bundles to where they are scattered or reflected next; what is absorbed or leaves is gone.
/// @param step number of the place on the bundles' ways
void SurfaceBundles::meet_places(std::vector<Bundle>& bundles, std::uint64_t step, Work& work,
                                 ForwardChunk& chunk) const {
  BundleCollisions collisions(scene_);
  std::vector<double> relative;  // to the first node: of what scatters, per bundle and node
  work.segments.clear();
  const bool grey = work.segments.is_grey();
  std::size_t kept = 0;
  for (Bundle bundle : bundles) {
    SurfaceHit hit;
    const bool ends =
        scene_.surfaces && scene_.surfaces->intersect(bundle.ray, 0, kInf, bundle.from, hit);
    NoiseStream noise(mix64(settings_.seed ^ kCollisionSeed) + step,
                      static_cast<std::uint64_t>(bundle.index));
    const BundleCollisions::Event event = collisions.next(bundle.ray, ends ? hit.t : kInf, noise);
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
        relative.push_back(event.relative ? event.relative[c] : 1);
    }
    bundles[kept++] = bundle;
  }
  bundles.resize(kept);
  if (grey) return;
  // What happens was drawn at the first node; the others have less or more of it.
  work.segments.integrate(false, chunk.medium);
  for (std::size_t i = 0; i < kept; ++i) {
    const std::size_t before = bundles[i].spectrum;
    bundles[i].spectrum = work.spectra.size();
    for (std::size_t c = 0; c < work.channels; ++c)
      work.spectra.push_back(work.spectra[before + c] * relative[i * work.channels + c] *
                             work.segments.transmittance(i, c) / work.segments.transmittance(i, 0));
  }
}

/// From place to place, until everything is absorbed or gone.
void SurfaceBundles::scatter(std::vector<Bundle>& bundles, Work& work, ForwardChunk& chunk) const {
  for (std::uint64_t step = 0; !bundles.empty(); ++step) {
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
  }
}

}  // namespace plenoflame
