#include "cell_to_point.h"

#include <vtkDataSet.h>
#include <vtkDoubleArray.h>
#include <vtkGenericCell.h>
#include <vtkIdList.h>
#include <vtkMath.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "plenoflame/math/vector.h"

namespace plenoflame::simulation {
namespace {

struct Cell {
  Vec3 middle;
  double value = 0;
  bool solid = false;
};

/// Sums over some cells from which the linear fit follows.
struct Fit {
  Vec3 middle;         ///< mean of the cells' middles
  double spread2 = 0;  ///< mean square distance of the middles from the point
  double value = 0;    ///< at the point
  double low = std::numeric_limits<double>::infinity(), high = -low;
};

Fit fit(const std::vector<Cell>& cells, const std::vector<vtkIdType>& which, Vec3 point) {
  Fit fit;
  const double share = 1 / static_cast<double>(which.size());
  double mean = 0;
  for (const vtkIdType i : which) {
    const Cell& cell = cells[static_cast<std::size_t>(i)];
    fit.middle = fit.middle + share * cell.middle;
    fit.spread2 += share * dot(cell.middle - point, cell.middle - point);
    mean += share * cell.value;
    fit.low = std::min(fit.low, cell.value);
    fit.high = std::max(fit.high, cell.value);
  }
  double moments[3][3] = {}, slopes[3] = {};
  for (const vtkIdType i : which) {
    const Cell& cell = cells[static_cast<std::size_t>(i)];
    const Vec3 away = cell.middle - fit.middle;
    const double d[3] = {away.x, away.y, away.z};
    for (int r = 0; r < 3; ++r) {
      slopes[r] += d[r] * (cell.value - mean);
      for (int c = 0; c < 3; ++c) moments[r][c] += d[r] * d[c];
    }
  }
  // In directions in which the middles do not differ nothing is known of the slope.
  constexpr double kFlat = 1e-6;
  double sizes[3], axes[3][3];
  vtkMath::Diagonalize3x3(moments, sizes, axes);
  for (int k = 0; k < 3; ++k) {
    double size = 0;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) size += axes[r][k] * moments[r][c] * axes[c][k];
    sizes[k] = size;
  }
  const double largest = std::max({sizes[0], sizes[1], sizes[2]});
  fit.value = mean;
  for (int k = 0; k < 3 && largest > 0; ++k) {
    if (!(sizes[k] > kFlat * largest)) continue;
    const Vec3 axis{axes[0][k], axes[1][k], axes[2][k]};
    const double slope =
        (axes[0][k] * slopes[0] + axes[1][k] * slopes[1] + axes[2][k] * slopes[2]) / sizes[k];
    fit.value += slope * dot(axis, point - fit.middle);
  }
  return fit;
}

}  // namespace

vtkSmartPointer<vtkDoubleArray> cells_to_points(vtkDataSet& mesh, vtkDataArray& values) {
  std::vector<Cell> cells(static_cast<std::size_t>(mesh.GetNumberOfCells()));
  bool any_solid = false;
  vtkNew<vtkGenericCell> corner;
  for (vtkIdType i = 0; i < mesh.GetNumberOfCells(); ++i) {
    mesh.GetCell(i, corner);
    Cell& cell = cells[static_cast<std::size_t>(i)];
    cell.value = values.GetTuple1(i);
    cell.solid = corner->GetCellDimension() == 3;
    any_solid = any_solid || cell.solid;
    const auto count = static_cast<double>(corner->GetNumberOfPoints());
    for (vtkIdType k = 0; k < corner->GetNumberOfPoints(); ++k) {
      std::array<double, 3> p{};
      corner->GetPoints()->GetPoint(k, p.data());
      cell.middle = cell.middle + (1 / count) * Vec3{p[0], p[1], p[2]};
    }
  }
  const auto result = vtkSmartPointer<vtkDoubleArray>::New();
  result->SetNumberOfValues(mesh.GetNumberOfPoints());
  vtkNew<vtkIdList> ids, corners, beside;
  std::vector<vtkIdType> ring;
  const auto keep = [&](vtkIdList& list) {
    for (vtkIdType k = 0; k < list.GetNumberOfIds(); ++k)
      if (cells[static_cast<std::size_t>(list.GetId(k))].solid || !any_solid)
        ring.push_back(list.GetId(k));
  };
  for (vtkIdType i = 0; i < mesh.GetNumberOfPoints(); ++i) {
    ring.clear();
    mesh.GetPointCells(i, ids);
    keep(*ids);
    if (ring.empty()) {
      result->SetValue(i, 0);  // of no cell: nothing is interpolated from it
      continue;
    }
    std::array<double, 3> p{};
    mesh.GetPoint(i, p.data());
    const Vec3 point{p[0], p[1], p[2]};
    Fit found = fit(cells, ring, point);
    // A point at the rim has its cells on one side: the next ones give the slope.
    constexpr double kOneSided = 0.25;
    const Vec3 away = found.middle - point;
    if (dot(away, away) > kOneSided * kOneSided * found.spread2) {
      const std::vector<vtkIdType> first = ring;
      for (const vtkIdType cell : first) {
        mesh.GetCellPoints(cell, corners);
        for (vtkIdType k = 0; k < corners->GetNumberOfIds(); ++k) {
          mesh.GetPointCells(corners->GetId(k), beside);
          keep(*beside);
        }
      }
      std::sort(ring.begin(), ring.end());
      ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
      found = fit(cells, ring, point);
    }
    const double room = 0.5 * (found.high - found.low);
    const double low = found.low >= 0 ? std::max(0.0, found.low - room) : found.low - room;
    const double high = found.high <= 0 ? std::min(0.0, found.high + room) : found.high + room;
    result->SetValue(i, std::clamp(found.value, low, high));
  }
  return result;
}

}  // namespace plenoflame::simulation
