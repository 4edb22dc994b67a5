#include <algorithm>
#include <cmath>
#include <numbers>

#include "inverse/operators/sample_bricks.h"
#include "plenoflame/base/error.h"
#include "plenoflame/inverse/unknowns.h"

namespace plenoflame {
namespace {

/// Parts of a stretch between two faces: along it the reduced radius is no linear function of the
/// way.
constexpr int kParts = 2;

class LayerUnknowns : public Unknowns {
 public:
  explicit LayerUnknowns(const LayerGrid& grid) : grid_(grid) {
    if (grid.layers < 1) throw InputError("layers need at least one");
    if (!(grid.semi_axes.x > 0) || !(grid.semi_axes.y > 0) || !(grid.semi_axes.z > 0))
      throw InputError("the semi-axes of layers must be above 0");
  }

  std::size_t size() const override { return static_cast<std::size_t>(grid_.layers); }
  std::array<int, 3> shape() const override { return {grid_.layers, 1, 1}; }
  std::array<double, 3> spacing() const override {
    // Along the first semi-axis: ratios to other axes do not matter, there are none.
    const double step = grid_.semi_axes.x / grid_.layers;
    return {step, step, step};
  }
  bool begins_at_centre() const override { return true; }
  Box bounds() const override {
    return {grid_.centre - grid_.semi_axes, grid_.centre + grid_.semi_axes};
  }
  Vec3 place(std::size_t unknown) const override {
    const double share = static_cast<double>(unknown) / grid_.layers;
    return grid_.centre + Vec3{share * grid_.semi_axes.x, 0, 0};
  }
  double volume(std::size_t unknown) const override {
    // Integral of a hat of the reduced radius over 4 pi a b c s^2 ds, in steps of 1 / layers.
    const auto i = static_cast<double>(unknown);
    const double step = 1.0 / grid_.layers;
    const double hat = unknown > 0 ? i * i + 1.0 / 6 : 1.0 / 12;
    return 4 * std::numbers::pi * grid_.semi_axes.x * grid_.semi_axes.y * grid_.semi_axes.z * hat *
           step * step * step;
  }
  std::unique_ptr<Unknowns> refined() const override {
    return make_layer_unknowns(
        {grid_.centre, grid_.semi_axes, grid_.layers * (grid_.layers > 1 ? 2 : 1)});
  }
  void append(const Ray& ray, double t_near, double t_far, RayIntervals& out) const override;
  VoxelField field(std::span<const double> values, const std::string& name) const override {
    // The voxel size is the width of a layer along the shortest semi-axis.
    const Vec3 a = grid_.semi_axes;
    const double step = std::min({a.x, a.y, a.z}) / grid_.layers;
    const auto half = [&](double reach) { return static_cast<int>(std::ceil(reach / step)); };
    const std::array<int, 3> reach{half(a.x), half(a.y), half(a.z)};
    AffineTransform map;
    map.linear = {{{{step, 0, 0}, {0, step, 0}, {0, 0, step}}}};
    map.translation =
        grid_.centre - step * Vec3{static_cast<double>(reach[0]), static_cast<double>(reach[1]),
                                   static_cast<double>(reach[2])};
    return sample_bricks({2 * reach[0] + 1, 2 * reach[1] + 1, 2 * reach[2] + 1}, map, name,
                         [&](int i, int j, int k) {
                           const double x = step * (i - reach[0]) / a.x,
                                        y = step * (j - reach[1]) / a.y,
                                        z = step * (k - reach[2]) / a.z;
                           const double reduced = std::sqrt(x * x + y * y + z * z);
                           RayInterval place{};
                           set_nodes({reduced, reduced}, place);
                           return value_at(place, 0, values);
                         });
  }

 private:
  /// Sets the samples and their weights at two reduced radii of one layer; 1 is the outermost.
  void set_nodes(const std::array<double, 2>& reduced, RayInterval& out) const {
    const double middle = 0.5 * (reduced[0] + reduced[1]) * grid_.layers;
    const int i = static_cast<int>(std::min(middle, 1e9));
    out.count = 2;
    for (int up = 0; up < 2 && i + up < grid_.layers; ++up) {
      out.sample[up] = static_cast<std::uint32_t>(i + up);
      for (std::size_t n = 0; n < 2; ++n) {
        const double share = std::clamp(reduced[n] * grid_.layers - i, 0.0, 1.0);
        out.weight[n][up] = up != 0 ? share : 1 - share;
      }
    }
  }

  LayerGrid grid_;
};

void LayerUnknowns::append(const Ray& ray, double t_near, double t_far, RayIntervals& out) const {
  const Vec3 a = grid_.semi_axes, from = ray.origin - grid_.centre;
  const Vec3 o{from.x / a.x, from.y / a.y, from.z / a.z};
  const Vec3 d{ray.direction.x / a.x, ray.direction.y / a.y, ray.direction.z / a.z};
  // Reduced radius squared along the ray: nearest^2 + speed (t - closest)^2.
  const double speed = dot(d, d), closest = -dot(o, d) / speed;
  const Vec3 away = cross(o, d);
  const double nearest = dot(away, away) / speed;
  if (!(nearest < 1)) return;
  const auto half_chord = [&](double reduced) {
    return std::sqrt(std::max(reduced * reduced - nearest, 0.0) / speed);
  };
  const double begin = std::max(t_near, closest - half_chord(1));
  const double end = std::min(t_far, closest + half_chord(1));
  if (!(end > begin)) return;
  std::vector<double> faces{begin, end};
  const auto add = [&](double t) {
    if (t > begin && t < end) faces.push_back(t);
  };
  add(closest);
  for (int i = 1; i < grid_.layers; ++i) {
    const double reduced = static_cast<double>(i) / grid_.layers;
    if (!(reduced * reduced > nearest)) continue;
    add(closest - half_chord(reduced));
    add(closest + half_chord(reduced));
  }
  std::sort(faces.begin(), faces.end());
  for (std::size_t f = 0; f + 1 < faces.size(); ++f) {
    const double stretch = (faces[f + 1] - faces[f]) / kParts;
    if (!(stretch > 0)) continue;
    for (int part = 0; part < kParts; ++part) {
      std::array<double, 2> reduced{};
      for (std::size_t n = 0; n < 2; ++n)
        reduced[n] = std::min(1.0, length(o + (faces[f] + (part + kGaussNodes[n]) * stretch) * d));
      set_nodes(reduced, out.add_empty(stretch));
    }
  }
}

}  // namespace

std::unique_ptr<Unknowns> make_layer_unknowns(const LayerGrid& grid) {
  return std::make_unique<LayerUnknowns>(grid);
}

}  // namespace plenoflame
