#include "camera_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "plenoflame/base/error.h"
#include "plenoflame/scene/validate.h"

namespace plenoflame {
namespace {

constexpr double kDiaphragmWidth = 1.25;  ///< outer over inner diameter

double widest(const Camera& camera) {
  double diameter = camera.spec().lens.diameter;
  for (const SurfaceSpec& s : camera.spec().lens.surfaces)
    diameter = std::max(diameter, s.diameter);
  return diameter;
}

}  // namespace

double surface_height(double vertex, double radius, double r) {
  if (!std::isfinite(radius)) return vertex;
  const double t = std::min(1.0, r * r / (radius * radius));
  return vertex - r * r / (radius * (1 + std::sqrt(1 - t)));
}

double reach_of(const MicrolensAperture& aperture, double angle) {
  const Vec2 way{std::cos(angle), std::sin(angle)};
  double reach = aperture.radius();
  for (int k = 0; k < aperture.pairs(); ++k) {
    const double along = std::fabs(dot(aperture.normal(k), way));
    if (along * reach > aperture.half_width(k)) reach = aperture.half_width(k) / along;
  }
  return reach;
}

std::int64_t SurfaceBuilder::point(Vec3 at, Vec3 normal) {
  mesh_.points.push_back(to_world_.point(at));
  mesh_.normals.push_back(to_world_.direction(normal));
  return static_cast<std::int64_t>(mesh_.points.size()) - 1;
}

void SurfaceBuilder::polygon(std::initializer_list<std::int64_t> ids) {
  mesh_.connectivity.insert(mesh_.connectivity.end(), ids);
  mesh_.offsets.push_back(static_cast<std::int64_t>(mesh_.connectivity.size()));
  mesh_.surfaces.push_back(surface_);
  mesh_.types.push_back(type_);
  mesh_.lenses.push_back(lens_);
}

void SurfaceBuilder::tag(int surface, int type, LensIndex lens) {
  surface_ = surface;
  type_ = type;
  lens_ = lens;
}

void SurfaceBuilder::cap(Vec2 centre, double vertex, double radius, double diameter) {
  add_cap(centre, vertex, radius, [&](double) { return 0.5 * diameter; });
}

void SurfaceBuilder::cap(Vec2 centre, double vertex, double radius,
                         const MicrolensAperture& aperture) {
  add_cap(centre, vertex, radius, [&](double angle) { return reach_of(aperture, angle); });
}

/// @param reach from the middle to the edge, by the angle from x towards y [m]
template <class Reach>
void SurfaceBuilder::add_cap(Vec2 centre, double vertex, double radius, const Reach& reach) {
  const int sectors = tessellation_.sectors, rings = tessellation_.rings;
  const auto normal = [&](double r, double phi) -> Vec3 {
    if (!std::isfinite(radius)) return {0, 0, 1};
    const double s = r / radius;
    return {s * std::cos(phi), s * std::sin(phi), std::sqrt(std::max(0.0, 1 - s * s))};
  };
  const std::int64_t middle = point({centre.x, centre.y, vertex}, {0, 0, 1});
  for (int ring = 1; ring <= rings; ++ring) {
    for (int k = 0; k < sectors; ++k) {
      const double phi = 2 * std::numbers::pi * k / sectors;
      const double r = reach(phi) * ring / rings;
      point({centre.x + r * std::cos(phi), centre.y + r * std::sin(phi),
             surface_height(vertex, radius, r)},
            normal(r, phi));
    }
    const std::int64_t outer = middle + 1 + static_cast<std::int64_t>(ring - 1) * sectors;
    for (std::int64_t k = 0; k < sectors; ++k) {
      const std::int64_t next = (k + 1) % sectors;
      if (ring == 1)
        polygon({middle, outer + k, outer + next});
      else
        polygon({outer - sectors + k, outer + k, outer + next, outer - sectors + next});
    }
  }
}

void SurfaceBuilder::ring(double z, double inner_diameter, double outer_diameter) {
  const std::int64_t sectors = tessellation_.sectors;
  std::int64_t first = -1;
  for (std::int64_t k = 0; k < sectors; ++k) {
    const double phi = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(sectors);
    const double x = 0.5 * std::cos(phi), y = 0.5 * std::sin(phi);
    const std::int64_t id = point({inner_diameter * x, inner_diameter * y, z}, {0, 0, 1});
    point({outer_diameter * x, outer_diameter * y, z}, {0, 0, 1});
    if (k == 0) first = id;
  }
  for (std::int64_t k = 0; k < sectors; ++k) {
    const std::int64_t a = first + 2 * k, b = first + 2 * ((k + 1) % sectors);
    polygon({a, a + 1, b + 1, b});
  }
}

void SurfaceBuilder::band(double z0, double diameter0, double z1, double diameter1) {
  const std::int64_t sectors = tessellation_.sectors;
  std::int64_t first = -1;
  for (std::int64_t k = 0; k < sectors; ++k) {
    const double phi = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(sectors);
    const double c = std::cos(phi), s = std::sin(phi);
    const std::int64_t id = point({0.5 * diameter0 * c, 0.5 * diameter0 * s, z0}, {c, s, 0});
    point({0.5 * diameter1 * c, 0.5 * diameter1 * s, z1}, {c, s, 0});
    if (k == 0) first = id;
  }
  for (std::int64_t k = 0; k < sectors; ++k) {
    const std::int64_t a = first + 2 * k, b = first + 2 * ((k + 1) % sectors);
    polygon({a, a + 1, b + 1, b});
  }
}

CameraMesh lens_surfaces(const Camera& camera, const Tessellation& tessellation) {
  SurfaceBuilder builder(camera.to_world(), tessellation);
  if (camera.ideal_lens()) {
    const IdealLens& lens = camera.ideal();
    const double diameter = widest(camera);
    builder.tag(0, -1, {});
    builder.cap({}, lens.front_principal, kInfinity, diameter);
    if (lens.rear_principal != lens.front_principal)
      builder.cap({}, lens.rear_principal, kInfinity, diameter);
    return builder.take();
  }
  const auto& surfaces = camera.lens().surfaces();
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    // Between air and air there is only the diaphragm to see.
    const double before = s == 0 ? 1 : surfaces[s - 1].index;
    if (before == surfaces[s].index) continue;
    builder.tag(static_cast<int>(s), -1, {});
    builder.cap({}, camera.lens().vertices()[s], surfaces[s].radius, surfaces[s].diameter);
  }
  return builder.take();
}

CameraMesh lens_edges(const Camera& camera, const Tessellation& tessellation) {
  SurfaceBuilder builder(camera.to_world(), tessellation);
  if (camera.ideal_lens()) return builder.take();
  const auto& surfaces = camera.lens().surfaces();
  for (std::size_t s = 0; s + 1 < surfaces.size(); ++s) {
    if (surfaces[s].index == 1) continue;
    const auto edge = [&](std::size_t k) {
      return surface_height(camera.lens().vertices()[k], surfaces[k].radius,
                            0.5 * surfaces[k].diameter);
    };
    builder.tag(static_cast<int>(s), -1, {});
    builder.band(edge(s), surfaces[s].diameter, edge(s + 1), surfaces[s + 1].diameter);
  }
  return builder.take();
}

CameraMesh stop_ring(const Camera& camera, const Tessellation& tessellation) {
  SurfaceBuilder builder(camera.to_world(), tessellation);
  const auto& surfaces = camera.spec().lens.surfaces;
  double z = 0, inner = camera.spec().lens.diameter;
  int number = 0;
  double vertex = 0;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    if (surfaces[s].stop) {
      inner = surfaces[s].diameter;
      z = surface_height(vertex, surfaces[s].radius, 0.5 * inner);
      number = static_cast<int>(s);
    }
    vertex -= surfaces[s].thickness;
  }
  builder.tag(number, -1, {});
  builder.ring(z, inner, kDiaphragmWidth * std::max(inner, widest(camera)));
  return builder.take();
}

namespace {

/// Four corners with their texture coordinates.
CameraMesh rectangle(const std::array<Vec3, 4>& corners, const std::array<Vec2, 4>& texture) {
  CameraMesh mesh;
  mesh.points.assign(corners.begin(), corners.end());
  mesh.texture.assign(texture.begin(), texture.end());
  mesh.connectivity = {0, 1, 2, 3};
  mesh.offsets = {0, 4};
  return mesh;
}

/// From the array's plane to the lattice's own axes.
Vec2 unturned(const ArraySpec& array, Vec2 p) {
  const Vec2 d = p - array.offset;
  const double c = std::cos(array.rotation), s = std::sin(array.rotation);
  return {c * d.x + s * d.y, -s * d.x + c * d.y};
}

/// From the lattice's own axes to the array's plane.
Vec2 turned(const ArraySpec& array, Vec2 d) {
  const double c = std::cos(array.rotation), s = std::sin(array.rotation);
  return array.offset + Vec2{c * d.x - s * d.y, s * d.x + c * d.y};
}

/// First and last place of `count` lenses about number 0, with half a step beyond [steps].
std::array<double, 2> extent(int count) {
  return {-(count - 1) / 2 - 0.5, count / 2 + 0.5};
}

/// Corners of the plate, in the array's plane: of the sensor's size, or as large as the array is.
std::array<Vec2, 4> plate_corners(const Camera& camera) {
  const SensorSpec& sensor = camera.spec().sensor;
  const ArraySpec& array = camera.spec().array;
  if (array.columns == 0 || array.rows == 0)
    return {camera.sensor_point(0, 0), camera.sensor_point(sensor.columns, 0),
            camera.sensor_point(sensor.columns, sensor.rows), camera.sensor_point(0, sensor.rows)};
  const bool hexagonal = array.lattice == Lattice::hexagonal;
  const double step = hexagonal           ? std::sqrt(0.75) * array.pitch
                      : is_regular(array) ? array.pitch
                                          : array.pitch_y;
  auto [left, right] = extent(array.columns);
  const auto [low, high] = extent(array.rows);
  if (hexagonal) right += 0.5;  // every second row stands half a pitch farther right
  return {turned(array, {right * array.pitch, high * step}),
          turned(array, {left * array.pitch, high * step}),
          turned(array, {left * array.pitch, low * step}),
          turned(array, {right * array.pitch, low * step})};
}

}  // namespace

CameraMesh sensor_rectangle(const Camera& camera) {
  const SensorSpec& sensor = camera.spec().sensor;
  const std::array<Vec2, 4> texture{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  std::array<Vec3, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec2 at =
        camera.sensor_point(texture[k].x * sensor.columns, (1 - texture[k].y) * sensor.rows);
    corners[k] = camera.to_world().point({at.x, at.y, camera.sensor()});
  }
  return rectangle(corners, texture);
}

Vec2 array_period(const ArraySpec& array) {
  const int types = static_cast<int>(array.types.size());
  if (array.lattice == Lattice::square)
    return {array.pitch * types, (is_regular(array) ? array.pitch : array.pitch_y) * types};
  // Two rows up and one lens back is straight up; it changes the type by 3, none of 1 or 3 types.
  return {array.pitch * types, array.pitch * std::sqrt(3.0) * (types == 2 ? 2 : 1)};
}

std::vector<LensIndex> microlenses_over(const Camera& camera, PixelWindow window) {
  const SensorSpec& sensor = camera.spec().sensor;
  if (window.width == 0) window = {0, 0, sensor.columns, sensor.rows};
  // Columns and rows run against the camera's axes.
  const Vec2 upper = camera.sensor_point(window.x, window.y);
  const Vec2 lower = camera.sensor_point(window.x + window.width, window.y + window.height);
  const double pitch = longest_pitch(camera.spec().array);
  return camera.lattice().within(lower - Vec2{pitch, pitch}, upper + Vec2{pitch, pitch});
}

CameraMesh microlens_surfaces(const Camera& camera, const std::vector<LensIndex>& lenses,
                              const Tessellation& tessellation) {
  SurfaceBuilder builder(camera.to_world(), tessellation);
  const MicrolensAperture& aperture = camera.aperture();
  const int front = camera.surface_count() - (camera.ideal_array() ? 1 : 2);
  for (const LensIndex lens : lenses) {
    const Vec2 centre = camera.lattice().centre(lens);
    const int type = camera.lattice().type(lens);
    const Microlens& kind = camera.microlenses()[static_cast<std::size_t>(type)];
    builder.tag(front, type, lens);
    if (camera.ideal_array()) {
      builder.cap(centre, kind.rear_principal, kInfinity, aperture);
      continue;
    }
    builder.cap(centre, camera.array_front(), kind.radius_front, aperture);
    builder.tag(front + 1, type, lens);
    // Convex towards the sensor: the centre is on the scene's side.
    builder.cap(centre, camera.array_back(), -kind.radius_back, aperture);
  }
  return builder.take();
}

CameraMesh array_plate(const Camera& camera) {
  const ArraySpec& array = camera.spec().array;
  const Vec2 repeat = array_period(array);
  const std::array<Vec2, 4> places = plate_corners(camera);
  std::array<Vec3, 4> corners;
  std::array<Vec2, 4> texture;
  for (std::size_t k = 0; k < 4; ++k) {
    corners[k] = camera.to_world().point({places[k].x, places[k].y, camera.array_front()});
    const Vec2 own = unturned(array, places[k]);
    texture[k] = {own.x / repeat.x, own.y / repeat.y};
  }
  return rectangle(corners, texture);
}

CameraMeshes camera_meshes(const Scene& scene, const CameraMeshRequest& request) {
  validate(SceneDocument{scene, {}});
  const Camera camera(scene.camera);
  const Tessellation lens{request.lens_sectors, std::max(2, request.lens_sectors / 6)};
  const Tessellation microlens{request.microlens_sectors,
                               std::max(1, request.microlens_sectors / 4)};
  CameraMeshes meshes;
  if (camera.has_array()) {
    const bool in_window = request.detail == ArrayDetail::window;
    if (in_window && (request.window.width < 1 || request.window.height < 1))
      throw UsageError("the window for microlenses is empty: set Window");
    const auto lenses = microlenses_over(camera, in_window ? request.window : PixelWindow{});
    const bool few = lenses.size() <= request.most_microlenses;
    const bool single = request.detail == ArrayDetail::all || in_window ||
                        (request.detail == ArrayDetail::automatic && few);
    if (single) meshes.microlenses = microlens_surfaces(camera, lenses, microlens);
    if (!single || in_window) meshes.plate = array_plate(camera);
  }
  meshes.lens_surfaces = lens_surfaces(camera, lens);
  meshes.lens_edges = lens_edges(camera, lens);
  meshes.stop = stop_ring(camera, lens);
  meshes.sensor = sensor_rectangle(camera);
  return meshes;
}

}  // namespace plenoflame
