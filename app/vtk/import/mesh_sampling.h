#pragma once
#include <vtkSmartPointer.h>

#include <array>
#include <string>
#include <vector>

#include "watched_algorithm.h"

class vtkDataSet;
class vtkImageData;

namespace plenoflame::simulation {

/// Makes sure that parts of a mesh can be sampled.
/// @param length_scale metre per unit of the mesh
/// @throws InputError: no cells with a volume, coordinates that are not finite, some of the
///         tetrahedra, hexahedra, wedges or pyramids inside out
void check_mesh(const std::vector<vtkSmartPointer<vtkDataSet>>& parts, const std::string& path);

/// An array of single numbers, over all parts; not finite values do not count.
struct ArrayRange {
  std::string name;
  std::array<double, 2> range{};
  bool of_cells = false;
};
std::vector<ArrayRange> ranges_of(const std::vector<vtkSmartPointer<vtkDataSet>>& parts);

/// Bounds of all parts, in their units: x low, high, y low, ...
std::array<double, 6> bounds_of(const std::vector<vtkSmartPointer<vtkDataSet>>& parts);

/// Values of one array at the points of `lattice` (in the mesh's units), NaN outside of the mesh.
/// Within a cell values are interpolated as in VTK. Arrays of cells are first averaged to the
/// points. If parts overlap, the first one in the list counts.
/// @throws InputError: no part has such an array (lists those present), more than one component, a
///         value that is not finite (names its place); Cancelled
std::vector<float> sample(const std::vector<vtkSmartPointer<vtkDataSet>>& parts,
                          const std::string& array, vtkImageData& lattice, const std::string& path,
                          const Watcher& watcher);

}  // namespace plenoflame::simulation
