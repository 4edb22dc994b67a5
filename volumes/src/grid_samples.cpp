#include "plenoflame/volumes/grid_samples.h"

#include <cmath>
#include <map>

#include "plenoflame/base/error.h"
#include "plenoflame/volumes/grid_file.h"

namespace plenoflame {
namespace {

constexpr int kEdge = 8;  // of a brick

class FieldSampler {
 public:
  explicit FieldSampler(const VoxelField& field) : field_(field) {
    for (std::size_t b = 0; b < field.brick_origins.size(); ++b)
      bricks_[field.brick_origins[b]] = b;
    const auto& r = field.index_to_world.linear.rows;
    const Vec3 a = cross(r[1], r[2]), b = cross(r[2], r[0]), c = cross(r[0], r[1]);
    const double determinant = dot(r[0], a);
    if (determinant == 0 || !std::isfinite(determinant))
      throw InputError("the transform of grid '" + field.name + "' has no inverse");
    const double f = 1 / determinant;
    to_index_ = transpose({{{f * a, f * b, f * c}}});
  }

  double at(Vec3 place) const {
    const Vec3 p = to_index_ * (place - field_.index_to_world.translation);
    const std::array<double, 3> index{p.x, p.y, p.z};
    std::array<int, 3> low{};
    std::array<double, 3> part{};
    for (std::size_t a = 0; a < 3; ++a) {
      if (!(std::fabs(index[a]) < 1e9)) return static_cast<double>(field_.background);
      // A place of a sample, but for rounding, is that sample.
      const double nearest = std::round(index[a]);
      const double exact = std::fabs(index[a] - nearest) < 1e-6 ? nearest : index[a];
      low[a] = static_cast<int>(std::floor(exact));
      part[a] = exact - low[a];
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1;
      std::array<int, 3> sample{};
      for (std::size_t a = 0; a < 3; ++a) {
        const int up = corner >> a & 1;
        sample[a] = low[a] + up;
        weight *= up ? part[a] : 1 - part[a];
      }
      if (weight > 0) sum += weight * value(sample);
    }
    return sum;
  }

 private:
  double value(const std::array<int, 3>& sample) const {
    std::array<int, 3> origin{};
    for (std::size_t a = 0; a < 3; ++a)
      origin[a] = sample[a] - ((sample[a] % kEdge) + kEdge) % kEdge;
    const auto found = bricks_.find(origin);
    if (found == bricks_.end()) return static_cast<double>(field_.background);
    const int offset =
        ((sample[0] - origin[0]) * kEdge + sample[1] - origin[1]) * kEdge + sample[2] - origin[2];
    return static_cast<double>(
        field_.values[found->second * kEdge * kEdge * kEdge + static_cast<std::size_t>(offset)]);
  }

  const VoxelField& field_;
  std::map<std::array<int, 3>, std::size_t> bricks_;
  Mat3 to_index_;
};

}  // namespace

std::vector<double> sample_field(const VoxelField& field, std::span<const Vec3> places) {
  const FieldSampler sampler(field);
  std::vector<double> values;
  values.reserve(places.size());
  for (const Vec3& place : places) values.push_back(sampler.at(place));
  return values;
}

std::vector<double> sample_grid(const std::string& path, const std::string& name,
                                std::span<const Vec3> places) {
  return sample_field(read_voxel_field(path, name), places);
}

}  // namespace plenoflame
