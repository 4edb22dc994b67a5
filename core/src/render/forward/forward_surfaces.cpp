#include "render/forward/forward_surfaces.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "plenoflame/base/constants.h"
#include "plenoflame/sampling/philox.h"
#include "render/forward/forward_work.h"
#include "render/run/run_control.h"
#include "render/transport/phase_function.h"
#include "render/transport/scene_medium.h"
#include "render/transport/surface_light.h"
#include "sampling/directions.h"

namespace plenoflame {
namespace {

constexpr double kPi = constants::pi;
/// Surroundings, seen from the camera, are a sphere of this multiple of the size of the objects in
/// view.
constexpr double kFarAway = 1e4;
/// Largest number of arrivals of a bundle that leaves for the camera.
constexpr std::uint64_t kMostArrivals = 256;

/// Largest angle of a leaving ray with the axis, as a versine, with a margin for rays between the
/// traced ones.
double field_versine(const PupilSampling& pupils, const Camera& camera) {
  double tangent = 0;
  for (const PupilTable& table : pupils.tables())
    for (const std::vector<Ray>& rays : table.edges)
      for (const Ray& ray : rays)
        tangent = std::max(tangent, std::hypot(ray.direction.x, ray.direction.y) / ray.direction.z);
  tangent *= 1.1;
  if (camera.distortion().present()) tangent += camera.distortion().largest_bend(kInfinity);
  if (camera.lens_moved())
    tangent = std::tan(std::min(1.5, std::atan(tangent) + length(camera.spec().lens.tilt)));
  const double secant = std::hypot(1.0, tangent);
  return tangent * tangent / (secant * (1 + secant));
}

}  // namespace

SurfaceBundles::SurfaceBundles(const CompiledScene& scene, const RenderSettings& settings,
                               const Film& film, const EmissionProposal* proposal,
                               std::stop_token stop, std::size_t most_waiting)
    : scene_(scene),
      settings_(settings),
      proposal_(proposal),
      stop_(std::move(stop)),
      most_waiting_(most_waiting),
      pixels_(scene.camera, film.window(), settings.seed),
      cone_(scene.camera),
      to_camera_(scene.camera.to_world().inverse()),
      field_versine_(field_versine(scene.pupils, scene.camera)) {
  options_.isa = settings.isa;
  options_.skip = settings.skip;
  if (!scene.scatterers.empty()) majorants_ = std::make_unique<MajorantGrid>(*scene.medium);
  add_jobs(proposal);
  const std::optional<Box> lit = [&] {
    Box box = scene.surfaces ? scene.surfaces->bounds() : Box{};
    if (!scene.medium) return box;
    const Box flames = scene.medium->bounds();
    if (box.empty()) return flames;
    return Box{{std::min(flames.lower.x, box.lower.x), std::min(flames.lower.y, box.lower.y),
                std::min(flames.lower.z, box.lower.z)},
               {std::max(flames.upper.x, box.upper.x), std::max(flames.upper.y, box.upper.y),
                std::max(flames.upper.z, box.upper.z)}};
  }();
  if (!lit->empty()) {
    centre_ = 0.5 * (lit->lower + lit->upper);
    radius_ = 0.5 * length(lit->upper - lit->lower) * (1 + 1e-9);
  }
  aim_ = std::make_unique<CameraAim>(scene, centre_, radius_);
  endless_ = std::make_unique<EndlessPlanes>(scene, centre_, radius_, field_versine_);
}

/// Tells whether any surface reflects light.
bool SurfaceBundles::can_reflect() const {
  return std::any_of(scene_.scene.surfaces.begin(), scene_.scene.surfaces.end(),
                     [](const SolidSurfaceSpec& surface) {
                       return surface.material.kind == MaterialKind::lambertian &&
                              surface.material.reflectivity > 0;
                     });
}

void SurfaceBundles::add_jobs(const EmissionProposal* proposal) {
  const bool scatters = !scene_.scatterers.empty();
  const bool reflects = scene_.surfaces && scene_.scene.render.reflections > 0;
  if (proposal) {
    jobs_.push_back({Origin::flame, 0, true});
    if (scatters || (reflects && scene_.scene.render.flame_light))
      jobs_.push_back({Origin::flame, 0, false});
  }
  if (scatters || reflects)
    for (std::size_t i = 0; i < scene_.lights.delta.size(); ++i)
      jobs_.push_back({Origin::delta_light, static_cast<int>(i), false});
  if (!scene_.lights.environment.empty()) {
    jobs_.push_back({Origin::environment, 0, true});
    if (scatters || reflects) jobs_.push_back({Origin::environment, 0, false});
  }
  if (!scene_.surfaces) return;
  for (int i = 0; i < scene_.surfaces->surface_count(); ++i) {
    if (!scene_.surfaces->emission(i, true)) continue;
    jobs_.push_back({Origin::surface, i, true});
    if (scatters || (reflects && can_reflect())) jobs_.push_back({Origin::surface, i, false});
  }
}

double SurfaceBundles::number(std::int64_t bundle, std::uint64_t block, std::size_t word) const {
  return unit_uniform(philox(settings_.seed, static_cast<std::uint64_t>(bundle), block)[word]);
}

bool SurfaceBundles::start_at_flame(const Job& job, Bundle& bundle, Work& work) const {
  const auto a = philox(settings_.seed, static_cast<std::uint64_t>(bundle.index), 1);
  const auto b = philox(settings_.seed, static_cast<std::uint64_t>(bundle.index), 2);
  const EmissionProposal::Point point = proposal_->draw(
      unit_uniform(a[0], a[1]), unit_uniform(b[0]), unit_uniform(b[1]), unit_uniform(b[2]));
  scene_.medium->coefficients(point.position, work.emission.data());
  bundle.ray.origin = point.position;
  bundle.weight /= point.density;
  bundle.lights_surfaces = scene_.scene.render.flame_light;
  if (job.to_camera) return true;
  bundle.ray.direction = cone_direction({0, 0, 1}, 2 * unit_uniform(a[2]), unit_uniform(a[3]));
  bundle.weight *= 4 * kPi;
  return true;
}

/// Density of lines of light from far away. A line is drawn around all finite surfaces, or through
/// the points of one of the infinite planes, each with equal probability.
/// @param any_direction from the surroundings; otherwise all lines have one direction
/// @return [1/m^2] of cross section, for surroundings [1/(m^2 sr)], over all choices together
double SurfaceBundles::line_density(const Ray& line, bool any_direction) const {
  double sum = 0;
  if (radius_ > 0) {
    const Vec3 to_centre = centre_ - line.origin;
    const Vec3 miss = to_centre - dot(to_centre, line.direction) * line.direction;
    if (dot(miss, miss) <= radius_ * radius_)
      sum += 1 / (kPi * radius_ * radius_) / (any_direction ? 4 * kPi : 1);
  }
  for (std::size_t k = 0; k < endless_->count(); ++k) {
    double t = 0;
    if (!endless_->crossing(k, line, t)) continue;
    const double density = endless_->density(k, line.at(t));
    // Directions through a point are drawn with the cosine, from both sides.
    sum += any_direction ? density / (2 * kPi)
                         : density / std::fabs(dot(line.direction, endless_->normal(k)));
  }
  return sum / static_cast<double>(endless_->count() + (radius_ > 0 ? 1 : 0));
}

/// Moves the origin of a line in front of everything that it may meet.
void SurfaceBundles::start_before(Ray& line) const {
  const double nearest = dot(centre_ - line.origin, line.direction);
  line.origin = line.at(endless_->before(line, nearest - 1.01 * radius_));
}

bool SurfaceBundles::start_at_light(const Job& job, Bundle& bundle, Work& work) const {
  const DeltaLight& light = scene_.lights.delta[static_cast<std::size_t>(job.index)];
  work.emission = light.strength;
  const double u = number(bundle.index, 1, 0), v = number(bundle.index, 1, 1);
  if (!light.parallel) {
    bundle.ray = {light.position, cone_direction(light.direction, u * light.versine, v)};
    bundle.weight *= light.solid_angle();
    return true;
  }
  const std::size_t ways = endless_->count() + (radius_ > 0 ? 1 : 0);
  if (ways == 0) return false;
  const auto way = std::min(
      static_cast<std::size_t>(number(bundle.index, 1, 2) * static_cast<double>(ways)), ways - 1);
  if (way == endless_->count()) {
    // A disc across the light, as wide as all finite surfaces.
    bundle.ray = {centre_ + radius_ * std::sqrt(u) * cone_direction(light.direction, 1, v),
                  light.direction};
  } else {
    const EndlessPlanes::Place place = endless_->draw(way, number(bundle.index, 1, 3), u, v);
    if (!(place.density > 0) || dot(light.direction, endless_->normal(way)) == 0) return false;
    bundle.ray = {place.point, light.direction};
  }
  bundle.weight /= line_density(bundle.ray, false);
  start_before(bundle.ray);
  return true;
}

bool SurfaceBundles::start_in_surroundings(const Job& job, Bundle& bundle, Work& work) const {
  work.emission = scene_.lights.environment;
  const double u = number(bundle.index, 1, 0), v = number(bundle.index, 1, 1);
  if (!job.to_camera) {
    const double p = number(bundle.index, 1, 2), q = number(bundle.index, 1, 3);
    const std::size_t ways = endless_->count() + (radius_ > 0 ? 1 : 0);
    if (ways == 0) return false;
    const auto way = std::min(
        static_cast<std::size_t>(number(bundle.index, 2, 0) * static_cast<double>(ways)), ways - 1);
    if (way == endless_->count()) {
      // A sphere around the surfaces; its inside has the radiance of the surroundings.
      const Vec3 outwards = cone_direction({0, 0, 1}, 2 * u, v);
      bundle.ray = {centre_ + radius_ * outwards, cosine_direction(-outwards, p, q)};
    } else {
      const EndlessPlanes::Place place = endless_->draw(way, number(bundle.index, 2, 1), u, v);
      if (!(place.density > 0)) return false;
      const Vec3 normal = endless_->normal(way);
      bundle.ray = {place.point,
                    cosine_direction(number(bundle.index, 2, 2) < 0.5 ? normal : -normal, p, q)};
    }
    bundle.weight /= line_density(bundle.ray, true);
    start_before(bundle.ray);
    return true;
  }
  const Vec3 camera = scene_.camera.to_world().translation;
  const Vec3 axis = scene_.camera.to_world().direction({0, 0, 1});
  const double size = length(centre_ - camera) + radius_ + scene_.camera.lens_distance();
  const double far = kFarAway * size;
  const Vec3 outwards = cone_direction(axis, u * field_versine_, v);
  bundle.ray.origin = camera + far * outwards;
  bundle.normal = -outwards;
  bundle.weight *= 2 * kPi * field_versine_ * far * far;
  return true;
}

bool SurfaceBundles::start_at_surface(const Job& job, Bundle& bundle, Work& work) const {
  const SurfaceScene& surfaces = *scene_.surfaces;
  const auto a = philox(settings_.seed, static_cast<std::uint64_t>(bundle.index), 1);
  const auto b = philox(settings_.seed, static_cast<std::uint64_t>(bundle.index), 2);
  SurfacePoint point;
  std::optional<std::size_t> plane;
  double area = surfaces.area(job.index);
  if (std::isfinite(area)) {
    point = surfaces.point_on(job.index, unit_uniform(a[0], a[1]), unit_uniform(b[0]),
                              unit_uniform(b[1]));
  } else {
    plane = endless_->find(job.index);
    const EndlessPlanes::Place place =
        endless_->draw(*plane, unit_uniform(a[0], a[1]), unit_uniform(b[0]), unit_uniform(b[1]));
    if (!(place.density > 0)) return false;
    point = {place.point, endless_->normal(*plane), {job.index, 0}};
    area = 1 / place.density;
  }
  double sides = 1;
  bundle.normal = point.normal;
  if (surfaces.emission(job.index, false)) {
    sides = 2;
    if (b[2] & 1u) bundle.normal = -point.normal;
  }
  const double* emission = surfaces.emission(job.index, true);
  work.emission.assign(emission, emission + work.channels);
  bundle.ray.origin = point.point;
  bundle.from = point.where;
  bundle.weight *= sides * area;
  if (job.to_camera) return true;
  bundle.weight *= kPi;
  return send_on(plane, unit_uniform(a[2]), unit_uniform(a[3]), 3, bundle);
}

/// Draws the direction of a bundle that leaves a surface diffusely. Its weight is the flux in all
/// directions.
/// @param plane the infinite plane that it leaves, if any
/// @param block of numbers
/// @return false when it leads nowhere
bool SurfaceBundles::send_on(std::optional<std::size_t> plane, double u, double v,
                             std::uint64_t block, Bundle& bundle) const {
  if (!plane) {
    bundle.ray.direction = cosine_direction(bundle.normal, u, v);
    return true;
  }
  const EndlessPlanes::Leaving leaving =
      endless_->leave(*plane, {bundle.ray.origin, bundle.normal}, number(bundle.index, block, 2),
                      number(bundle.index, block, 3), u, v);
  bundle.ray.direction = leaving.direction;
  bundle.weight *= leaving.weight;
  return leaving.weight > 0;
}

bool SurfaceBundles::start(std::int64_t index, const Job& job, Bundle& bundle, Work& work) const {
  bundle = {};
  bundle.index = index;
  bundle.weight = static_cast<double>(jobs_.size());
  bool good = false;
  switch (job.origin) {
    case Origin::flame:
      good = start_at_flame(job, bundle, work);
      break;
    case Origin::delta_light:
      good = start_at_light(job, bundle, work);
      break;
    case Origin::environment:
      good = start_in_surroundings(job, bundle, work);
      break;
    case Origin::surface:
      good = start_at_surface(job, bundle, work);
      break;
  }
  if (!good) return false;
  bundle.spectrum = work.spectra.size();
  work.spectra.insert(work.spectra.end(), work.emission.begin(), work.emission.end());
  if (!scene_.scatterers.empty()) {
    work.shares.resize(work.spectra.size(), 1.0);
    if (!work.segments.is_grey())
      bundle.driver = std::min(
          static_cast<std::size_t>(number(index, 0, 1) * static_cast<double>(work.channels)),
          work.channels - 1);
  }
  return std::any_of(work.emission.begin(), work.emission.end(), [](double e) { return e > 0; });
}

void SurfaceBundles::send_to_camera(const Bundle& bundle, bool has_normal, double factor,
                                    std::uint64_t block, Work& work, ForwardChunk& chunk) const {
  const Vec3 origin = to_camera_.point(bundle.ray.origin);
  if (!cone_.in_front(origin)) return;
  const double u = number(bundle.index, block, 0), v = number(bundle.index, block, 1);
  const ApertureCone::Direction way = aim_->draw(origin, u, v);
  if (!(way.solid_angle > 0)) return;
  const Vec3 direction = scene_.camera.to_world().direction(way.direction);
  double share = has_normal ? dot(bundle.normal, direction) : 1;
  if (bundle.scatterer)
    share = phase_function(bundle.scatterer->spec, dot(bundle.ray.direction, direction));
  if (!(share > 0)) return;
  const std::size_t first_way = work.ways.size();
  double passed = 1;
  if (!find_way({bundle.ray.origin, direction}, bundle.from, passed, work)) return;
  for (std::size_t k = 0; k < work.arrivals.size(); ++k) {
    const Camera::Arrival& arrival = work.arrivals[k];
    const auto pixel = pixels_.find(arrival.sensor_point, bundle.index, kMostArrivals * block + k,
                                    chunk.work.rays_reached);
    if (!pixel) continue;
    work.arrived.push_back(
        {pixel->column, pixel->row, static_cast<int>(bundle.index % settings_.replicates),
         passed * bundle.weight * factor * share * way.solid_angle * arrival.etendue_ratio,
         bundle.spectrum, arrival.pupil_part, first_way, work.ways.size() - first_way});
  }
}

/// Follows light to the camera and into it: fills work.arrivals, and appends to work.ways.
/// @param ray in the world, from @param from @param passed transmittance of the windows
/// @return false when nothing arrives
bool SurfaceBundles::find_way(const Ray& ray, SurfacePart from, double& passed, Work& work) const {
  work.arrivals.clear();
  Ray arriving;
  if (!aim_->follow(ray, work.path, arriving)) return false;
  scene_.camera.trace_from_scene(arriving, work.arrivals);
  if (work.arrivals.empty()) return false;
  const std::vector<AirSegment>& segments = work.path.segments;
  for (std::size_t k = 0; scene_.surfaces && k < segments.size(); ++k)
    if (scene_.surfaces->occluded(segments[k].ray, 0, segments[k].far,
                                  k == 0 ? from : SurfacePart{}))
      return false;
  for (const AirSegment& segment : segments) {
    work.ways.push_back(segment.ray);
    work.ends.push_back(segment.far);
  }
  passed = segments.back().throughput;
  return true;
}

/// Moves all bundles to the surface that they meet next; bundles end without one, or at a black
/// one.
void SurfaceBundles::meet_surfaces(std::vector<Bundle>& bundles, Work& work,
                                   ForwardChunk& chunk) const {
  work.segments.clear();
  std::size_t kept = 0;
  for (Bundle bundle : bundles) {
    SurfaceHit hit;
    if (!scene_.surfaces->intersect(bundle.ray, 0, kInfinity, bundle.from, hit)) continue;
    if (!(hit.reflectivity > 0)) continue;
    work.segments.add(bundle.ray, hit.t);
    bundle.ray.origin = hit.point;
    bundle.normal = hit.normal;
    bundle.from = hit.where;
    bundle.reflectivity = hit.reflectivity;
    bundles[kept++] = bundle;
  }
  bundles.resize(kept);
  work.segments.integrate(false, chunk.work.medium);
  for (std::size_t i = 0; i < kept; ++i) {
    if (work.segments.is_grey()) {
      bundles[i].weight *= work.segments.transmittance(i);
      continue;
    }
    // The bundle has a new spectrum from here on; earlier arrivals keep the old one.
    const std::size_t before = bundles[i].spectrum;
    bundles[i].spectrum = work.spectra.size();
    for (std::size_t c = 0; c < work.channels; ++c)
      work.spectra.push_back(work.spectra[before + c] * work.segments.transmittance(i, c));
  }
}

/// Adds the arrivals to the chunk.
void SurfaceBundles::deposit(Work& work, ForwardChunk& chunk) const {
  chunk.most_waiting = std::max(chunk.most_waiting, work.arrived.size());
  work.segments.clear();
  for (std::size_t i = 0; i < work.ways.size(); ++i) work.segments.add(work.ways[i], work.ends[i]);
  work.segments.integrate(false, chunk.work.medium);
  for (std::size_t i = 0; i < work.arrived.size(); ++i) {
    const Arrived& a = work.arrived[i];
    if (!(a.weight > 0)) continue;
    bool any = false;
    for (std::size_t c = 0; c < work.channels; ++c) {
      double through = work.segments.transmittance(a.first_way, c);
      for (std::size_t k = 1; k < a.ways; ++k)
        through *= work.segments.transmittance(a.first_way + k, c);
      work.emission[c] = a.weight * through * work.spectra[a.spectrum + c];
      any = any || work.emission[c] > 0;
    }
    if (!any) continue;
    chunk.deposits.push_back({a.column, a.row, a.replicate});
    append_channels(scene_, work.emission.data(), a.pupil_part, chunk.flux);
  }
  work.arrived.clear();
  work.ways.clear();
  work.ends.clear();
}

/// Traces reflections from surface to surface.
void SurfaceBundles::reflect(std::vector<Bundle>& bundles, Work& work, ForwardChunk& chunk) const {
  for (int depth = 0; depth < scene_.scene.render.reflections && !bundles.empty(); ++depth) {
    meet_surfaces(bundles, work, chunk);
    const std::uint64_t block = 4 + 2 * static_cast<std::uint64_t>(depth);
    for (Bundle& b : bundles) {
      b.weight *= b.reflectivity;
      send_to_camera(b, true, 1 / kPi, block, work, chunk);
    }
    std::erase_if(bundles, [&](Bundle& b) {
      return !send_on(endless_->find(b.from.surface), number(b.index, block + 1, 0),
                      number(b.index, block + 1, 1), block + 1, b);
    });
  }
}

void SurfaceBundles::trace(std::int64_t first, std::int64_t end, ForwardChunk& chunk) const {
  const auto begin = std::chrono::steady_clock::now();
  Work work(scene_.medium.get(), options_, static_cast<std::size_t>(scene_.node_count()));
  std::vector<Bundle> on_their_way;
  Bundle bundle;
  for (std::int64_t i = first; i < end; ++i) {
    const auto choice =
        static_cast<std::size_t>(number(i, 0, 0) * static_cast<double>(jobs_.size()));
    const Job& job = jobs_[std::min(choice, jobs_.size() - 1)];
    if (!start(i, job, bundle, work)) continue;
    if (job.to_camera)
      send_to_camera(bundle, job.origin != Origin::flame, 1, 3, work, chunk);
    else
      on_their_way.push_back(bundle);
  }
  if (scene_.scatterers.empty())
    reflect(on_their_way, work, chunk);
  else if (!scatter(on_their_way, work, chunk))
    return;
  deposit(work, chunk);
  chunk.work.rays = static_cast<double>(end - first);
  chunk.work.stages.surfaces = seconds_since(begin);
  chunk.done = true;
}

}  // namespace plenoflame
