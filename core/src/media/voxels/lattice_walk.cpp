#include "plenoflame/media/lattice_walk.h"

#include <algorithm>
#include <cmath>

#include "base/isa_dispatch.h"
#include "media/voxels/interval_kernel.h"
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

struct IntervalKernels {
  int (*cut_at_cells)(const KernelLattice&, const KernelLine&, RayInterval*);
  void (*add_up_depths)(const RayInterval*, int, const double*, double, double*, double*);
  void (*weigh_nodes)(bool, int, const KernelTransfers&);
  void (*sum_nodes)(RayInterval*, int, double, const double*, const double*);
};

IntervalKernels interval_kernels() {
  PLENOFLAME_DISPATCH(best_isa(), return {kernels::cut_at_cells, kernels::add_up_depths,
                                          kernels::weigh_nodes, kernels::sum_nodes};)
}

}  // namespace

RayInterval* RayIntervals::room(std::size_t count) {
  if (size_ + count > capacity_) {
    capacity_ = std::max(size_ + count, 2 * capacity_);
    std::unique_ptr<RayInterval[]> larger(new RayInterval[capacity_]);
    std::copy_n(all_.get(), size_, larger.get());
    all_ = std::move(larger);
  }
  return all_.get() + size_;
}

RayInterval& RayIntervals::add_empty(double length) {
  RayInterval& added = *room(1);
  added = {};
  added.length = length;
  ++size_;
  return added;
}

double value_at(const RayInterval& interval, std::size_t node, std::span<const double> samples) {
  double sum = 0;
  for (int c = 0; c < interval.count; ++c)
    sum += interval.weight[node][c] * samples[interval.sample[c]];
  return sum;
}

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

void LatticeWalk::append(const Ray& ray, double t_near, double t_far, RayIntervals& out) const {
  constexpr double kNoMovement = 1e-200;
  const bool is_linear = lattice_.interpolation == VoxelInterpolation::trilinear;
  const Vec3 o = to_index_ * (ray.origin - lattice_.index_to_world.translation);
  const Vec3 d = to_index_ * ray.direction;
  const double shift = is_linear ? 0 : 0.5;
  KernelLine line{{o.x + shift, o.y + shift, o.z + shift}, {d.x, d.y, d.z}, t_near, t_far};
  KernelLattice cells{};
  cells.is_linear = is_linear;
  const std::array<int, 3>& count = lattice_.count;
  for (int c = 0; c < RayInterval::kCorners; ++c)
    cells.corner[c] = ((c & 1) * count[1] + (c >> 1 & 1)) * count[2] + (c >> 2);
  std::size_t most = 2;
  for (std::size_t a = 0; a < 3; ++a) {
    cells.count[a] = lattice_.count[a];
    cells.low[a] = low_[a];
    cells.high[a] = high_[a];
    most += static_cast<std::size_t>(high_[a] - low_[a]);
    if (!std::isfinite(line.origin[a]) || !std::isfinite(line.direction[a])) return;
    if (std::fabs(line.direction[a]) < kNoMovement) {
      if (line.origin[a] < low_[a] || line.origin[a] > high_[a]) return;
      continue;
    }
    const double t0 = (low_[a] - line.origin[a]) / line.direction[a];
    const double t1 = (high_[a] - line.origin[a]) / line.direction[a];
    line.from = std::max(line.from, std::min(t0, t1));
    line.to = std::min(line.to, std::max(t0, t1));
  }
  if (!(line.to > line.from)) return;
  const int added = interval_kernels().cut_at_cells(cells, line, out.room(most));
  out.add(static_cast<std::size_t>(added));
}

void IntervalTransfers::set(const RayIntervals& intervals, std::span<const double> absorption,
                            double ratio, RowModel model) {
  const std::size_t size = intervals.size();
  for (std::vector<double>* array : {&near_depth, &far_depth, &transmittance, &near, &far})
    array->resize(size);
  const int count = static_cast<int>(size);
  const IntervalKernels kernels = interval_kernels();
  kernels.add_up_depths(intervals.data(), count, absorption.data(), ratio, near_depth.data(),
                        far_depth.data());
  kernels.weigh_nodes(
      model == RowModel::emission, count,
      {near_depth.data(), far_depth.data(), transmittance.data(), near.data(), far.data()});
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
  // far = E tau1 / tau - g D within 0 and E, near = E - far (voxel_kernel_weights.h).
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

double node_weights(const RayIntervals& intervals, std::span<const double> absorption,
                    RowModel model, IntervalTransfers& weights) {
  if (absorption.empty()) {
    weights.near.clear();
    for (const RayInterval& interval : intervals)
      weights.near.push_back(model == RowModel::emission ? 0.5 * interval.length : 0);
    weights.far = weights.near;
    return 1;
  }
  weights.set(intervals, absorption, 1, model);
  double passed = 1;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const double scale = model == RowModel::emission ? passed * intervals[i].length : passed;
    weights.near[i] *= scale;
    weights.far[i] *= scale;
    passed *= weights.transmittance[i];
  }
  return passed;
}

void sum_nodes(double factor, const IntervalTransfers& weights, RayIntervals& intervals) {
  interval_kernels().sum_nodes(intervals.data(), static_cast<int>(intervals.size()), factor,
                               weights.near.data(), weights.far.data());
}

}  // namespace plenoflame
