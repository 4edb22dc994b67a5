#pragma once
#include <vector>

namespace plenoflame {

/// Nodes in (-1, 1) and weights of the Gauss-Legendre rule with `count` >= 1 nodes, to the last one
/// or two digits. Exact for polynomials up to degree 2 count - 1. Source: Newton's method on the
/// Legendre recurrence; Press et al., Numerical Recipes, 3rd ed., 4.6.
struct GaussLegendreRule {
  explicit GaussLegendreRule(int count);
  std::vector<double> nodes;
  std::vector<double> weights;
};

}  // namespace plenoflame
