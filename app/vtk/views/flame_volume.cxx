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
#include <vector>

#include "emission_span.h"

namespace plenoflame::views {

vtkSmartPointer<vtkColorTransferFunction> temperature_colours(vtkImageData& flame) {
  const auto values = [&](const char* name) {
    vtkDataArray& array = *flame.GetPointData()->GetArray(name);
    std::vector<float> copy;
    for (vtkIdType i = 0; i < flame.GetNumberOfPoints(); ++i)
      copy.push_back(static_cast<float>(array.GetTuple1(i)));
    return copy;
  };
  auto [low, high] = emission_span(values("temperature"), values("absorption"));
  if (!(high > low)) low = 950, high = 1050;  // [K] nothing absorbs
  const auto colours = vtkSmartPointer<vtkColorTransferFunction>::New();
  // Inferno (S. van der Walt and N. Smith, CC0) from 0.4 on, as in the desktop application.
  constexpr double kBegin = 0.4;
  constexpr std::array<std::array<double, 4>, 11> kSteps{{{0.4, 148, 38, 102},
                                                          {0.4375, 163, 44, 97},
                                                          {0.5, 188, 55, 84},
                                                          {0.5625, 210, 70, 68},
                                                          {0.625, 228, 90, 49},
                                                          {0.6875, 241, 115, 29},
                                                          {0.75, 249, 142, 9},
                                                          {0.8125, 252, 172, 17},
                                                          {0.875, 249, 203, 53},
                                                          {0.9375, 242, 234, 105},
                                                          {1, 252, 255, 164}}};
  for (const auto& [at, red, green, blue] : kSteps)
    colours->AddRGBPoint(low + (high - low) * (at - kBegin) / (1 - kBegin), red / 255, green / 255,
                         blue / 255);
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
