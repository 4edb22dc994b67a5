#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "plenoflame/math/vector.h"

namespace plenoflame {

/// Columns and rows of the points.
struct GridBox {
  int left = std::numeric_limits<int>::max(), right = std::numeric_limits<int>::min(), top = left,
      bottom = right;
  void add(int column, int row) {
    *this = {std::min(left, column), std::max(right, column), std::min(top, row),
             std::max(bottom, row)};
  }
  int columns() const { return right - left + 1; }
  int rows() const { return bottom - top + 1; }
};

/// From columns and rows to places on the board's plane [m].
struct GridToPlane {
  Eigen::Matrix3d grid_to_plane = Eigen::Matrix3d::Identity();
  Vec2 operator()(double column, double row) const {
    const Eigen::Vector3d p = grid_to_plane * Eigen::Vector3d(column, row, 1);
    return {p.x() / p.z(), p.y() / p.z()};
  }
  /// Least squares of places. @param cell [m] their unit
  template <class Points>
  static GridToPlane of(const Points& points, double cell) {
    Eigen::MatrixXd rows(2 * static_cast<Eigen::Index>(points.size()), 8);
    Eigen::VectorXd places(rows.rows());
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto at = 2 * static_cast<Eigen::Index>(k);
      const double c = points[k].column, r = points[k].row;
      const double x = points[k].place.x / cell, y = points[k].place.y / cell;
      rows.row(at) << c, r, 1, 0, 0, 0, -c * x, -r * x;
      rows.row(at + 1) << 0, 0, 0, c, r, 1, -c * y, -r * y;
      places[at] = x;
      places[at + 1] = y;
    }
    const Eigen::VectorXd h = rows.completeOrthogonalDecomposition().solve(places);
    GridToPlane found;
    found.grid_to_plane << cell * h[0], cell * h[1], cell * h[2], cell * h[3], cell * h[4],
        cell * h[5], h[6], h[7], 1;
    return found;
  }
};

}  // namespace plenoflame
