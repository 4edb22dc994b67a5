#include "voxel_image.h"

#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>

#include "plenoflame/base/error.h"

namespace plenoflame::pipeline {

void place_image(const AffineTransform& transform, const IndexBox& box, bool local,
                 vtkImageData& image) {
  const VoxelPlace place = voxel_place(transform, box);
  const auto last = [&](std::size_t k) { return static_cast<int>(place.size[k]) - 1; };
  image.SetExtent(0, last(0), 0, last(1), 0, last(2));
  vtkNew<vtkMatrix3x3> direction;
  for (int k = 0; k < 3 && !local; ++k) {
    const Vec3 unit = place.direction[static_cast<std::size_t>(k)];
    direction->SetElement(0, k, unit.x);
    direction->SetElement(1, k, unit.y);
    direction->SetElement(2, k, unit.z);
  }
  image.SetSpacing(place.spacing.data());
  image.SetDirectionMatrix(direction);
  if (local)
    image.SetOrigin(0, 0, 0);
  else
    image.SetOrigin(place.origin.x, place.origin.y, place.origin.z);
}

void local_to_world(const AffineTransform& transform, const IndexBox& box, vtkMatrix4x4& matrix) {
  const VoxelPlace place = voxel_place(transform, box);
  matrix.Identity();
  for (int k = 0; k < 3; ++k) {
    const Vec3 unit = place.direction[static_cast<std::size_t>(k)];
    matrix.SetElement(0, k, unit.x);
    matrix.SetElement(1, k, unit.y);
    matrix.SetElement(2, k, unit.z);
  }
  matrix.SetElement(0, 3, place.origin.x);
  matrix.SetElement(1, 3, place.origin.y);
  matrix.SetElement(2, 3, place.origin.z);
}

void add_array(const VoxelArray& values, vtkImageData& image) {
  vtkNew<vtkFloatArray> array;
  array->SetName(values.name.c_str());
  array->SetNumberOfValues(static_cast<vtkIdType>(values.values.size()));
  std::copy(values.values.begin(), values.values.end(), array->GetPointer(0));
  image.GetPointData()->AddArray(array);
}

VoxelField image_to_voxels(vtkImageData& image, const std::string& name, float background) {
  vtkDataArray* array = image.GetPointData()->GetArray(name.c_str());
  const bool cells = !array;
  if (cells) array = image.GetCellData()->GetArray(name.c_str());
  if (!array) {
    std::string present;
    for (vtkFieldData* data : {static_cast<vtkFieldData*>(image.GetPointData()),
                               static_cast<vtkFieldData*>(image.GetCellData())})
      for (int i = 0; i < data->GetNumberOfArrays(); ++i)
        if (const char* other = data->GetArrayName(i))
          present += (present.empty() ? "" : ", ") + std::string(other);
    throw InputError("there is no array '" + name + "'; " +
                     (present.empty() ? "the data has none" : "the data has " + present));
  }
  if (array->GetNumberOfComponents() != 1)
    throw InputError("the array '" + name + "' has " +
                     std::to_string(array->GetNumberOfComponents()) +
                     " components; a flame's values are single numbers");
  // Cell values sit in the middles of the cells.
  const double shift = cells ? 0.5 : 0;
  std::array<int, 6> extent{};
  image.GetExtent(extent.data());
  VoxelPlace place;
  vtkMatrix3x3* const direction = image.GetDirectionMatrix();
  image.GetSpacing(place.spacing.data());
  const double* const o = image.GetOrigin();
  place.origin = {o[0], o[1], o[2]};
  for (int a = 0; a < 3; ++a) {
    const auto n = static_cast<std::size_t>(a);
    place.size[n] = static_cast<std::size_t>(extent[2 * n + 1] - extent[2 * n] + (cells ? 0 : 1));
    place.direction[n] = {direction->GetElement(0, a), direction->GetElement(1, a),
                          direction->GetElement(2, a)};
    place.origin = place.origin + ((extent[2 * n] + shift) * place.spacing[n]) * place.direction[n];
  }
  return voxels_of(place, name, background, [&](std::size_t n) {
    return static_cast<float>(array->GetTuple1(static_cast<vtkIdType>(n)));
  });
}

}  // namespace plenoflame::pipeline
