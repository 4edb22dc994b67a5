#include "render/transport/medium_behind_windows.h"

#include <algorithm>
#include <cmath>

#include "base/isa_dispatch.h"
#include "math/box_corners.h"
#include "plenoflame/math/ray_span.h"

namespace plenoflame {
namespace {

template <class Real>
struct WallKernels {
  void (*pass_wall)(const KernelWall<Real>&, int, const KernelWays<Real>&);
  void (*move_to_anchor)(int, const KernelWays<Real>&);
};

template <class Real>
WallKernels<Real> kernels_for(Isa isa) {
  PLENOFLAME_DISPATCH(isa, return {kernels::pass_wall, kernels::move_to_anchor};)
}

Box around(const std::vector<Box>& boxes) {
  Box whole{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (const Box& box : boxes) {
    if (box.empty()) continue;
    whole.lower = {std::min(whole.lower.x, box.lower.x), std::min(whole.lower.y, box.lower.y),
                   std::min(whole.lower.z, box.lower.z)};
    whole.upper = {std::max(whole.upper.x, box.upper.x), std::max(whole.upper.y, box.upper.y),
                   std::max(whole.upper.z, box.upper.z)};
  }
  return whole;
}

RigidTransform place_of(const WindowSpec& window) {
  return {rotation_xyz(window.rotation), window.position};
}

/// Tells whether a box is in the air inside of a tube.
bool holds(const WindowSpec& window, const Box& box) {
  if (window.shape != WindowShape::tube) return false;
  const RigidTransform to_own = place_of(window).inverse();
  const double inner = window.radius - window.thickness;
  for (const Vec3 corner : corners(box)) {
    const Vec3 p = to_own.point(corner);
    if (!(std::hypot(p.x, p.y) < inner && p.z > 0 && p.z < window.height)) return false;
  }
  return true;
}

/// The extent of a window along the camera's axis [m].
struct Extent {
  double near = kInfinity, far = -kInfinity;
  void add(double z) {
    near = std::min(near, z);
    far = std::max(far, z);
  }
};

bool is_flat(const WindowSpec& window) {
  return window.shape == WindowShape::plate || window.shape == WindowShape::wedge;
}

template <class Real>
KernelWall<Real> kernel_wall(const WindowSpec& window, Vec3 anchor, Vec3 axis) {
  KernelWall<Real> wall{};
  const RigidTransform to_own = place_of(window).inverse();
  for (std::size_t row = 0; row < 3; ++row) {
    const Vec3 r = to_own.rotation.rows[row];
    wall.turn[3 * row] = static_cast<Real>(r.x);
    wall.turn[3 * row + 1] = static_cast<Real>(r.y);
    wall.turn[3 * row + 2] = static_cast<Real>(r.z);
  }
  const Vec3 at = to_own.point(anchor);
  wall.at[0] = static_cast<Real>(at.x);
  wall.at[1] = static_cast<Real>(at.y);
  wall.at[2] = static_cast<Real>(at.z);
  wall.index = static_cast<Real>(window.index);
  wall.absorption = static_cast<Real>(window.absorption);
  wall.reflects = window.fresnel;
  const Real everything = Real(1e18);
  wall.half_x = wall.half_y = wall.radius2 = everything;
  wall.is_round = !is_flat(window);
  if (wall.is_round) {
    wall.radius[0] = static_cast<Real>(window.radius);
    wall.radius[1] = static_cast<Real>(window.radius - window.thickness);
    wall.low = 0;
    wall.high = static_cast<Real>(window.height);
    return wall;
  }
  const double angle = window.shape == WindowShape::wedge ? window.angle : 0;
  const Vec3 normals[2] = {{0, 0, -1}, {0, -std::sin(angle), std::cos(angle)}};
  const double offsets[2] = {0, std::cos(angle) * window.thickness};
  const bool ahead = to_own.direction(axis).z > 0;
  for (std::size_t face = 0; face < 2; ++face) {
    const std::size_t from = ahead ? face : 1 - face;
    wall.normal[face][0] = static_cast<Real>(normals[from].x);
    wall.normal[face][1] = static_cast<Real>(normals[from].y);
    wall.normal[face][2] = static_cast<Real>(normals[from].z);
    wall.offset[face] = static_cast<Real>(offsets[from]);
  }
  if (window.diameter > 0) {
    wall.radius2 = static_cast<Real>(0.25 * window.diameter * window.diameter);
  } else {
    wall.half_x = static_cast<Real>(0.5 * window.extent.x);
    wall.half_y = static_cast<Real>(0.5 * window.extent.y);
  }
  return wall;
}

}  // namespace

std::unique_ptr<const MediumBehindWindows> MediumBehindWindows::make(const CompiledScene& scene) {
  if (!scene.windows || !scene.medium || scene.surfaces || !scene.scatterers.empty() ||
      !scene.lights.environment.empty())
    return nullptr;
  const Box lit = around(scene.medium->occupied());
  if (lit.empty()) return nullptr;
  const Vec3 axis = scene.camera.to_world().direction({0, 0, 1});
  const Vec3 vertex = scene.camera.to_world().translation;
  const auto along = [&](Vec3 p) { return dot(axis, p - vertex); };
  Extent flame;
  for (const Vec3 corner : corners(lit)) flame.add(along(corner));
  struct Wall {
    Extent extent;
    WindowSpec window;
  };
  std::vector<Wall> walls;
  int tubes = 0;
  for (std::size_t w = 0; w < scene.scene.windows.size(); ++w) {
    const WindowSpec& window = scene.scene.windows[w];
    Extent extent;
    for (const Vec3 p : scene.windows->points_of(static_cast<int>(w))) extent.add(along(p));
    if (holds(window, lit)) {
      tubes += 1;
    } else if (extent.near > flame.far) {
      continue;  // behind the medium
    } else if (!(extent.far < flame.near) || !is_flat(window)) {
      return nullptr;
    }
    walls.push_back({extent, window});
  }
  if (tubes > 1) return nullptr;
  std::sort(walls.begin(), walls.end(),
            [](const Wall& a, const Wall& b) { return a.extent.near < b.extent.near; });
  std::vector<WindowSpec> in_order;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    const bool is_last = i + 1 == walls.size();
    if (is_flat(walls[i].window) == false && !is_last) return nullptr;
    if (!is_last && !(walls[i].extent.far < walls[i + 1].extent.near)) return nullptr;
    in_order.push_back(walls[i].window);
  }
  // A wall in front of the camera's front would be met by rays that travel backwards.
  if (!walls.empty() && !(walls.front().extent.near > 0)) return nullptr;
  return std::unique_ptr<const MediumBehindWindows>(
      new MediumBehindWindows(scene, lit, std::move(in_order)));
}

MediumBehindWindows::MediumBehindWindows(const CompiledScene& scene, const Box& lit,
                                         std::vector<WindowSpec> walls)
    : medium_(*scene.medium),
      windows_(*scene.windows),
      front_(scene.camera),
      axis_(scene.camera.to_world().direction({0, 0, 1})),
      lit_(lit),
      walls_(std::move(walls)) {}

template <class Real>
void MediumBehindWindows::run(const RayBatch<Real>& rays, const MediumOptions& options,
                              RadianceBatch<Real> out, MediumCounters& counters) const {
  const auto count = static_cast<std::size_t>(rays.size);
  constexpr std::size_t kArrays = 7, kAlignment = 64 / sizeof(Real);
  // Each ray is written before it is read, so the memory needs no clearing.
  const std::unique_ptr<Real[]> storage(new Real[kArrays * count + kAlignment]);
  const std::unique_ptr<int[]> odd(new int[count]);
  void* aligned = storage.get();
  std::size_t space = (kArrays * count + kAlignment) * sizeof(Real);
  Real* const base =
      static_cast<Real*>(std::align(64, kArrays * count * sizeof(Real), aligned, space));
  const auto array = [&](std::size_t k) { return base + k * count; };
  const KernelWays<Real> ways{array(0), array(1), array(2), array(3),
                              array(4), array(5), array(6), odd.get()};
  std::copy_n(rays.x, count, ways.x);
  std::copy_n(rays.y, count, ways.y);
  std::copy_n(rays.z, count, ways.z);
  std::copy_n(rays.dx, count, ways.dx);
  std::copy_n(rays.dy, count, ways.dy);
  std::copy_n(rays.dz, count, ways.dz);
  std::fill_n(ways.through, count, Real(1));
  std::fill_n(ways.odd, count, 0);
  const WallKernels<Real> kernels = kernels_for<Real>(options.isa);
  for (const WindowSpec& window : walls_)
    kernels.pass_wall(kernel_wall<Real>(window, rays.anchor, axis_), rays.size, ways);
  bend_one_by_one(rays, ways);
  kernels.move_to_anchor(rays.size, ways);
  RayBatch<Real> bent = rays;
  bent.x = ways.x, bent.y = ways.y, bent.z = ways.z;
  bent.dx = ways.dx, bent.dy = ways.dy, bent.dz = ways.dz;
  medium_.integrate(bent, options, out, counters);
  for (int c = 0; c < medium_.channel_count(); ++c) {
    Real* const radiance = out.radiance + static_cast<std::ptrdiff_t>(c) * out.stride;
    for (std::size_t i = 0; i < count; ++i) radiance[i] *= ways.through[i];
  }
}

/// Rays on other paths: their line is the stretch that meets the medium.
template <class Real>
void MediumBehindWindows::bend_one_by_one(const RayBatch<Real>& from,
                                          const KernelWays<Real>& ways) const {
  WindowPath path;
  for (int i = 0; i < from.size; ++i) {
    if (ways.odd[i] == 0) continue;
    const Ray line{
        from.anchor + Vec3{static_cast<double>(from.x[i]), static_cast<double>(from.y[i]),
                           static_cast<double>(from.z[i])},
        normalize({static_cast<double>(from.dx[i]), static_cast<double>(from.dy[i]),
                   static_cast<double>(from.dz[i])})};
    Ray bent = line;
    double through = 0;
    if (std::isfinite(dot(line.origin, line.direction))) {
      windows_.trace({line.at(front_.t_near(line)), line.direction}, path);
      for (const AirSegment& stretch : path.segments) {
        if (clip_to_box(lit_, stretch.ray, 0, stretch.far).empty()) continue;
        bent = stretch.ray;
        through = stretch.throughput;
        break;
      }
    }
    const Vec3 o = bent.origin - from.anchor;
    ways.x[i] = static_cast<Real>(o.x);
    ways.y[i] = static_cast<Real>(o.y);
    ways.z[i] = static_cast<Real>(o.z);
    ways.dx[i] = static_cast<Real>(bent.direction.x);
    ways.dy[i] = static_cast<Real>(bent.direction.y);
    ways.dz[i] = static_cast<Real>(bent.direction.z);
    ways.through[i] = static_cast<Real>(through);
  }
}

template void MediumBehindWindows::run<float>(const RayBatch<float>&, const MediumOptions&,
                                              RadianceBatch<float>, MediumCounters&) const;
template void MediumBehindWindows::run<double>(const RayBatch<double>&, const MediumOptions&,
                                               RadianceBatch<double>, MediumCounters&) const;

}  // namespace plenoflame
