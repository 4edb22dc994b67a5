#pragma once
#include <vtkSmartPointer.h>

class vtkDataArray;
class vtkDataSet;
class vtkDoubleArray;

namespace plenoflame::simulation {

/// Carries the values of cells to the points of a mesh. A point gets the linear function of place
/// that best fits the cells around it (least squares over their middles). A linear field is kept,
/// also at the rim of the mesh. A mean over the cells would give the value of their middles there,
/// half a cell away. Flat cells count only where there are no others.
///
/// At the rim the fit extrapolates by half a cell. It may leave the range of the middles by half of
/// it, and does not change its sign.
vtkSmartPointer<vtkDoubleArray> cells_to_points(vtkDataSet& mesh, vtkDataArray& values);

}  // namespace plenoflame::simulation
