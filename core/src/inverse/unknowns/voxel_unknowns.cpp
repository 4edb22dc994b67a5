#include <algorithm>
#include <cmath>

#include "inverse/operators/sample_bricks.h"
#include "plenoflame/inverse/unknowns.h"

namespace plenoflame {
namespace {

class VoxelUnknowns : public Unknowns {
 public:
  explicit VoxelUnknowns(const RegularLattice& lattice) : walk_(lattice) {
    const Mat3 columns = transpose(lattice.index_to_world.linear);
    for (std::size_t a = 0; a < 3; ++a) spacing_[a] = length(columns.rows[a]);
    volume_ = std::fabs(dot(columns.rows[0], cross(columns.rows[1], columns.rows[2])));
  }

  std::size_t size() const override { return lattice().size(); }
  std::array<int, 3> shape() const override { return lattice().count; }
  std::array<double, 3> spacing() const override { return spacing_; }
  bool is_linear() const override {
    return lattice().interpolation != VoxelInterpolation::constant;
  }
  Box bounds() const override {
    const double reach = is_linear() ? 1 : 0.5;
    Box box;
    for (int corner = 0; corner < 8; ++corner) {
      std::array<double, 3> at{};
      for (std::size_t a = 0; a < 3; ++a)
        at[a] = (corner >> a & 1) != 0 ? lattice().count[a] - 1 + reach : -reach;
      const Vec3 p = lattice().index_to_world.point({at[0], at[1], at[2]});
      if (corner == 0) box = {p, p};
      box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y),
                   std::min(box.lower.z, p.z)};
      box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y),
                   std::max(box.upper.z, p.z)};
    }
    return box;
  }
  Vec3 place(std::size_t unknown) const override { return lattice().place(unknown); }
  double volume(std::size_t) const override { return volume_; }
  std::unique_ptr<Unknowns> refined() const override {
    RegularLattice finer = lattice();
    AffineTransform& map = finer.index_to_world;
    Mat3 steps = transpose(map.linear);
    for (std::size_t a = 0; a < 3; ++a) {
      if (finer.count[a] < 2) continue;
      finer.count[a] = 2 * finer.count[a] + 1;
      steps.rows[a] = 0.5 * steps.rows[a];
      map.translation = map.translation - steps.rows[a];
    }
    map.linear = transpose(steps);
    return make_voxel_unknowns(finer);
  }
  void append(const Ray& ray, double t_near, double t_far, RayIntervals& out) const override {
    walk_.append(ray, t_near, t_far, out);
  }
  VoxelField field(std::span<const double> values, const std::string& name) const override {
    const std::array<int, 3> count = lattice().count;
    return sample_bricks(count, lattice().index_to_world, name, [&](int i, int j, int k) {
      return values[static_cast<std::size_t>((i * count[1] + j) * count[2] + k)];
    });
  }

 private:
  const RegularLattice& lattice() const { return walk_.lattice(); }

  LatticeWalk walk_;
  std::array<double, 3> spacing_{};
  double volume_ = 0;
};

}  // namespace

std::unique_ptr<Unknowns> make_voxel_unknowns(const RegularLattice& lattice) {
  return std::make_unique<VoxelUnknowns>(lattice);
}

}  // namespace plenoflame
