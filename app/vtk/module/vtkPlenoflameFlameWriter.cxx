#include "vtkPlenoflameFlameWriter.h"

#include <vtkImageData.h>
#include <vtkObjectFactory.h>

#include <array>
#include <cmath>

#include "pipeline_run.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "plenoflame/volumes/grid_writer.h"
#include "voxel_image.h"

vtkStandardNewMacro(vtkPlenoflameFlameWriter);

namespace {

/// @throws InputError naming array and voxel
void check_values(const plenoflame::VoxelField& field) {
  for (std::size_t n = 0; n < field.values.size(); ++n) {
    if (std::isfinite(field.values[n]) && field.values[n] >= 0) continue;
    const std::array<int, 3> origin = field.brick_origins[n / 512];
    const int at = static_cast<int>(n % 512);
    throw plenoflame::InputError(
        "the array '" + field.name + "' is " + std::to_string(field.values[n]) + " at (" +
        std::to_string(origin[0] + at / 64) + ", " + std::to_string(origin[1] + at / 8 % 8) + ", " +
        std::to_string(origin[2] + at % 8) + "); values must be finite and not negative");
  }
}

}  // namespace

vtkPlenoflameFlameWriter::vtkPlenoflameFlameWriter() {
  this->SetNumberOfOutputPorts(0);
}

vtkPlenoflameFlameWriter::~vtkPlenoflameFlameWriter() {
  this->SetFileName(nullptr);
}

void vtkPlenoflameFlameWriter::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n"
     << indent << "TemperatureArray: " << this->TemperatureArray << "\n"
     << indent << "AbsorptionArray: " << this->AbsorptionArray << "\n"
     << indent << "AmbientTemperature: " << this->AmbientTemperature << "\n"
     << indent << "Half: " << this->Half << "\n";
}

bool vtkPlenoflameFlameWriter::Write() {
  using namespace plenoflame;
  vtkImageData* image = nullptr;
  if (!plenoflame::pipeline::run_here(*this, [&] {
        vtkAlgorithm* const source = this->GetInputAlgorithm(0, 0);
        if (!source) throw UsageError("there is no flame to write: set an input");
        source->Update();
        image = vtkImageData::SafeDownCast(this->GetInputDataObject(0, 0));
        if (!image || image->GetNumberOfPoints() == 0)
          throw UsageError("the input gave no image to write");
      }))
    return false;
  return plenoflame::pipeline::run(*this, 1, [&](const Execution& execution) {
    const auto voxels = [&](const std::string& array, float background) {
      VoxelField field = plenoflame::pipeline::image_to_voxels(*image, array, background);
      if (execution.stop.stop_requested()) throw Cancelled();
      check_values(field);
      return field;
    };
    VoxelField temperature =
        voxels(this->TemperatureArray, static_cast<float>(this->AmbientTemperature));
    VoxelField absorption = voxels(this->AbsorptionArray, 0);
    temperature.name = "temperature";
    absorption.name = "absorption";
    const std::array<GridOutput, 2> grids{{{&temperature, "K"}, {&absorption, "1/m"}}};
    GridWriteOptions options;
    options.half = this->Half;
    options.metadata = {{"creator", "plenoflame " + std::string(version())}};
    options.stop = execution.stop;
    write_grids(this->FileName ? this->FileName : "", grids, options);
  });
}
