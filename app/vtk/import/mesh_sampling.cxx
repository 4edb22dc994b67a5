#include "mesh_sampling.h"

#include <vtkAbstractArray.h>
#include <vtkBoundingBox.h>
#include <vtkCell.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkDataSet.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkGenericCell.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkProbeFilter.h>
#include <vtkUniformGrid.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "cell_to_point.h"
#include "plenoflame/base/error.h"
#include "plenoflame/math/vector.h"

namespace plenoflame::simulation {
namespace {

Vec3 point_of(vtkPoints& points, vtkIdType i) {
  double p[3];
  points.GetPoint(i, p);
  return {p[0], p[1], p[2]};
}

/// Six times the volume that the first corners span, positive when VTK's order is kept; 0 for kinds
/// of cells without such an order.
double orientation(int type, vtkPoints& p) {
  const auto triple = [&](vtkIdType a, vtkIdType b, vtkIdType c, vtkIdType d) {
    const Vec3 o = point_of(p, a);
    return dot(cross(point_of(p, b) - o, point_of(p, c) - o), point_of(p, d) - o);
  };
  switch (type) {
    case VTK_TETRA:
    case VTK_QUADRATIC_TETRA:
      return triple(0, 1, 2, 3);
    case VTK_HEXAHEDRON:
    case VTK_QUADRATIC_HEXAHEDRON:
      return triple(0, 1, 3, 4);
    case VTK_PYRAMID:
      return triple(0, 1, 3, 4);
    case VTK_WEDGE:
      return -triple(0, 1, 2, 3);  // VTK's wedges have their first triangle's normal outwards
    default:
      return 0;
  }
}

std::string arrays_of(const std::vector<vtkSmartPointer<vtkDataSet>>& parts) {
  std::set<std::string> names;
  for (const auto& part : parts)
    for (vtkDataSetAttributes* data : {static_cast<vtkDataSetAttributes*>(part->GetPointData()),
                                       static_cast<vtkDataSetAttributes*>(part->GetCellData())})
      for (int i = 0; i < data->GetNumberOfArrays(); ++i)
        if (data->GetArrayName(i) && data->GetArray(i)) names.insert(data->GetArrayName(i));
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

/// The part alone with that one array, on its points. Null: it has none.
vtkSmartPointer<vtkDataSet> with_point_array(vtkDataSet& part, const std::string& name,
                                             const std::string& path) {
  vtkDataArray* array = part.GetPointData()->GetArray(name.c_str());
  const bool cells = !array;
  if (cells) array = part.GetCellData()->GetArray(name.c_str());
  if (!array) return nullptr;
  if (array->GetNumberOfComponents() != 1)
    throw InputError("'" + path + "': the array '" + name + "' has " +
                     std::to_string(array->GetNumberOfComponents()) +
                     " components; a flame's values are single numbers");
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
    if (!std::isfinite(array->GetTuple1(i))) {
      double p[3]{};
      if (cells)
        part.GetCell(i)->GetPoints()->GetPoint(0, p);
      else
        part.GetPoint(i, p);
      throw InputError("'" + path + "': the array '" + name + "' is " +
                       std::to_string(array->GetTuple1(i)) + " at " + (cells ? "cell " : "point ") +
                       std::to_string(i) + " near (" + std::to_string(p[0]) + ", " +
                       std::to_string(p[1]) + ", " + std::to_string(p[2]) + ")");
    }
  const auto alone = vtkSmartPointer<vtkDataSet>::Take(part.NewInstance());
  alone->CopyStructure(&part);
  if (!cells) {
    alone->GetPointData()->AddArray(array);
    return alone;
  }
  const auto at_points = cells_to_points(part, *array);
  at_points->SetName(name.c_str());
  alone->GetPointData()->AddArray(at_points);
  return alone;
}

/// Layers, first and last along z, that are probed at a time: VTK's filter looks at no wish to
/// stop. Each looks at all cells of the mesh, so there are not many.
std::vector<std::array<int, 2>> slabs_of(vtkImageData& lattice) {
  constexpr vtkIdType kMost = 8, kPoints = 500000;
  std::array<int, 6> extent{};
  lattice.GetExtent(extent.data());
  const int layers = extent[5] - extent[4] + 1;
  const auto count = static_cast<int>(std::clamp<vtkIdType>(lattice.GetNumberOfPoints() / kPoints,
                                                            1, std::min<vtkIdType>(kMost, layers)));
  std::vector<std::array<int, 2>> slabs;
  for (int i = 0; i < count; ++i)
    slabs.push_back({extent[4] + layers * i / count, extent[4] + layers * (i + 1) / count - 1});
  return slabs;
}

/// Damaged files may give arrays of any length, and cells with corners that are not there.
/// @throws InputError
void check_sizes(vtkDataSet& part, const std::string& path) {
  const auto refuse = [&](const std::string& what) {
    throw InputError("'" + path + "' is damaged: " + what);
  };
  const auto check = [&](vtkDataSetAttributes& data, vtkIdType count, const char* of) {
    for (int i = 0; i < data.GetNumberOfArrays(); ++i) {
      const vtkIdType values = data.GetAbstractArray(i)->GetNumberOfTuples();
      if (values != count)
        refuse("an array has " + std::to_string(values) + " values for " + std::to_string(count) +
               " " + of);
    }
  };
  check(*part.GetPointData(), part.GetNumberOfPoints(), "points");
  check(*part.GetCellData(), part.GetNumberOfCells(), "cells");
  auto* const loose = vtkUnstructuredGrid::SafeDownCast(&part);
  vtkCellArray* const cells = loose ? loose->GetCells() : nullptr;
  if (!cells || part.GetNumberOfCells() == 0) return;
  if (!cells->IsValid()) refuse("its cells begin and end beyond the list of their corners");
  double range[2]{};
  cells->GetConnectivityArray()->GetRange(range);
  if (!(range[0] >= 0 && range[1] < static_cast<double>(part.GetNumberOfPoints())))
    refuse("a cell has a corner that is none of its points");
}

}  // namespace

void check_mesh(const std::vector<vtkSmartPointer<vtkDataSet>>& parts, const std::string& path) {
  vtkIdType solid = 0, regular = 0, inverted = 0, first = -1;
  for (const auto& part : parts) {
    check_sizes(*part, path);
    double b[6];
    part->GetBounds(b);
    for (const double value : b)
      if (part->GetNumberOfPoints() > 0 && !std::isfinite(value))
        throw InputError("'" + path + "': the mesh has coordinates that are not finite");
    if (auto* const image = vtkImageData::SafeDownCast(part)) {
      solid += image->GetDataDimension() == 3 ? image->GetNumberOfCells() : 0;
      continue;
    }
    auto* const loose = vtkUnstructuredGrid::SafeDownCast(part);
    vtkNew<vtkGenericCell> cell;
    for (vtkIdType i = 0; i < part->GetNumberOfCells(); ++i) {
      part->GetCell(i, cell);
      if (cell->GetCellDimension() != 3) continue;
      ++solid;
      if (!loose) break;  // a grid: one cell tells the dimension of all
      const double volume = orientation(cell->GetCellType(), *cell->GetPoints());
      if (std::isnan(volume))
        throw InputError("'" + path + "': cell " + std::to_string(i) +
                         " has coordinates that are not finite");
      regular += volume != 0;
      if (volume < 0) {
        if (first < 0) first = i;
        ++inverted;
      }
    }
  }
  if (solid == 0)
    throw InputError(
        "'" + path +
        "' has no cells with a volume; surfaces, lines and points cannot become a flame");
  // All of them the other way round is another convention, some of them is a broken mesh.
  if (inverted > 0 && inverted < regular)
    throw InputError("'" + path + "': " + std::to_string(inverted) + " of " +
                     std::to_string(regular) + " cells are inside out, the first is cell " +
                     std::to_string(first));
}

std::vector<ArrayRange> ranges_of(const std::vector<vtkSmartPointer<vtkDataSet>>& parts) {
  std::vector<ArrayRange> out;
  const auto add = [&](vtkDataSetAttributes& data, bool of_cells) {
    for (int i = 0; i < data.GetNumberOfArrays(); ++i) {
      vtkDataArray* const array = data.GetArray(i);
      if (!array || !array->GetName() || array->GetNumberOfComponents() != 1) continue;
      std::array<double, 2> range{};
      array->GetFiniteRange(range.data());
      const auto known = std::find_if(out.begin(), out.end(), [&](const ArrayRange& other) {
        return other.name == array->GetName();
      });
      if (known == out.end()) {
        out.push_back({array->GetName(), range, of_cells});
        continue;
      }
      known->range = {std::min(known->range[0], range[0]), std::max(known->range[1], range[1])};
    }
  };
  for (const auto& part : parts) {
    add(*part->GetPointData(), false);
    add(*part->GetCellData(), true);
  }
  return out;
}

std::array<double, 6> bounds_of(const std::vector<vtkSmartPointer<vtkDataSet>>& parts) {
  vtkBoundingBox box;
  for (const auto& part : parts)
    if (part->GetNumberOfPoints() > 0) box.AddBounds(part->GetBounds());
  std::array<double, 6> bounds{};
  box.GetBounds(bounds.data());
  return bounds;
}

std::vector<float> sample(const std::vector<vtkSmartPointer<vtkDataSet>>& parts,
                          const std::string& name, vtkImageData& lattice, const std::string& path,
                          const Watcher& watcher) {
  std::vector<float> values(static_cast<std::size_t>(lattice.GetNumberOfPoints()),
                            std::numeric_limits<float>::quiet_NaN());
  bool found = false;
  const std::vector<std::array<int, 2>> slabs = slabs_of(lattice);
  const auto count = static_cast<double>(parts.size() * slabs.size());
  double done = 0;
  for (const auto& part : parts) {
    const auto source = with_point_array(*part, name, path);
    if (!source) {
      done += static_cast<double>(slabs.size());
      continue;
    }
    found = true;
    vtkIdType first = 0;
    for (const auto& [low, high] : slabs) {
      const auto slab_watcher = [&watcher, count, before = done++](double share) {
        return watcher((before + share) / count);
      };
      vtkNew<vtkImageData> points;
      points->CopyStructure(&lattice);
      std::array<int, 6> extent{};
      lattice.GetExtent(extent.data());
      extent[4] = low;
      extent[5] = high;
      points->SetExtent(extent.data());
      vtkNew<vtkProbeFilter> probe;
      probe->SetInputData(points);
      probe->SetSourceData(source);
      update_watched(*probe, slab_watcher, [&] { probe->Update(); });
      vtkDataArray* const sampled = probe->GetOutput()->GetPointData()->GetArray(name.c_str());
      vtkDataArray* const valid =
          probe->GetOutput()->GetPointData()->GetArray(probe->GetValidPointMaskArrayName());
      for (vtkIdType i = 0; sampled && valid && i < sampled->GetNumberOfTuples(); ++i) {
        float& value = values[static_cast<std::size_t>(first + i)];
        if (std::isnan(value) && valid->GetTuple1(i) != 0)
          value = static_cast<float>(sampled->GetTuple1(i));
      }
      first += points->GetNumberOfPoints();
    }
  }
  if (!found)
    throw InputError("'" + path + "' has no array '" + name + "'; it has " + arrays_of(parts));
  return values;
}

}  // namespace plenoflame::simulation
