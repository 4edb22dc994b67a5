#include "render/transport/scatter_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "plenoflame/base/constants.h"
#include "plenoflame/math/ray_span.h"
#include "render/transport/phase_function.h"
#include "sampling/directions.h"
#include "solids/light_direction.h"

namespace plenoflame {
namespace {

constexpr double kRoulette = 0.2;  ///< weight below which Russian roulette may end a walk
/// The emission is sampled with numbers that no walk uses.
constexpr std::uint64_t kFlameSeed = 0x73636174666cu;
constexpr int kFlameCells = 24;  ///< as for the light on surfaces

}  // namespace

ScatterPlan::ScatterPlan(const CompiledScene& compiled, const RenderSettings& settings,
                         const Execution& execution, const SurfaceLightPlan* light)
    : scene(&compiled),
      surface_light(light),
      majorants(*compiled.medium),
      reflections(compiled.scene.render.reflections) {
  options.isa = settings.isa;
  options.skip = settings.skip;
  if (light && light->flame) {
    flame = light->flame.get();
    return;
  }
  own_flame = std::make_unique<EmissionProposal>(*compiled.medium, settings.seed ^ kFlameSeed,
                                                 execution, kFlameCells);
  if (!own_flame->dark()) flame = own_flame.get();
}

std::unique_ptr<const ScatterPlan> make_scatter_plan(const CompiledScene& scene,
                                                     const RenderSettings& settings,
                                                     const Execution& execution,
                                                     const SurfaceLightPlan* light) {
  if (scene.scatterers.empty()) return nullptr;
  return std::make_unique<ScatterPlan>(scene, settings, execution, light);
}

double ScatterWalk::Walk::density(Vec3 way) const {
  return scatterer ? phase_function(scatterer->spec, dot(line.direction, way))
                   : std::max(0.0, dot(normal, way)) / constants::pi;
}

void ScatterWalk::Walk::weigh(const double* light, const double* drawn) {
  double mean = 0;
  for (std::size_t c = 0; c < weight.size(); ++c) mean += density_share[c] * drawn[c];
  mean /= static_cast<double>(weight.size());
  if (!(mean > 0)) {  // the densities are too small for a double
    std::fill(weight.begin(), weight.end(), 0.0);
    return;
  }
  for (std::size_t c = 0; c < weight.size(); ++c) {
    weight[c] *= light[c] / mean;
    density_share[c] *= drawn[c] / mean;
  }
}

ScatterWalk::ScatterWalk(const ScatterPlan& plan)
    : plan_(plan),
      scene_(*plan.scene),
      medium_(*plan.scene->medium),
      bounds_(medium_.bounds()),
      nodes_(static_cast<std::size_t>(medium_.channel_count())),
      segments_(plan.scene->medium.get(), plan.options),
      coefficients_(nodes_),
      place_(3 * nodes_) {}

/// Draws the node of the walk's hero wavelength. In a grey medium all nodes are equal.
void ScatterWalk::draw_driver(Walk& walk) const {
  if (segments_.is_grey()) return;
  const auto chosen = static_cast<std::size_t>(walk.noise.uniform() * static_cast<double>(nodes_));
  walk.driver = std::min(chosen, nodes_ - 1);
}

/// Draws the next place of extinction on the line, at the hero wavelength. @return false: none
bool ScatterWalk::collide(Walk& walk, double& t) {
  return plan_.majorants.draw(walk.line, {0, walk.end}, walk.driver, walk.noise, t,
                              [&](double at, double majorant) {
                                medium_.absorptions(walk.line.at(at), coefficients_.data());
                                return walk.noise.uniform() * majorant < coefficients_[walk.driver];
                              });
}

/// Draws the flame that scatters at a place, in proportion to the scattering coefficients at the
/// hero wavelength. There may be none.
ScatterWalk::Place ScatterWalk::scatter(Walk& walk, Vec3 place) {
  Place found;
  found.scattering = place_.data();
  found.extinction = found.scattering + nodes_;
  found.choice = found.extinction + nodes_;
  medium_.absorptions(place, found.extinction);
  std::fill_n(found.choice, nodes_, 0.0);  // first holds the scattering of all flames
  shares_.clear();
  for (const Scatterer& scatterer : scene_.scatterers) {
    const double albedo = scatterer.albedo(place);
    scatterer.medium->absorptions(place, coefficients_.data());
    for (std::size_t c = 0; c < nodes_; ++c) found.choice[c] += albedo * coefficients_[c];
    shares_.push_back(albedo * coefficients_[walk.driver]);
  }
  if (!(found.choice[walk.driver] > 0)) return found;
  double u = walk.noise.uniform() * found.choice[walk.driver];
  std::size_t chosen = shares_.size();
  for (std::size_t i = 0; i < shares_.size(); ++i) {
    if (!(shares_[i] > 0)) continue;
    chosen = i;  // rounding may leave u above 0 after the last one
    u -= shares_[i];
    if (u <= 0) break;
  }
  found.scatterer = &scene_.scatterers[chosen];
  const double albedo = found.scatterer->albedo(place);
  found.scatterer->medium->absorptions(place, coefficients_.data());
  for (std::size_t c = 0; c < nodes_; ++c) {
    found.scattering[c] = albedo * coefficients_[c];
    if (found.choice[c] > 0) found.choice[c] = found.scattering[c] / found.choice[c];
  }
  return found;
}

/// @return false when the surface reflects nothing
bool ScatterWalk::reflect(Walk& walk, const SurfaceHit& hit) const {
  if (walk.reflections >= plan_.reflections || !(hit.reflectivity > 0)) return false;
  ++walk.reflections;
  for (double& weight : walk.weight) weight *= hit.reflectivity;
  walk.line.origin = hit.point;
  walk.scatterer = nullptr;
  walk.from = hit.where;
  walk.normal = hit.normal;
  return true;
}

/// Tells whether the light of flames counts at a walk's place and on the stretch to it.
bool ScatterWalk::sees_flame(const Walk& walk) const {
  return walk.reflections == 0 || scene_.scene.render.flame_light;
}

/// Sets the line of a walk in its new direction and finds its end.
void ScatterWalk::aim(Walk& walk, Vec3 direction) {
  walk.line.direction = direction;
  walk.end = kInfinity;
  walk.next.where = {};
  if (!plan_.surfaces()) return;
  rays_ += 1;
  if (plan_.surfaces()->intersect(walk.line, 0, kInfinity, walk.from, walk.next))
    walk.end = walk.next.t;
  else
    walk.next.where = {};
}

/// Moves every walk to its next place, and ends walks without one.
void ScatterWalk::move_on(std::vector<Walk>& walks, MediumCounters& counters) {
  const bool grey = segments_.is_grey();  // then densities and light have equal transmittance
  segments_.clear();
  std::vector<std::size_t> collided;
  std::vector<double> light, drawn;  // of these walks, per node, without the path
  std::size_t kept = 0;
  for (Walk& walk : walks) {
    double t = 0;
    if (collide(walk, t)) {
      const Vec3 point = walk.line.at(t);
      const Place place = scatter(walk, point);
      if (!place.scatterer) continue;
      for (std::size_t c = 0; c < nodes_; ++c) place.extinction[c] *= place.choice[c];
      if (grey) {
        walk.weigh(place.scattering, place.extinction);
      } else {
        segments_.add(walk.line, t);
        collided.push_back(kept);
        light.insert(light.end(), place.scattering, place.scattering + nodes_);
        drawn.insert(drawn.end(), place.extinction, place.extinction + nodes_);
      }
      walk.scatterer = place.scatterer;
      walk.from = {};
      walk.line.origin = point;
    } else {
      if (walk.next.where.surface < 0 || !reflect(walk, walk.next)) continue;
      if (!grey) walk.weigh(walk.passed.data(), walk.passed.data());
    }
    if (&walks[kept] != &walk) std::swap(walks[kept], walk);
    ++kept;
  }
  walks.erase(walks.begin() + static_cast<std::ptrdiff_t>(kept), walks.end());
  if (grey) return;
  segments_.integrate(false, counters);
  for (std::size_t i = 0; i < collided.size(); ++i) {
    for (std::size_t c = 0; c < nodes_; ++c) {
      light[i * nodes_ + c] *= segments_.transmittance(i, c);
      drawn[i * nodes_ + c] *= segments_.transmittance(i, c);
    }
    walks[collided[i]].weigh(&light[i * nodes_], &drawn[i * nodes_]);
  }
}

/// Adds the samples of single directions, attenuated along their segments.
void ScatterWalk::add_samples(const std::vector<Walk>& walks, Radiance& radiance,
                              MediumCounters& counters) {
  segments_.integrate(false, counters);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Sample& sample = samples_[i];
    const Walk& walk = walks[sample.walk];
    for (std::size_t c = 0; c < nodes_; ++c)
      radiance[c][static_cast<std::size_t>(walk.ray)] +=
          walk.weight[c] * sample.weight * segments_.transmittance(i, c) * sample.strength[c];
  }
}

void ScatterWalk::add_delta_lights(std::vector<Walk>& walks, Radiance& radiance,
                                   MediumCounters& counters) {
  segments_.clear();
  samples_.clear();
  for (const DeltaLight& light : scene_.lights.delta)
    for (std::size_t i = 0; i < walks.size(); ++i) {
      const Walk& walk = walks[i];
      const std::optional<LightDirection> to = direction_to(light, walk.line.origin);
      if (!to) continue;
      const double share = walk.density(to->way);
      if (!(share > 0)) continue;
      const Ray ray{walk.line.origin, to->way};
      if (plan_.surfaces()) {
        rays_ += 1;
        if (plan_.surfaces()->occluded(ray, 0, to->distance, walk.from)) continue;
      }
      segments_.add(ray, to->distance);
      samples_.push_back({i, to->fall * share, light.strength.data()});
    }
  add_samples(walks, radiance, counters);
}

/// Samples points of emitting surfaces, evenly over their area.
void ScatterWalk::add_emitters(std::vector<Walk>& walks, Radiance& radiance,
                               MediumCounters& counters) {
  const SurfaceLightPlan& light = *plan_.surface_light;
  const SurfaceScene& surfaces = *plan_.surfaces();
  segments_.clear();
  samples_.clear();
  for (std::size_t i = 0; i < walks.size(); ++i) {
    Walk& walk = walks[i];
    const double choice = walk.noise.uniform(), face = walk.noise.uniform();
    const bool given = walk.first && !plan_.flame;
    const double u = given ? walk.first->u[2] : walk.noise.uniform();
    const double v = given ? walk.first->u[3] : walk.noise.uniform();
    std::size_t k = 0;
    while (k + 1 < light.emitting.size() && choice > light.emitting[k].share) ++k;
    const int surface = light.emitting[k].surface;
    const SurfacePoint point = surfaces.point_on(surface, face, u, v);
    const Vec3 to_point = point.point - walk.line.origin;
    const double distance = length(to_point);
    if (!(distance > 0)) continue;
    const Ray ray{walk.line.origin, (1 / distance) * to_point};
    const double share = walk.density(ray.direction);
    const double leaving = -dot(point.normal, ray.direction);
    if (!(share > 0) || leaving == 0) continue;
    const bool front = leaving > 0;
    const double* emission = surfaces.emission(surface, front);
    if (!emission) continue;
    // The first surface on the ray must be this side of this part, so distances need no comparison.
    SurfaceHit hit;
    rays_ += 1;
    if (!surfaces.intersect(ray, 0, kInfinity, walk.from, hit)) continue;
    if (!(hit.where == point.where) || hit.front != front) continue;
    segments_.add(ray, distance);
    const double density = light.emitter_density(surface, distance, std::fabs(leaving));
    samples_.push_back({i, share / (density + share), emission});
  }
  add_samples(walks, radiance, counters);
}

/// Draws a point of the flames in proportion to their emission. The sample is the radiance of the
/// whole line through the point. It is divided by the density with which any point of the line is
/// drawn.
void ScatterWalk::add_flame(std::vector<Walk>& walks, Radiance& radiance,
                            MediumCounters& counters) {
  segments_.clear();
  samples_.clear();
  for (std::size_t i = 0; i < walks.size(); ++i) {
    Walk& walk = walks[i];
    if (!sees_flame(walk)) continue;
    const double choice = walk.first ? walk.first->u[2] : walk.noise.uniform();
    const double u = walk.first ? walk.first->u[3] : walk.noise.uniform();
    const double v = walk.noise.uniform(), w = walk.noise.uniform();
    const Vec3 to_point = plan_.flame->draw(choice, u, v, w).position - walk.line.origin;
    const double distance = length(to_point);
    if (!(distance > 0)) continue;
    const Ray ray{walk.line.origin, (1 / distance) * to_point};
    const double share = walk.density(ray.direction);
    if (!(share > 0)) continue;
    const double density = plan_.flame->direction_density(ray);
    if (!(density > 0)) continue;
    double end = kInfinity;
    if (plan_.surfaces()) {
      SurfaceHit hit;
      rays_ += 1;
      if (plan_.surfaces()->intersect(ray, 0, kInfinity, walk.from, hit)) end = hit.t;
    }
    segments_.add(ray, end);
    samples_.push_back({i, share / (density + share), nullptr});
  }
  segments_.integrate(true, counters);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Walk& walk = walks[samples_[i].walk];
    for (std::size_t c = 0; c < nodes_; ++c)
      radiance[c][static_cast<std::size_t>(walk.ray)] +=
          walk.weight[c] * samples_[i].weight * segments_.radiance(i, static_cast<int>(c));
  }
}

/// Draws the next direction of every walk, and adds the light from there.
void ScatterWalk::go_on(std::vector<Walk>& walks, Radiance& radiance, MediumCounters& counters) {
  const std::vector<double>& environment = scene_.lights.environment;
  std::vector<double> densities;
  segments_.clear();
  for (Walk& walk : walks) {
    const double u = walk.first ? walk.first->u[0] : walk.noise.uniform();
    const double v = walk.first ? walk.first->u[1] : walk.noise.uniform();
    walk.first = nullptr;
    const Vec3 direction =
        walk.scatterer ? normalize(cone_direction(walk.line.direction,
                                                  1 - draw_cosine(walk.scatterer->spec, u), v))
                       : cosine_direction(walk.normal, u, v);
    densities.push_back(walk.density(direction));
    aim(walk, direction);
    segments_.add(walk.line, walk.end);
  }
  segments_.integrate(true, counters);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < walks.size(); ++i) {
    Walk& walk = walks[i];
    // Balance heuristic for light that other samples find, too.
    double of_flame = 0, of_emitter = 1;
    if (sees_flame(walk)) {
      of_flame = 1;
      if (plan_.flame)
        of_flame = densities[i] / (densities[i] + plan_.flame->direction_density(walk.line));
    }
    const int surface = walk.next.where.surface;
    const double* behind = environment.empty() ? nullptr : environment.data();
    if (surface >= 0) {
      behind = plan_.surfaces()->emission(surface, walk.next.front);
      const double cosine = std::fabs(dot(walk.next.normal, walk.line.direction));
      if (behind && plan_.surface_light)
        of_emitter = densities[i] / (densities[i] + plan_.surface_light->emitter_density(
                                                        surface, walk.next.t, cosine));
    }
    double largest = 0;
    for (std::size_t c = 0; c < nodes_; ++c) {
      double arrives = of_flame * segments_.radiance(i, static_cast<int>(c));
      if (behind) arrives += of_emitter * segments_.transmittance(i, c) * behind[c];
      radiance[c][static_cast<std::size_t>(walk.ray)] += walk.weight[c] * arrives;
      largest = std::max(largest, walk.weight[c]);
    }
    if (largest < kRoulette) {
      const double survival = largest / kRoulette;
      if (!(walk.noise.uniform() < survival)) continue;
      for (double& weight : walk.weight) weight /= survival;
    }
    if (!segments_.is_grey()) {
      walk.passed.resize(nodes_);
      for (std::size_t c = 0; c < nodes_; ++c) walk.passed[c] = segments_.transmittance(i, c);
    }
    if (kept != i) std::swap(walks[kept], walk);
    ++kept;
  }
  walks.erase(walks.begin() + static_cast<std::ptrdiff_t>(kept), walks.end());
}

/// At every place: samples the light sources and continues the walk.
void ScatterWalk::visit(std::vector<Walk>& walks, Radiance& radiance, MediumCounters& counters) {
  if (!scene_.lights.delta.empty()) add_delta_lights(walks, radiance, counters);
  if (plan_.surface_light && !plan_.surface_light->emitting.empty())
    add_emitters(walks, radiance, counters);
  if (plan_.flame) add_flame(walks, radiance, counters);
  go_on(walks, radiance, counters);
}

/// The stretch of a line from its entry into the first medium that scatters to its exit from the
/// last.
RaySpan ScatterWalk::scattering_span(const Ray& line, double from, double to) const {
  RaySpan all{kInfinity, -kInfinity};
  for (const Scatterer& scatterer : scene_.scatterers) {
    const RaySpan span = clip_to_box(scatterer.medium->bounds(), line, from, to);
    if (span.empty()) continue;
    all.near = std::min(all.near, span.near);
    all.far = std::max(all.far, span.far);
  }
  return all;
}

/// Draws the first places, by the extinction, like all others, or evenly. In a thin medium most
/// rays would otherwise meet nothing. The density is that of both ways together.
void ScatterWalk::begin(const std::vector<Start>& starts, std::vector<Walk>& walks,
                        MediumCounters& counters) {
  struct Evenly {
    double share, density;  ///< share of the rays; [1/m]
  };
  std::vector<Evenly> evenly;
  std::vector<double> places;  // the results of scatter() for each walk
  segments_.clear();
  for (const Start& start : starts) {
    const RaySpan span = clip_to_box(bounds_, start.line, start.near, start.far);
    const RaySpan inside = scattering_span(start.line, span.near, span.far);
    if (span.empty() || inside.empty()) continue;
    Walk walk(start.ray, {start.line.at(span.near), start.line.direction}, start.key, nodes_);
    draw_driver(walk);
    walk.end = span.far - span.near;
    double t = 0;
    if (start.even > 0 && walk.noise.uniform() < start.even)
      t = inside.near - span.near + walk.noise.uniform() * (inside.far - inside.near);
    else if (!collide(walk, t))
      continue;
    const Vec3 point = walk.line.at(t);
    const Place place = scatter(walk, point);
    if (!place.scatterer) continue;
    walk.scatterer = place.scatterer;
    segments_.add(walk.line, t);
    evenly.push_back({start.even, 1 / (inside.far - inside.near)});
    places.insert(places.end(), place_.begin(), place_.end());
    walk.line.origin = point;
    walks.push_back(std::move(walk));
  }
  segments_.integrate(false, counters);
  for (std::size_t i = 0; i < walks.size(); ++i) {
    double* const scattering = &places[3 * i * nodes_];
    double* const extinction = scattering + nodes_;
    const double* const choice = extinction + nodes_;
    const auto [share, density] = evenly[i];
    for (std::size_t c = 0; c < nodes_; ++c) {
      const double through = segments_.transmittance(i, c);
      scattering[c] *= through;
      extinction[c] = choice[c] * ((1 - share) * extinction[c] * through + share * density);
    }
    walks[i].weigh(scattering, extinction);
  }
}

/// Follows walks from place to place until all have ended.
void ScatterWalk::follow(std::vector<Walk>& walks, Radiance& radiance, MediumCounters& counters) {
  while (!walks.empty()) {
    visit(walks, radiance, counters);
    move_on(walks, counters);
  }
}

void ScatterWalk::add(const std::vector<Start>& starts, Radiance& radiance,
                      MediumCounters& counters) {
  std::vector<Walk> walks;
  begin(starts, walks, counters);
  follow(walks, radiance, counters);
}

void ScatterWalk::add_surfaces(const std::vector<SurfacePath>& paths,
                               const std::vector<SurfaceLight::First>& first, Radiance& radiance,
                               MediumCounters& counters) {
  std::vector<Walk> walks;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const SurfacePath& path = paths[i];
    if (const double* emission = plan_.surfaces()->emission(path.hit.where.surface, path.hit.front))
      for (std::size_t c = 0; c < nodes_; ++c)
        radiance[c][static_cast<std::size_t>(path.ray)] += emission[c];
    walks.emplace_back(path.ray, Ray{}, path.key, nodes_);
    if (!reflect(walks.back(), path.hit)) {
      walks.pop_back();
      continue;
    }
    draw_driver(walks.back());
    if (i < first.size()) walks.back().first = &first[i];
  }
  follow(walks, radiance, counters);
}

}  // namespace plenoflame
