#include <algorithm>
#include <cmath>
#include <numbers>

#include "inverse/operators/sample_bricks.h"
#include "plenoflame/base/error.h"
#include "plenoflame/inverse/unknowns.h"

namespace plenoflame {
namespace {

/// Between two faces the radius is no linear function of the distance, least of all near the
/// closest point. Intervals within kCurved steps of its radius are cut into kRingParts parts.
constexpr int kRingParts = 2, kCurved = 3;

/// Crossings of a ray with faces of heights and rings, each kind in its order along the ray.
struct RingFaces {
  const RingGrid& grid;
  double begin, end;
  double closest, nearest, across;  ///< radius^2 is nearest + across (t - closest)^2
  double z, dz;                     ///< height is z + t dz
  int height = 0, ring = 0;         ///< face that came last
  bool inwards = true;

  /// @return the end where there is none any more
  double next_height() {
    if (dz == 0) return end;
    const int step = dz > 0 ? 1 : -1;
    for (height += step; height >= 0 && height < grid.heights; height += step) {
      const double t = (height * grid.height_step - z) / dz;
      if (t > begin) return t;
    }
    return end;
  }
  /// Inwards, the closest place, then outwards.
  double next_ring() {
    if (!(across > 0)) return end;
    while (true) {
      ring += inwards ? -1 : 1;
      if (ring >= grid.rings) return end;
      const double radius = ring * grid.radial_step, half = radius * radius - nearest;
      if (inwards && (ring == 0 || !(half > 0))) {
        inwards = false;
        if (closest > begin && closest < end) return closest;
        continue;
      }
      if (!(half > 0)) continue;
      const double t = closest + (inwards ? -1 : 1) * std::sqrt(half / across);
      if (t > begin) return t;
    }
  }
};

class RingUnknowns : public Unknowns {
 public:
  explicit RingUnknowns(const RingGrid& grid) : grid_(grid) {
    if (grid.rings < 1 || grid.heights < 1)
      throw InputError("rings need at least one radius and one height");
    if (!(grid.radial_step > 0) || !(grid.height_step > 0))
      throw InputError("the steps of rings in radius and height must be above 0");
    if (!(length(grid.axis) > 0)) throw InputError("the axis of the rings has no direction");
    w_ = normalize(grid.axis);
    const Vec3 aside = std::fabs(w_.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    u_ = normalize(aside - dot(aside, w_) * w_);
    v_ = cross(w_, u_);
  }

  std::size_t size() const override {
    return static_cast<std::size_t>(grid_.rings) * static_cast<std::size_t>(grid_.heights);
  }
  std::array<int, 3> shape() const override { return {grid_.rings, grid_.heights, 1}; }
  std::array<double, 3> spacing() const override {
    return {grid_.radial_step, grid_.height_step, grid_.radial_step};
  }
  bool begins_at_centre() const override { return true; }
  Box bounds() const override {
    const double radius = grid_.rings * grid_.radial_step;
    const double low = -grid_.height_step, high = grid_.heights * grid_.height_step;
    const Vec3 a = grid_.base + low * w_, b = grid_.base + high * w_;
    // A disc reaches radius * sqrt(1 - w^2) to either side along an axis.
    const auto reach = [&](double w) { return radius * std::sqrt(std::max(1 - w * w, 0.0)); };
    const Vec3 r{reach(w_.x), reach(w_.y), reach(w_.z)};
    return {{std::min(a.x, b.x) - r.x, std::min(a.y, b.y) - r.y, std::min(a.z, b.z) - r.z},
            {std::max(a.x, b.x) + r.x, std::max(a.y, b.y) + r.y, std::max(a.z, b.z) + r.z}};
  }
  Vec3 place(std::size_t unknown) const override {
    const auto heights = static_cast<std::size_t>(grid_.heights);
    return grid_.base + (static_cast<double>(unknown / heights) * grid_.radial_step) * u_ +
           (static_cast<double>(unknown % heights) * grid_.height_step) * w_;
  }
  double volume(std::size_t unknown) const override {
    // Integral of a hat function of the radius: 2 pi r dr, on the axis pi dr^2 / 3.
    const auto i = static_cast<double>(unknown / static_cast<std::size_t>(grid_.heights));
    const double area =
        std::numbers::pi * grid_.radial_step * grid_.radial_step * (i > 0 ? 2 * i : 1.0 / 3);
    return area * grid_.height_step;
  }
  std::unique_ptr<Unknowns> refined() const override {
    RingGrid finer = grid_;
    if (grid_.rings > 1) finer.radial_step /= 2, finer.rings *= 2;
    if (grid_.heights > 1) {
      finer.height_step /= 2;
      finer.heights = 2 * grid_.heights + 1;
      finer.base = grid_.base - finer.height_step * w_;
    }
    return make_ring_unknowns(finer);
  }
  void append(const Ray& ray, double t_near, double t_far, RayIntervals& out) const override;
  VoxelField field(std::span<const double> values, const std::string& name) const override;

 private:
  /// Sets up to four samples and their weights at two places of one cell.
  /// @param radius, height of the places, in steps
  void set_nodes(const std::array<double, 2>& radius, const std::array<double, 2>& height,
                 RayInterval& out) const;

  RingGrid grid_;
  Vec3 u_, v_, w_;
};

void RingUnknowns::set_nodes(const std::array<double, 2>& radius,
                             const std::array<double, 2>& height, RayInterval& out) const {
  const int i = static_cast<int>(0.5 * (radius[0] + radius[1]));
  const int j = static_cast<int>(std::floor(0.5 * (height[0] + height[1])));
  out.count = 4;
  for (int c = 0; c < out.count; ++c) {
    const int ring = i + (c & 1), level = j + (c >> 1);
    if (ring >= grid_.rings || level < 0 || level >= grid_.heights) continue;
    out.sample[c] = static_cast<std::uint32_t>(ring * grid_.heights + level);
    for (std::size_t n = 0; n < 2; ++n) {
      const double p = std::clamp(radius[n] - i, 0.0, 1.0);
      const double q = std::clamp(height[n] - j, 0.0, 1.0);
      out.weight[n][c] = ((c & 1) != 0 ? p : 1 - p) * (c >> 1 != 0 ? q : 1 - q);
    }
  }
}

void RingUnknowns::append(const Ray& ray, double t_near, double t_far, RayIntervals& out) const {
  const Vec3 from = ray.origin - grid_.base;
  const double x = dot(from, u_), y = dot(from, v_), z = dot(from, w_);
  const double dx = dot(ray.direction, u_), dy = dot(ray.direction, v_),
               dz = dot(ray.direction, w_);
  const double across = dx * dx + dy * dy;
  const double outer = grid_.rings * grid_.radial_step;
  double begin = t_near, end = t_far;
  // Radius squared along the ray: nearest^2 + across (t - closest)^2.
  double closest = 0, nearest = x * x + y * y;
  if (across > 0) {
    closest = -(x * dx + y * dy) / across;
    const double cross_product = x * dy - y * dx;
    nearest = cross_product * cross_product / across;
    const double half = outer * outer - nearest;
    if (!(half > 0)) return;
    begin = std::max(begin, closest - std::sqrt(half / across));
    end = std::min(end, closest + std::sqrt(half / across));
  } else if (!(nearest < outer * outer)) {
    return;
  }
  const double low = -grid_.height_step, high = grid_.heights * grid_.height_step;
  if (dz != 0) {
    const double t0 = (low - z) / dz, t1 = (high - z) / dz;
    begin = std::max(begin, std::min(t0, t1));
    end = std::min(end, std::max(t0, t1));
  } else if (z < low || z > high) {
    return;
  }
  if (!(end > begin) || !std::isfinite(end - begin)) return;

  RingFaces faces{grid_, begin, end, closest, nearest, across, z, dz};
  faces.height = dz > 0 ? -1 : grid_.heights;
  faces.ring = grid_.rings;
  const double to_rings = 1 / grid_.radial_step, to_heights = 1 / grid_.height_step;
  const double inner = std::sqrt(nearest) + kCurved * grid_.radial_step;
  double at = begin, at_height = faces.next_height(), at_ring = faces.next_ring();
  while (at < end) {
    const double to = std::min({end, at_height, at_ring});
    const double middle = 0.5 * (at + to) - closest;
    const int parts = nearest + across * middle * middle < inner * inner ? kRingParts : 1;
    const double stretch = (to - at) / parts;
    for (int part = 0; part < parts && stretch > 0; ++part) {
      std::array<double, 2> radius{}, height{};
      for (std::size_t n = 0; n < 2; ++n) {
        const double t = at + (part + kGaussNodes[n]) * stretch, way = t - closest;
        radius[n] = std::sqrt(nearest + across * way * way) * to_rings;
        height[n] = (z + t * dz) * to_heights;
      }
      set_nodes(radius, height, out.add_empty(stretch));
    }
    if (!(at_height > to)) at_height = faces.next_height();
    if (!(at_ring > to)) at_ring = faces.next_ring();
    at = to;
  }
}

VoxelField RingUnknowns::field(std::span<const double> values, const std::string& name) const {
  // Voxels as wide as rings, the axis through samples.
  const int half = grid_.rings - 1;
  AffineTransform map;
  const double step = grid_.radial_step, rise = grid_.height_step;
  map.linear = transpose({{{step * u_, step * v_, rise * w_}}});
  map.translation = grid_.base - (half * step) * (u_ + v_);
  return sample_bricks({2 * half + 1, 2 * half + 1, grid_.heights}, map, name,
                       [&](int i, int j, int k) {
                         const double radius = std::hypot(i - half, j - half), height = k;
                         RayInterval place{};
                         set_nodes({radius, radius}, {height, height}, place);
                         return value_at(place, 0, values);
                       });
}

}  // namespace

std::unique_ptr<Unknowns> make_ring_unknowns(const RingGrid& grid) {
  return std::make_unique<RingUnknowns>(grid);
}

}  // namespace plenoflame
