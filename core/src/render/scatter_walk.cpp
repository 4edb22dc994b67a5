#include "render/scatter_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "plenoflame/math/ray_span.h"
#include "sampling/directions.h"

namespace plenoflame {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kRoulette = 0.2;  ///< weight below which a walk may end

}  // namespace

double phase_function(const ScatteringSpec& spec, double cosine) {
  if (spec.phase == PhaseFunction::rayleigh)
    return 3 * (1 + cosine * cosine) / (16 * constants::pi);
  const double g = spec.asymmetry, base = 1 + g * g - 2 * g * cosine;
  return (1 - g * g) / (4 * constants::pi * base * std::sqrt(base));
}

double draw_cosine(const ScatteringSpec& spec, double u) {
  if (spec.phase == PhaseFunction::rayleigh) {
    // c^3 + 3 c = 8 u - 4, by Cardano.
    const double a = 4 * u - 2, root = std::cbrt(a + std::sqrt(a * a + 1));
    return std::clamp(root - 1 / root, -1.0, 1.0);
  }
  const double g = spec.asymmetry;
  if (std::fabs(g) < 1e-3) {
    // The first terms in g of the inverse, which would lose its digits.
    const double c = 1 - 2 * u;
    return std::clamp(-c + 1.5 * g * (1 - c * c), -1.0, 1.0);
  }
  const double s = (1 - g * g) / (1 - g + 2 * g * u);
  return std::clamp((1 + g * g - s * s) / (2 * g), -1.0, 1.0);
}

ScatterWalk::ScatterWalk(const CompiledScene& scene, const MediumOptions& options)
    : scene_(scene),
      medium_(*scene.medium),
      bounds_(medium_.bounds()),
      majorant_(medium_.largest_absorption()),
      nodes_(static_cast<std::size_t>(medium_.channel_count())),
      segments_(scene.medium.get(), options),
      coefficients_(nodes_) {
  if (!std::isfinite(majorant_))
    throw InputError("this medium does not know its largest absorption, which scattering needs");
}

/// Draws the next place of extinction behind `from`, by the first node's. @return false: none
bool ScatterWalk::collide(Walk& walk, double from, double& t) const {
  const RaySpan span = clip_to_box(bounds_, walk.line, from, kInf);
  if (span.empty() || !(majorant_ > 0)) return false;
  std::vector<double> each(nodes_);
  t = span.near;
  for (;;) {
    t -= std::log(walk.noise.uniform()) / majorant_;
    if (!(t < span.far)) return false;
    medium_.absorptions(walk.line.at(t), each.data());
    if (walk.noise.uniform() * majorant_ < each[0]) return true;
  }
}

/// Which flame scatters at a place, if any does: drawn in proportion to what each scatters at the
/// first node. The weights get what it scatters at theirs, over the density of place and choice.
const Scatterer* ScatterWalk::scatter(Walk& walk, Vec3 place) {
  double scattering = 0, extinction = 0;
  std::vector<double> shares;
  medium_.absorptions(place, coefficients_.data());
  extinction = coefficients_[0];
  for (const Scatterer& scatterer : scene_.scatterers) {
    scatterer.medium->absorptions(place, coefficients_.data());
    shares.push_back(scatterer.spec.albedo * coefficients_[0]);
    scattering += shares.back();
  }
  if (!(scattering > 0)) return nullptr;
  double u = walk.noise.uniform() * scattering;
  std::size_t chosen = shares.size();
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (!(shares[i] > 0)) continue;
    chosen = i;  // rounding may leave u above 0 behind the last
    u -= shares[i];
    if (u <= 0) break;
  }
  const Scatterer& scatterer = scene_.scatterers[chosen];
  scatterer.medium->absorptions(place, coefficients_.data());
  for (std::size_t c = 0; c < nodes_; ++c)
    walk.weight[c] *= scattering / extinction * (coefficients_[c] / coefficients_[0]);
  return &scatterer;
}

/// Moves every walk to its next place, and ends those that have none.
void ScatterWalk::meet_places(std::vector<Walk>& walks, MediumCounters& counters) {
  segments_.clear();
  ends_.clear();
  std::size_t kept = 0;
  for (Walk& walk : walks) {
    double t = 0;
    // Camera rays are whole lines; all others begin where light was scattered.
    if (!collide(walk, walk.weight.empty() ? -kInf : 0, t)) continue;
    if (walk.weight.empty()) {
      walk.weight.assign(nodes_, 1.0);
      // From where the medium begins.
      const RaySpan span = clip_to_box(bounds_, walk.line, -kInf, kInf);
      walk.line.origin = walk.line.at(span.near);
      t -= span.near;
    }
    if (!segments_.is_grey()) segments_.add(walk.line, t);
    ends_.push_back(t);
    std::swap(walks[kept++], walk);
  }
  walks.erase(walks.begin() + static_cast<std::ptrdiff_t>(kept), walks.end());
  if (segments_.is_grey()) return;
  // The place was drawn by the first node's extinction: see scatter().
  segments_.integrate(false, counters);
  for (std::size_t i = 0; i < walks.size(); ++i) {
    const double drawn = segments_.transmittance(i, 0);
    for (std::size_t c = 1; c < nodes_; ++c)
      walks[i].weight[c] *= segments_.transmittance(i, c) / drawn;
  }
}

void ScatterWalk::add_lights(const std::vector<Walk>& walks,
                             const std::vector<const Scatterer*>& scatterers,
                             std::vector<std::vector<double>>& radiance, MediumCounters& counters) {
  for (const DeltaLight& light : scene_.lights.delta) {
    segments_.clear();
    std::vector<std::pair<std::size_t, double>> samples;
    for (std::size_t i = 0; i < walks.size(); ++i) {
      const Vec3 place = walks[i].line.origin;
      Vec3 way = -light.direction;
      double distance = kInf, fall = 1;
      if (!light.parallel) {
        const Vec3 to_light = light.position - place;
        const double square = dot(to_light, to_light);
        if (!(square > 0)) continue;
        distance = std::sqrt(square);
        way = (1 / distance) * to_light;
        if (!light.inside_cone(-way)) continue;
        fall = 1 / square;
      }
      const double cosine = dot(walks[i].line.direction, way);
      segments_.add({place, way}, distance);
      samples.emplace_back(i, fall * phase_function(scatterers[i]->spec, cosine));
    }
    segments_.integrate(false, counters);
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const Walk& walk = walks[samples[s].first];
      for (std::size_t c = 0; c < nodes_; ++c)
        radiance[c][static_cast<std::size_t>(walk.ray)] +=
            walk.weight[c] * samples[s].second * segments_.transmittance(s, c) * light.strength[c];
    }
  }
}

void ScatterWalk::add(const std::vector<Start>& starts, std::vector<std::vector<double>>& radiance,
                      MediumCounters& counters) {
  std::vector<Walk> walks;
  for (const Start& start : starts)
    walks.push_back({start.ray, start.line, NoiseStream(start.key, 0), {}});
  while (!walks.empty()) {
    meet_places(walks, counters);
    chosen_.clear();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < walks.size(); ++i) {
      Walk& walk = walks[i];
      const Vec3 place = walk.line.at(ends_[i]);
      const Scatterer* scatterer = scatter(walk, place);
      if (!scatterer) continue;
      walk.line.origin = place;
      chosen_.push_back(scatterer);
      std::swap(walks[kept++], walk);
    }
    walks.erase(walks.begin() + static_cast<std::ptrdiff_t>(kept), walks.end());
    add_lights(walks, chosen_, radiance, counters);
    segments_.clear();
    for (std::size_t i = 0; i < walks.size(); ++i) {
      Walk& walk = walks[i];
      const double cosine = draw_cosine(chosen_[i]->spec, walk.noise.uniform());
      walk.line.direction =
          normalize(cone_direction(walk.line.direction, 1 - cosine, walk.noise.uniform()));
      segments_.add(walk.line, kInf);
    }
    segments_.integrate(true, counters);
    const std::vector<double>& environment = scene_.lights.environment;
    kept = 0;
    for (std::size_t i = 0; i < walks.size(); ++i) {
      Walk& walk = walks[i];
      double largest = 0;
      for (std::size_t c = 0; c < nodes_; ++c) {
        double arrives = segments_.radiance(i, static_cast<int>(c));
        if (!environment.empty()) arrives += segments_.transmittance(i, c) * environment[c];
        radiance[c][static_cast<std::size_t>(walk.ray)] += walk.weight[c] * arrives;
        largest = std::max(largest, walk.weight[c]);
      }
      if (largest < kRoulette) {
        const double survival = largest / kRoulette;
        if (!(walk.noise.uniform() < survival)) continue;
        for (double& weight : walk.weight) weight /= survival;
      }
      std::swap(walks[kept++], walk);
    }
    walks.erase(walks.begin() + static_cast<std::ptrdiff_t>(kept), walks.end());
  }
}

}  // namespace plenoflame
