#include "radiometry/gauss_rule.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "radiometry/gauss_legendre.h"

namespace plenoflame {

MeasurePoints wavenumber_points(const SpectralResponse& response, int order) {
  const GaussLegendreRule rule(order);
  MeasurePoints points;
  const std::vector<double>& breaks = response.breakpoints();
  for (std::size_t k = breaks.size() - 1; k > 0; --k) {
    const double low = 1 / breaks[k], extent = (breaks[k] - breaks[k - 1]) / breaks[k - 1] * low;
    const int parts = std::max(1, static_cast<int>(std::ceil(20 * std::log1p(extent / low))));
    for (int p = 0; p < parts; ++p) {
      // Geometric panels; a single one keeps the width of a narrow stretch exactly.
      const double ratio = 1 + extent / low;
      const double from = parts == 1 ? 0 : low * (std::pow(ratio, double(p) / parts) - 1);
      const double to = parts == 1 ? extent : low * (std::pow(ratio, (p + 1.0) / parts) - 1);
      for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double s = low + (from + 0.5 * (to - from) * (1 + rule.nodes[i]));
        // Rounding must not put a point of the rim outside.
        const double wavelength = std::clamp(1 / s, breaks[k - 1], breaks[k]);
        const double weight = 0.5 * (to - from) * rule.weights[i] * response(wavelength);
        if (!(weight > 0)) continue;
        points.places.push_back(s);
        points.weights.push_back(weight);
      }
    }
  }
  return points;
}

MeasurePoints gauss_rule(const MeasurePoints& measure, int count) {
  const auto n = static_cast<Eigen::Index>(measure.places.size());
  // Shifted and scaled to [-1, 1], or narrow measures would lose their digits.
  const auto [low, high] = std::minmax_element(measure.places.begin(), measure.places.end());
  const double middle = 0.5 * (*low + *high);
  const double half = *high > *low ? 0.5 * (*high - *low) : 1;
  Eigen::VectorXd x(n), root(n);
  double total = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    x[i] = (measure.places[k] - middle) / half;
    root[i] = std::sqrt(measure.weights[k]);
    total += measure.weights[k];
  }
  Eigen::MatrixXd q(n, count);
  Eigen::VectorXd diagonal(count), beside(std::max(0, count - 1));
  q.col(0) = root / root.norm();
  for (Eigen::Index j = 0; j < count; ++j) {
    Eigen::VectorXd next = x.cwiseProduct(q.col(j));
    diagonal[j] = q.col(j).dot(next);
    if (j + 1 == count) break;
    for (int twice = 0; twice < 2; ++twice)
      next -= q.leftCols(j + 1) * (q.leftCols(j + 1).transpose() * next);
    beside[j] = next.norm();
    q.col(j + 1) = next / beside[j];
  }
  MeasurePoints rule;
  if (count == 1) {
    rule.places = {middle + half * diagonal[0]};
    rule.weights = {total};
    return rule;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, beside);
  for (Eigen::Index j = 0; j < count; ++j) {
    const double first = solver.eigenvectors()(0, j);
    rule.places.push_back(middle + half * solver.eigenvalues()[j]);
    rule.weights.push_back(total * first * first);
  }
  return rule;
}

}  // namespace plenoflame
