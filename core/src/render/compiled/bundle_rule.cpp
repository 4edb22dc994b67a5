#include "render/compiled/bundle_rule.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace plenoflame {
namespace {

/// For each level: the number of the widest coordinates with products of degree 2, and the number
/// of halvings of the bundle.
struct Degrees {
  std::size_t squares;
  int halvings;
};
constexpr std::array<Degrees, kCompileLevels> kDegrees{
    {{0, 0}, {2, 0}, {2, 1}, {2, 2}, {2, 3}, {2, 4}, {2, 5}}};

Degrees degrees_of(int level) {
  return kDegrees[static_cast<std::size_t>(level - 1)];
}

/// Cells with fewer rays are not halved.
constexpr std::size_t kFewRays = 16;

/// Spreads below this share of the widest count as 0: they are rounding errors.
constexpr double kNoSpread = 1e-5;

}  // namespace

BundlePolynomials::BundlePolynomials(std::span<const BundleRay> bundle, int level, double reach) {
  const std::array<double, 4> scale{1, 1, reach, reach};
  double total = 0;
  std::array<double, 4> sums{};
  std::array<double, 16> products{};
  const auto& origin = bundle.front().place;
  for (const BundleRay& ray : bundle) {
    std::array<double, 4> x{};
    for (std::size_t k = 0; k < 4; ++k)
      x[k] = scale[k] * (static_cast<double>(ray.place[k]) - static_cast<double>(origin[k]));
    const double w = static_cast<double>(ray.weight);
    total += w;
    for (std::size_t i = 0; i < 4; ++i) {
      const double wx = w * x[i];
      sums[i] += wx;
      for (std::size_t j = 0; j <= i; ++j) products[4 * i + j] += wx * x[j];
    }
  }
  Eigen::Vector4d first;
  Eigen::Matrix4d spread;  // the solver reads its lower triangle
  for (int i = 0; i < 4; ++i) first[i] = sums[static_cast<std::size_t>(i)] / total;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j <= i; ++j)
      spread(i, j) = products[static_cast<std::size_t>(4 * i + j)] / total - first[i] * first[j];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> axes(spread);
  const double widest = axes.eigenvalues()[3];
  for (int i = 3; i >= 0; --i) {
    const double variance = axes.eigenvalues()[i];
    if (!(variance > kNoSpread * kNoSpread * widest)) break;
    for (int k = 0; k < 4; ++k)
      rows_[rank_][static_cast<std::size_t>(k)] =
          axes.eigenvectors()(k, i) * scale[static_cast<std::size_t>(k)] / std::sqrt(variance);
    ++rank_;
  }
  for (int k = 0; k < 4; ++k) {
    const auto at = static_cast<std::size_t>(k);
    mean_[at] = static_cast<double>(origin[at]) + (scale[at] > 0 ? first[k] / scale[at] : 0);
  }
  squares_ = std::min(rank_, degrees_of(level).squares);
  size_ = 1 + rank_ + squares_ * (squares_ + 1) / 2;
}

void BundlePolynomials::evaluate(const std::array<float, 4>& place, double* values) const {
  std::array<double, 4> x{}, y{};
  for (std::size_t k = 0; k < 4; ++k) x[k] = static_cast<double>(place[k]) - mean_[k];
  *values++ = 1;
  for (std::size_t i = 0; i < rank_; ++i) {
    y[i] = rows_[i][0] * x[0] + rows_[i][1] * x[1] + rows_[i][2] * x[2] + rows_[i][3] * x[3];
    *values++ = y[i];
  }
  for (std::size_t i = 0; i < squares_; ++i)
    for (std::size_t j = i; j < squares_; ++j) *values++ = y[i] * y[j];
}

std::vector<BundleRay> BundleReducer::reduce(std::span<const BundleRay> bundle,
                                             std::uint64_t seed) {
  std::vector<BundleRay> rays(bundle.begin(), bundle.end()), rule;
  WalkRandom random(seed);
  reduce_cell(rays, degrees_of(level_).halvings, random, rule);
  return rule;
}

/// Halves a cell across its widest extent, `halvings` times.
void BundleReducer::reduce_cell(std::span<BundleRay> cell, int halvings, WalkRandom& random,
                                std::vector<BundleRay>& rule) {
  if (halvings == 0 || cell.size() < kFewRays) {
    const std::vector<BundleRay> few = reduce_whole(cell, random);
    rule.insert(rule.end(), few.begin(), few.end());
    return;
  }
  const std::array<double, 4> scale{1, 1, reach_, reach_};
  double total = 0;
  std::array<double, 4> first{}, second{};
  const auto origin = cell[0].place;
  for (const BundleRay& ray : cell) {
    const double w = static_cast<double>(ray.weight);
    total += w;
    for (std::size_t k = 0; k < 4; ++k) {
      const double x =
          scale[k] * (static_cast<double>(ray.place[k]) - static_cast<double>(origin[k]));
      first[k] += w * x, second[k] += w * x * x;
    }
  }
  std::size_t widest = 0;
  double most = -1;
  for (std::size_t k = 0; k < 4; ++k) {
    const double variance = second[k] / total - first[k] * first[k] / (total * total);
    if (variance > most) most = variance, widest = k;
  }
  const std::size_t half = cell.size() / 2;
  std::nth_element(cell.begin(), cell.begin() + static_cast<std::ptrdiff_t>(half), cell.end(),
                   [widest](const BundleRay& a, const BundleRay& b) {
                     return a.place[widest] < b.place[widest];
                   });
  reduce_cell(cell.first(half), halvings - 1, random, rule);
  reduce_cell(cell.subspan(half), halvings - 1, random, rule);
}

std::vector<BundleRay> BundleReducer::reduce_whole(std::span<const BundleRay> bundle,
                                                   WalkRandom& random) {
  if (bundle.size() < 3) return {bundle.begin(), bundle.end()};
  const BundlePolynomials polynomials(bundle, level_, reach_);
  const std::size_t n = polynomials.size();
  if (bundle.size() <= n || n < 2) return {bundle.begin(), bundle.end()};
  order_along(polynomials, bundle);
  const std::size_t most = walked_per_polynomial_ * n;
  const std::size_t step = (bundle.size() + most - 1) / most;
  bool is_whole = step < 2;
  if (!is_whole) {
    const std::vector<std::uint32_t> all = order_;
    take_every(step, random);
    evaluate(polynomials, bundle);
    is_whole = !calibrate(polynomials, bundle);
    if (is_whole) order_ = all;
  }
  if (is_whole) evaluate(polynomials, bundle);
  MomentWalk walk(n);
  walk.start();
  for (std::size_t i = 0; i < order_.size(); ++i)
    walk.add(i, values_.data() + i * n, weights_[i], random);
  std::vector<BundleRay> rule;
  for (const MomentWalk::Kept& kept : walk.kept())
    rule.push_back({bundle[order_[kept.point]].place, static_cast<float>(kept.weight)});
  return rule;
}

void BundleReducer::evaluate(const BundlePolynomials& polynomials,
                             std::span<const BundleRay> bundle) {
  const std::size_t n = polynomials.size();
  values_.resize(order_.size() * n);
  weights_.resize(order_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) {
    polynomials.evaluate(bundle[order_[i]].place, values_.data() + i * n);
    weights_[i] = static_cast<double>(bundle[order_[i]].weight);
  }
}

/// Sorts rays by their widest coordinate, in narrow bins. The walk then replaces the weight of a
/// removed ray by that of its neighbours.
void BundleReducer::order_along(const BundlePolynomials& polynomials,
                                std::span<const BundleRay> bundle) {
  constexpr std::size_t kBins = 128;
  constexpr double kWidest = 3;  // standard deviations
  std::array<std::uint32_t, kBins + 1> begin{};
  bins_.resize(bundle.size());
  for (std::size_t i = 0; i < bundle.size(); ++i) {
    const double at = (polynomials.widest(bundle[i].place) / kWidest + 1) * (0.5 * kBins);
    bins_[i] = static_cast<std::uint32_t>(std::clamp(at, 0.0, kBins - 1.0));
    ++begin[bins_[i] + 1];
  }
  for (std::size_t b = 1; b <= kBins; ++b) begin[b] += begin[b - 1];
  order_.resize(bundle.size());
  for (std::size_t i = 0; i < bundle.size(); ++i)
    order_[begin[bins_[i]]++] = static_cast<std::uint32_t>(i);
}

/// Keeps one random ray of every `step` rays, in their order.
void BundleReducer::take_every(std::size_t step, WalkRandom& random) {
  std::size_t count = 0;
  for (std::size_t first = 0; first < order_.size(); first += step) {
    const std::size_t size = std::min(step, order_.size() - first);
    const auto chosen = static_cast<std::size_t>(random.uniform() * static_cast<double>(size));
    order_[count++] = order_[first + std::min(chosen, size - 1)];
  }
  order_.resize(count);
}

/// Changes the weights as little as possible so that the sums equal those of the whole bundle: the
/// calibration estimator (J.-C. Deville, C.-E. Sarndal, J. Am. Stat. Assoc. 87 (1992), 376).
/// @return false if a weight would become negative
bool BundleReducer::calibrate(const BundlePolynomials& polynomials,
                              std::span<const BundleRay> bundle) {
  std::vector<double> sums(polynomials.size()), of_ray(polynomials.size());
  for (const BundleRay& ray : bundle) {
    polynomials.evaluate(ray.place, of_ray.data());
    const double weight = static_cast<double>(ray.weight);
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += weight * of_ray[k];
  }
  const auto n = static_cast<Eigen::Index>(polynomials.size());
  double total = 0;
  for (const double weight : weights_) total += weight;
  for (double& weight : weights_) weight *= sums[0] / total;
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd missing = Eigen::Map<const Eigen::VectorXd>(sums.data(), n);
  const Eigen::Map<const Eigen::MatrixXd> values(values_.data(), n,
                                                 static_cast<Eigen::Index>(weights_.size()));
  const Eigen::Map<const Eigen::VectorXd> weights(weights_.data(),
                                                  static_cast<Eigen::Index>(weights_.size()));
  products.noalias() = values * weights.asDiagonal() * values.transpose();
  missing.noalias() -= values * weights;
  const Eigen::LDLT<Eigen::MatrixXd> solver(products);
  const Eigen::VectorXd change = values.transpose() * solver.solve(missing);
  if (solver.info() != Eigen::Success || !(change.minCoeff() > -1) || !change.allFinite())
    return false;
  for (Eigen::Index i = 0; i < change.size(); ++i)
    weights_[static_cast<std::size_t>(i)] *= 1 + change[i];
  return true;
}

}  // namespace plenoflame
