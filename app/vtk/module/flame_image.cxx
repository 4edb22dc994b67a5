#include "flame_image.h"

#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>

#include "plenoflame/media/medium_samples.h"

namespace plenoflame::pipeline {

vtkSmartPointer<vtkImageData> flame_image(const Medium& medium, int longest,
                                          const Execution& execution) {
  const MediumSamples samples = sample_medium(medium, SamplePlaces::nodes, longest, execution);
  if (samples.temperature.empty()) return nullptr;
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(samples.count.data());
  image->SetSpacing(samples.step.x, samples.step.y, samples.step.z);
  image->SetOrigin(samples.origin.x, samples.origin.y, samples.origin.z);
  const auto add = [&](const char* name, const std::vector<float>& values) {
    vtkNew<vtkFloatArray> array;
    array->SetName(name);
    array->SetNumberOfValues(static_cast<vtkIdType>(values.size()));
    std::copy(values.begin(), values.end(), array->GetPointer(0));
    image->GetPointData()->AddArray(array);
  };
  add("absorption", samples.absorption);
  add("temperature", samples.temperature);
  image->GetPointData()->SetActiveScalars("temperature");
  return image;
}

}  // namespace plenoflame::pipeline
