#include "flame_volume.h"

#include <vtkColorTransferFunction.h>
#include <vtkDataArray.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace plenoflame::views {

vtkSmartPointer<vtkColorTransferFunction> temperature_colours(vtkImageData& flame) {
  vtkDataArray* const temperature = flame.GetPointData()->GetArray("temperature");
  vtkDataArray* const absorption = flame.GetPointData()->GetArray("absorption");
  double low = VTK_DOUBLE_MAX, high = 0;
  for (vtkIdType i = 0; i < flame.GetNumberOfPoints(); ++i)
    if (absorption->GetTuple1(i) > 0) {
      low = std::min(low, temperature->GetTuple1(i));
      high = std::max(high, temperature->GetTuple1(i));
    }
  if (low > high) low = high = 1000;
  if (high - low < 1) {
    low -= 50;
    high += 50;
  }
  const auto colours = vtkSmartPointer<vtkColorTransferFunction>::New();
  const std::array<std::array<double, 3>, 5> steps{
      {{0.35, 0.02, 0.05}, {0.75, 0.12, 0.04}, {0.98, 0.47, 0.08}, {1.0, 0.82, 0.35}, {1, 1, 0.9}}};
  for (std::size_t k = 0; k < steps.size(); ++k)
    colours->AddRGBPoint(low + (high - low) * static_cast<double>(k) / (steps.size() - 1),
                         steps[k][0], steps[k][1], steps[k][2]);
  return colours;
}

vtkSmartPointer<vtkVolume> flame_volume(vtkImageData& flame, vtkColorTransferFunction* colours) {
  vtkDataArray* const temperature = flame.GetPointData()->GetArray("temperature");
  vtkDataArray* const absorption = flame.GetPointData()->GetArray("absorption");
  vtkNew<vtkImageData> image;
  image->CopyStructure(&flame);
  vtkNew<vtkFloatArray> both;
  both->SetNumberOfComponents(2);
  both->SetNumberOfTuples(flame.GetNumberOfPoints());
  double thickest = 0;
  for (vtkIdType i = 0; i < flame.GetNumberOfPoints(); ++i) {
    const double kappa = absorption->GetTuple1(i);
    both->SetTypedComponent(i, 0, static_cast<float>(temperature->GetTuple1(i)));
    both->SetTypedComponent(i, 1, static_cast<float>(kappa));
    thickest = std::max(thickest, kappa);
  }
  image->GetPointData()->SetScalars(both);
  const std::array<int, 3> points{flame.GetDimensions()[0], flame.GetDimensions()[1],
                                  flame.GetDimensions()[2]};
  const double step = flame.GetSpacing()[0];
  const double across = step * (*std::min_element(points.begin(), points.end()) - 1);
  // Optical thickness 3 across the narrowest side of a flame that were as dense everywhere.
  const double gain = thickest > 0 ? 3 / (thickest * across) : 0;
  vtkNew<vtkPiecewiseFunction> opacity;
  constexpr int kSteps = 32;
  for (int k = 0; k <= kSteps; ++k) {
    const double kappa = thickest * k / kSteps;
    opacity->AddPoint(kappa, 1 - std::exp(-gain * kappa * step));
  }
  vtkNew<vtkVolumeProperty> property;
  property->IndependentComponentsOff();
  property->SetColor(colours);
  property->SetScalarOpacity(opacity);
  property->SetScalarOpacityUnitDistance(step);
  property->SetInterpolationTypeToLinear();
  vtkNew<vtkFixedPointVolumeRayCastMapper> mapper;
  mapper->SetInputData(image);
  mapper->SetAutoAdjustSampleDistances(0);
  mapper->SetImageSampleDistance(1);
  mapper->SetSampleDistance(static_cast<float>(step));
  mapper->SetInteractiveSampleDistance(static_cast<float>(step));
  const auto volume = vtkSmartPointer<vtkVolume>::New();
  volume->SetMapper(mapper);
  volume->SetProperty(property);
  return volume;
}

}  // namespace plenoflame::views
