#pragma once
#include <vtkSmartPointer.h>

class vtkDataArray;
class vtkDataSet;
class vtkDoubleArray;

namespace plenoflame::simulation {

/// Values of cells carried to the points of a mesh: at each point the linear function of place that
/// fits the cells around it best (least squares over their middles). A linear field is kept as it
/// is, up to the rim of the mesh, where a mean over the cells that there are would keep the value
/// of their middles, half a cell away. Flat cells count only where there are no others.
///
/// At the rim the fit goes half a cell beyond the middles; it may leave their range by half of it,
/// and does not change its sign.
vtkSmartPointer<vtkDoubleArray> cells_to_points(vtkDataSet& mesh, vtkDataArray& values);

}  // namespace plenoflame::simulation
