#include "calibration/geometry_errors.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

namespace plenoflame {
namespace {

constexpr std::size_t kDistances = 4;  ///< classes of distances from a micro-image's middle
constexpr double kSignificant = 3;     ///< standard deviations

/// Residuals outwards over offsets: the slope of a line through 0, and its variance.
struct Slope {
  double moment = 0, squares = 0, scatter = 0;
  std::vector<std::pair<double, double>> terms;  ///< offset^2, offset * residual
  void add(const FittedPoint& point) {
    const double square = dot(point.offset, point.offset),
                 product = dot(point.offset, point.residual);
    moment += product;
    squares += square;
    terms.emplace_back(square, product);
  }
  double value() const { return squares > 0 ? moment / squares : 0; }
  double variance() const {
    double sum = 0;
    for (const auto& [square, product] : terms) sum += std::pow(product - value() * square, 2);
    return squares > 0 ? sum / (squares * squares) : 0;
  }
};

}  // namespace

OutwardsDisplacement outwards_displacement(const std::vector<FittedPoint>& points,
                                           std::size_t types) {
  double farthest = 0;
  for (const FittedPoint& point : points)
    if (point.pose != kNoPose) farthest = std::max(farthest, length(point.offset));
  std::vector<Slope> by_type(types), cells(types * kDistances);
  for (const FittedPoint& point : points) {
    if (point.pose == kNoPose || !(farthest > 0)) continue;
    const double share = length(point.offset) / farthest;
    const std::size_t distance =
        std::min(kDistances - 1, static_cast<std::size_t>(share * kDistances));
    by_type[point.type].add(point);
    cells[point.type * kDistances + distance].add(point);
  }
  OutwardsDisplacement found;
  for (const Slope& slope : by_type) found.by_type.push_back(slope.value());
  double sum = 0, weights = 0;
  for (const Slope& cell : cells) {
    const double variance = cell.variance(), square = cell.value() * cell.value();
    if (square > kSignificant * kSignificant * variance) sum += cell.squares * (square - variance);
    weights += cell.squares;
  }
  if (weights > 0) found.scatter = std::sqrt(sum / weights);
  return found;
}

Eigen::MatrixXd geometry_covariance(const FittedPoints& fitted, double outwards, double pupil) {
  const Eigen::Index size = fitted.square.rows();
  std::vector<Eigen::Index> wanted(static_cast<std::size_t>(fitted.values));
  std::iota(wanted.begin(), wanted.end(), 0);
  wanted.insert(wanted.end(), fitted.others.begin(), fitted.others.end());
  const auto n = static_cast<Eigen::Index>(wanted.size());
  // The rows of the inverse for these unknowns; all others follow them.
  const Eigen::MatrixXd inverse = fitted.square.ldlt()
                                      .solve(Eigen::MatrixXd::Identity(size, size))
                                      .eval()(wanted, Eigen::all)
                                      .eval();
  // Each point moves the values; points of a group may err together.
  using Group = std::tuple<std::size_t, int, int>;
  std::map<Group, Eigen::VectorXd> by_image;
  std::map<std::size_t, Eigen::VectorXd> by_board;
  Eigen::MatrixXd single = Eigen::MatrixXd::Zero(n, n), centres = single;
  Eigen::VectorXd by_outwards = Eigen::VectorXd::Zero(n), by_pupil = by_outwards;
  for (const FittedPoint& point : fitted.points) {
    Eigen::Matrix<double, Eigen::Dynamic, 2> gain =
        Eigen::Matrix<double, Eigen::Dynamic, 2>::Zero(n, 2);
    for (const FittedPoint::Block& block : point.blocks)
      gain += inverse.middleCols(block.unknown, block.count) *
              point.rows.middleCols(block.column, block.count).transpose();
    const auto moved = [&](Vec2 by) -> Eigen::VectorXd {
      return gain * Eigen::Vector2d(by.x, by.y);
    };
    by_pupil += moved(point.by_pupil);
    const Eigen::VectorXd own = moved(point.residual);
    if (point.pose == kNoPose) {
      centres += own * own.transpose();
      continue;
    }
    by_outwards += moved(point.offset);
    single += own * own.transpose();
    const auto add = [&](auto& groups, const auto& key) {
      const auto [at, is_new] = groups.try_emplace(key, own);
      if (!is_new) at->second += own;
    };
    add(by_image, Group{point.pose, point.lens.q, point.lens.r});
    add(by_board, point.pose);
  }
  const auto sum_of = [&](const auto& groups) {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
    for (const auto& [key, moves] : groups) sum += moves * moves.transpose();
    const auto g = static_cast<double>(groups.size());
    return (sum * (g / std::max(1.0, g - 1))).eval();
  };
  // The residuals have fewer degrees of freedom than there are points.
  double rows = 0;  // a blur is one
  for (const FittedPoint& point : fitted.points) rows += point.rows.row(1).isZero(0) ? 1 : 2;
  const double fewer = rows / std::max(1.0, rows - static_cast<double>(size));
  Eigen::MatrixXd found = fewer * (single + centres);
  const Eigen::VectorXd deviation = found.diagonal().cwiseSqrt();
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(n);
  for (const Eigen::MatrixXd& other : {sum_of(by_image), sum_of(by_board)})
    for (Eigen::Index k = 0; k < n; ++k)
      if (deviation(k) > 0)
        scale(k) = std::max(scale(k), std::sqrt(other(k, k) + centres(k, k)) / deviation(k));
  found = (scale.asDiagonal() * found * scale.asDiagonal()).eval();
  // Loose values and radii have errors of their own.
  for (const LooseValue& loose : fitted.loose) {
    const Eigen::VectorXd gain = std::sqrt(loose.weight) * inverse.col(loose.unknown);
    found += fitted.noise2 * gain * gain.transpose();
  }
  for (std::size_t k = 0; k < fitted.known.size(); ++k) {
    const Eigen::VectorXd gain = inverse * fitted.known[k];
    found += fitted.noise2 * gain * gain.transpose();
    if (k == 0) by_pupil += fitted.radii_by_pupil * gain;
  }
  found += outwards * outwards * by_outwards * by_outwards.transpose();
  found += pupil * pupil * by_pupil * by_pupil.transpose();
  return found;
}

}  // namespace plenoflame
