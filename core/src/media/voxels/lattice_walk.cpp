#include "plenoflame/media/lattice_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "media/voxels/voxel_kernel_weights.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

Mat3 inverse_of(const Mat3& m) {
  const auto& r = m.rows;
  const Vec3 a = cross(r[1], r[2]), b = cross(r[2], r[0]), c = cross(r[0], r[1]);
  const double determinant = dot(r[0], a);
  const double scale = length(r[0]) * length(r[1]) * length(r[2]);
  if (!(std::fabs(determinant) > 1e-12 * scale))
    throw InputError("the lattice's transform has no inverse: its axes lie in a plane");
  const double f = 1 / determinant;
  return transpose({{{f * a, f * b, f * c}}});
}

}  // namespace

RegularLattice regular_lattice(Vec3 centre, Vec3 size, const std::array<int, 3>& count) {
  const Vec3 step{size.x / count[0], size.y / count[1], size.z / count[2]};
  RegularLattice lattice;
  lattice.count = count;
  lattice.index_to_world.linear = {{{{step.x, 0, 0}, {0, step.y, 0}, {0, 0, step.z}}}};
  lattice.index_to_world.translation = centre - 0.5 * (size - step);
  return lattice;
}

Vec3 RegularLattice::place(std::size_t sample) const {
  const auto ny = static_cast<std::size_t>(count[1]), nz = static_cast<std::size_t>(count[2]);
  return index_to_world.point({static_cast<double>(sample / (ny * nz)),
                               static_cast<double>(sample / nz % ny),
                               static_cast<double>(sample % nz)});
}

LatticeWalk::LatticeWalk(const RegularLattice& lattice)
    : lattice_(lattice), to_index_(inverse_of(lattice.index_to_world.linear)) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (lattice.count[a] < 1) throw InputError("a lattice needs at least one sample on every axis");
    // Between the outermost samples and the zeros around them the field falls off linearly.
    low_[a] = lattice.interpolation == VoxelInterpolation::trilinear ? -1 : 0;
    high_[a] = lattice.count[a];
  }
}

void LatticeWalk::set_node(const std::array<int, 3>& cell, const std::array<double, 3>& place,
                           RayNode& node) const {
  const std::array<int, 3>& count = lattice_.count;
  const auto number = [&](int i, int j, int k) {
    return static_cast<std::uint32_t>((i * count[1] + j) * count[2] + k);
  };
  if (lattice_.interpolation == VoxelInterpolation::constant) {
    node.count = 1;
    node.sample[0] = number(cell[0], cell[1], cell[2]);
    node.weight[0] = 1;
    return;
  }
  const double x[2]{1 - place[0], place[0]}, y[2]{1 - place[1], place[1]},
      z[2]{1 - place[2], place[2]};
  bool inside = true;
  for (std::size_t a = 0; a < 3; ++a) inside = inside && cell[a] >= 0 && cell[a] + 1 < count[a];
  std::size_t n = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
    const std::array<int, 3> at{cell[0] + i, cell[1] + j, cell[2] + k};
    if (!inside)
      if (at[0] < 0 || at[1] < 0 || at[2] < 0 || at[0] >= count[0] || at[1] >= count[1] ||
          at[2] >= count[2])
        continue;
    node.sample[n] = number(at[0], at[1], at[2]);
    node.weight[n++] = x[i] * y[j] * z[k];
  }
  node.count = static_cast<int>(n);
}

void LatticeWalk::append(const Ray& ray, double t_near, double t_far,
                         std::vector<RayInterval>& out) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  constexpr double kNoMovement = 1e-200;
  const Vec3 o = to_index_ * (ray.origin - lattice_.index_to_world.translation);
  const Vec3 d = to_index_ * ray.direction;
  const double shift = lattice_.interpolation == VoxelInterpolation::constant ? 0.5 : 0;
  const std::array<double, 3> origin{o.x + shift, o.y + shift, o.z + shift};
  const std::array<double, 3> direction{d.x, d.y, d.z};
  double from = t_near, to = t_far;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!std::isfinite(origin[a]) || !std::isfinite(direction[a])) return;
    if (std::fabs(direction[a]) < kNoMovement) {
      if (origin[a] < low_[a] || origin[a] > high_[a]) return;
      continue;
    }
    const double t0 = (low_[a] - origin[a]) / direction[a];
    const double t1 = (high_[a] - origin[a]) / direction[a];
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  if (!(to > from)) return;
  std::array<int, 3> cell{};
  std::array<double, 3> inverse{}, crossing{kNever, kNever, kNever};
  const auto cross = [&](std::size_t a) {  // where the ray leaves its cell along an axis
    crossing[a] = (cell[a] + (direction[a] > 0 ? 1 : 0) - origin[a]) * inverse[a];
  };
  for (std::size_t a = 0; a < 3; ++a) {
    cell[a] = std::clamp(static_cast<int>(std::floor(origin[a] + from * direction[a])), low_[a],
                         high_[a] - 1);
    if (std::fabs(direction[a]) < kNoMovement) continue;
    inverse[a] = 1 / direction[a];
    cross(a);
  }
  for (double t = from; t < to;) {
    const double next =
        std::min(std::max(std::min({crossing[0], crossing[1], crossing[2]}), t), to);
    if (next > t) {
      RayInterval& interval = out.emplace_back();
      interval.length = next - t;
      for (std::size_t n = 0; n < 2; ++n) {
        const double at = t + kGaussNodes[n] * (next - t);
        std::array<double, 3> place{};
        for (std::size_t a = 0; a < 3; ++a)
          place[a] = std::clamp(origin[a] + at * direction[a] - cell[a], 0.0, 1.0);
        set_node(cell, place, interval.node[n]);
      }
    }
    t = next;
    for (std::size_t a = 0; a < 3; ++a) {
      if (crossing[a] > next) continue;
      cell[a] += direction[a] > 0 ? 1 : -1;
      if (cell[a] < low_[a] || cell[a] >= high_[a]) return;
      cross(a);
    }
  }
}

IntervalTransfer interval_transfer(double tau0, double tau1) {
  const auto thermal = PLENOFLAME_ISA::interval_weights(tau0, tau1);
  const auto line = PLENOFLAME_ISA::line_weights(tau0, tau1);
  return {thermal.transmittance, thermal.near, thermal.far, line.near, line.far};
}

namespace {

/// d/dtau of D = 1 + e^-tau - 2 (1 - e^-tau) / tau, by which the weight of the near end exceeds
/// that of the far one. Its series sum (-tau)^k (k - 1) / (k + 1)! where the closed form cancels.
double tilt_slope(double tau) {
  if (tau > 1) {
    const double passed = std::exp(-tau), emissivity = -std::expm1(-tau);
    return -passed + 2 * (emissivity / tau - passed) / tau;
  }
  double power = 1, factorial = 2, sum = 0;  // (-tau)^(k - 1) and (k + 1)!
  for (int k = 2; k < 24; ++k) {
    power *= -tau;
    factorial *= k + 1;
    sum -= power * (k * (k - 1)) / factorial;
  }
  return sum;
}

}  // namespace

TransferSlopes transfer_slopes(double tau0, double tau1) {
  // far = E tau1 / tau - g D within 0 and E, near = E - far (interval_weights()).
  constexpr double kHalfOverNodes = 0.86602540378443864676;
  const double tau = tau0 + tau1, passed = std::exp(-tau);
  if (!(tau > 0)) return {{1, 0}, {0, 1}};
  const double emissivity = -std::expm1(-tau), mean = emissivity / tau, share = tau1 / tau;
  const double tilt = 1 + passed - 2 * mean;
  const double far = emissivity * share - kHalfOverNodes * tilt;
  TransferSlopes slopes;
  if (far < 0) {
    slopes.near = {passed, passed};
    return slopes;
  }
  if (far > emissivity) {
    slopes.far = {passed, passed};
    return slopes;
  }
  const double common = passed * share - kHalfOverNodes * tilt_slope(tau);
  slopes.far = {common - mean * share, common + mean * (1 - share)};
  slopes.near = {passed - slopes.far[0], passed - slopes.far[1]};
  return slopes;
}

double node_weights(std::span<const RayInterval> intervals, std::span<const double> absorption,
                    RowModel model, std::vector<std::array<double, 2>>& weights) {
  weights.resize(intervals.size());
  double passed = 1;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const RayInterval& interval = intervals[i];
    if (absorption.empty()) {
      const double half = model == RowModel::emission ? 0.5 * interval.length : 0;
      weights[i] = {half, half};
      continue;
    }
    const double half = 0.5 * interval.length;
    const double tau0 = half * std::max(interval.node[0].value(absorption), 0.0);
    const double tau1 = half * std::max(interval.node[1].value(absorption), 0.0);
    const auto thermal = PLENOFLAME_ISA::interval_weights(tau0, tau1);
    if (model == RowModel::emission) {
      const auto line = PLENOFLAME_ISA::line_weights(tau0, tau1);
      const double scale = passed * interval.length;
      weights[i] = {scale * line.near, scale * line.far};
    } else {
      weights[i] = {passed * thermal.near, passed * thermal.far};
    }
    passed *= thermal.transmittance;
  }
  return passed;
}

}  // namespace plenoflame
