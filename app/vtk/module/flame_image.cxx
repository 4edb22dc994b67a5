#include "flame_image.h"

#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/media/medium_samples.h"
#include "plenoflame/scene/spectral.h"
#include "voxel_image.h"

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

FlameFields image_to_flame(vtkImageData& image, const std::string& temperature,
                           const std::string& absorption, double ambient,
                           const std::stop_token& stop) {
  const auto voxels = [&](const std::string& array, double background) {
    VoxelField field = image_to_voxels(image, array, static_cast<float>(background));
    if (stop.stop_requested()) throw Cancelled();
    check_flame_values(field);
    return field;
  };
  FlameFields flame{voxels(temperature, ambient), voxels(absorption, 0)};
  flame.temperature.name = "temperature";
  flame.absorption.name = "absorption";
  for (const LineGrid& line : line_grids()) {
    const std::string name(line.name);
    if (name != temperature && name != absorption && image.GetPointData()->HasArray(name.c_str()))
      flame.lines.push_back(voxels(name, 0));
  }
  return flame;
}

}  // namespace plenoflame::pipeline
