#include "vtkPlenoflameFlameImport.h"

#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <vector>

#include "mesh_sampling.h"
#include "plenoflame/base/error.h"
#include "plenoflame/volumes/flame_library.h"
#include "simulation_reader.h"

using plenoflame::InputError;
using plenoflame::UsageError;

struct vtkPlenoflameFlameImport::Internals {
  std::unique_ptr<plenoflame::simulation::SimulationReader> Reader;
  std::string Opened;
};

vtkStandardNewMacro(vtkPlenoflameFlameImport);

namespace {

/// Fills voxels outside of the mesh from filled neighbours, layer by layer.
void extend(std::vector<float>& values, const int (&size)[3], int layers) {
  const std::array<std::ptrdiff_t, 3> stride{1, size[0],
                                             static_cast<std::ptrdiff_t>(size[0]) * size[1]};
  for (int layer = 0; layer < layers; ++layer) {
    const std::vector<float> before = values;
    std::ptrdiff_t n = 0;
    for (int k = 0; k < size[2]; ++k)
      for (int j = 0; j < size[1]; ++j)
        for (int i = 0; i < size[0]; ++i, ++n) {
          if (!std::isnan(before[static_cast<std::size_t>(n)])) continue;
          double sum = 0;
          int count = 0;
          for (int c = std::max(0, k - 1); c <= std::min(size[2] - 1, k + 1); ++c)
            for (int b = std::max(0, j - 1); b <= std::min(size[1] - 1, j + 1); ++b)
              for (int a = std::max(0, i - 1); a <= std::min(size[0] - 1, i + 1); ++a) {
                const float value =
                    before[static_cast<std::size_t>(a + stride[1] * b + stride[2] * c)];
                if (std::isnan(value)) continue;
                sum += static_cast<double>(value);
                ++count;
              }
          if (count > 0) values[static_cast<std::size_t>(n)] = static_cast<float>(sum / count);
        }
  }
}

/// Sets negligible absorption to 0, so that no voxels are stored for it. It changes neither the
/// densest voxel in single precision nor the light of a ray through the whole flame.
/// @param longest [m] side of the flame
void drop_nothing(std::vector<float>& absorption, double longest) {
  constexpr double kNothing = 1e-7;
  const float most =
      absorption.empty() ? 0 : *std::max_element(absorption.begin(), absorption.end());
  const double least = std::min(kNothing * static_cast<double>(most), kNothing / longest);
  for (float& value : absorption)
    if (static_cast<double>(value) < least) value = 0;
}

}  // namespace

vtkPlenoflameFlameImport::vtkPlenoflameFlameImport() : Internal(std::make_unique<Internals>()) {
  this->SetNumberOfInputPorts(0);
}

vtkPlenoflameFlameImport::~vtkPlenoflameFlameImport() {
  this->SetFileName(nullptr);
  this->SetSolutionFileName(nullptr);
}

void vtkPlenoflameFlameImport::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n"
     << indent
     << "SolutionFileName: " << (this->SolutionFileName ? this->SolutionFileName : "(none)") << "\n"
     << indent << "TemperatureArray: " << this->TemperatureArray << " [" << this->TemperatureUnit
     << "] x " << this->TemperatureScale << "\n"
     << indent << "AbsorptionArray: " << this->AbsorptionArray << " [" << this->AbsorptionUnit
     << "]\n"
     << indent << "SootArray: " << this->SootArray << "\n"
     << indent << "ConstantAbsorption: " << this->ConstantAbsorption << "\n"
     << indent << "SootFunction: " << this->SootFunction << "\n"
     << indent << "Wavelength: " << this->Wavelength << "\n"
     << indent << "VoxelSize: " << this->VoxelSize << "\n"
     << indent << "LengthScale: " << this->LengthScale << "\n"
     << indent << "Bounds: " << this->Bounds[0] << " " << this->Bounds[1] << " " << this->Bounds[2]
     << " " << this->Bounds[3] << " " << this->Bounds[4] << " " << this->Bounds[5] << "\n"
     << indent << "TimeStep: " << this->TimeStep << "\n"
     << indent << "AmbientTemperature: " << this->AmbientTemperature << "\n";
}

void vtkPlenoflameFlameImport::Open() {
  const std::string path = this->FileName ? this->FileName : "";
  const std::string second = this->SolutionFileName ? this->SolutionFileName : "";
  if (this->Internal->Reader && this->Internal->Opened == path + "\n" + second) return;
  this->Internal->Reader = std::make_unique<plenoflame::simulation::SimulationReader>(path, second);
  this->Internal->Opened = path + "\n" + second;
}

int vtkPlenoflameFlameImport::GetNumberOfTimeSteps() {
  try {
    this->Open();
    return static_cast<int>(this->Internal->Reader->times().size());
  } catch (const std::exception& error) {
    vtkErrorMacro(<< error.what());
    return 0;
  }
}

double vtkPlenoflameFlameImport::GetTime(int step) {
  return step >= 0 && step < this->GetNumberOfTimeSteps()
             ? this->Internal->Reader->times()[static_cast<std::size_t>(step)]
             : 0;
}

void vtkPlenoflameFlameImport::ListArrays(
    const std::function<void(const std::string&, double, double, bool)>& take) {
  this->Open();
  const auto parts = this->Internal->Reader->read(
      static_cast<std::size_t>(std::max(0, this->TimeStep)), [this](double part) {
        this->UpdateProgress(part);
        return this->GetAbortExecute() == 0;
      });
  for (const auto& array : plenoflame::simulation::ranges_of(parts))
    take(array.name, array.range[0], array.range[1], array.of_cells);
}

int vtkPlenoflameFlameImport::RequestInformation(vtkInformation*, vtkInformationVector**,
                                                 vtkInformationVector* outputs) {
  const std::array<int, 6> extent{0, 0, 0, 0, 0, 0};  // known when the mesh has been read
  outputs->GetInformationObject(0)->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(),
                                        extent.data(), 6);
  return 1;
}

int vtkPlenoflameFlameImport::RequestData(vtkInformation*, vtkInformationVector**,
                                          vtkInformationVector* outputs) {
  try {
    this->Fill(vtkImageData::GetData(outputs));
    return 1;
  } catch (const plenoflame::Cancelled&) {
    // As requested by AbortExecute. The reader may have stopped amid its mesh, and what was not
    // made is not up to date: the next Update() starts again.
    vtkImageData::GetData(outputs)->Initialize();
    this->Internal->Reader.reset();
    this->Modified();
    return 1;
  } catch (const std::exception& error) {
    vtkErrorMacro(<< error.what());
    return 0;
  }
}

void vtkPlenoflameFlameImport::Fill(vtkImageData* image) {
  namespace simulation = plenoflame::simulation;
  const int given =
      !this->AbsorptionArray.empty() + !this->SootArray.empty() + (this->ConstantAbsorption > 0);
  if (given != 1)
    throw UsageError(
        "absorption comes from exactly one of: an absorption array, a soot volume fraction, a "
        "constant above 0");
  if (this->TemperatureUnit != "K" && this->TemperatureUnit != "degC")
    throw UsageError("the unit of temperature '" + this->TemperatureUnit +
                     "' is unknown; there are K and degC");
  double to_per_metre = 1;
  if (this->AbsorptionUnit == "1/cm")
    to_per_metre = 100;
  else if (this->AbsorptionUnit == "1/mm")
    to_per_metre = 1000;
  else if (this->AbsorptionUnit != "1/m")
    throw UsageError("the unit of absorption '" + this->AbsorptionUnit +
                     "' is unknown; there are 1/m, 1/cm and 1/mm");
  if (!(this->LengthScale > 0) || !(this->VoxelSize >= 0) || !(this->SootFunction > 0) ||
      !(this->Wavelength > 0))
    throw UsageError("lengths, voxel size, E(m) and wavelength must be above 0");
  this->Open();
  const std::string path = this->FileName;
  const auto watcher = [this](double from, double to) {
    return [=, this](double part) {
      this->UpdateProgress(from + (to - from) * part);
      return this->GetAbortExecute() == 0;
    };
  };
  const auto parts = this->Internal->Reader->read(
      static_cast<std::size_t>(std::max(0, this->TimeStep)), watcher(0, 0.2));
  simulation::check_mesh(parts, path);
  std::array<double, 6> bounds = simulation::bounds_of(parts);  // in units of the mesh
  if (this->Bounds[0] < this->Bounds[1])
    for (std::size_t k = 0; k < 6; ++k) {
      const double wanted = this->Bounds[k] / this->LengthScale;
      bounds[k] = k % 2 == 0 ? std::max(bounds[k], wanted) : std::min(bounds[k], wanted);
    }
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(bounds[2 * k] < bounds[2 * k + 1]))
      throw InputError("'" + path + "': the bounds leave nothing of the mesh");
    longest = std::max(longest, bounds[2 * k + 1] - bounds[2 * k]);
  }
  constexpr int kMargin = 3;
  int size[3];
  double origin[3], spacing[3];
  double count = 1;
  auto* const own = parts.size() == 1 ? vtkImageData::SafeDownCast(parts.front()) : nullptr;
  // A lattice stays as it is, unless other voxels are requested.
  const bool keep = own && this->VoxelSize == 0 && !(this->Bounds[0] < this->Bounds[1]) &&
                    own->GetDirectionMatrix()->IsIdentity() &&
                    own->GetPointData()->HasArray(this->TemperatureArray.c_str());
  const double voxel = this->VoxelSize > 0 ? this->VoxelSize / this->LengthScale : longest / 128;
  for (int k = 0; k < 3; ++k) {
    const double low = bounds[static_cast<std::size_t>(2 * k)];
    const double side = bounds[static_cast<std::size_t>(2 * k + 1)] - low;
    // Otherwise samples stand in the middles of voxels that fill the bounds: interpolated between
    // them and the nothing beyond, the flame keeps its size.
    const double samples = keep ? own->GetDimensions()[k] : std::max(1.0, std::round(side / voxel));
    spacing[k] = keep ? own->GetSpacing()[k] : voxel;
    count *= samples + 2 * kMargin;
    if (count > 1e9)
      throw UsageError("voxels of that size would be more than 1e9; take larger ones or bounds");
    size[k] = static_cast<int>(samples) + 2 * kMargin;
    origin[k] = low + 0.5 * (side - (samples - 1) * spacing[k]) - kMargin * spacing[k];
  }
  vtkNew<vtkImageData> lattice;
  lattice->SetDimensions(size);
  lattice->SetSpacing(spacing);
  lattice->SetOrigin(origin);
  std::vector<float> temperature =
      simulation::sample(parts, this->TemperatureArray, *lattice, path, watcher(0.2, 0.6));
  const bool celsius = this->TemperatureUnit == "degC";
  bool any = false;
  for (float& value : temperature) {
    value = static_cast<float>(static_cast<double>(value) * this->TemperatureScale +
                               (celsius ? 273.15 : 0));
    any = any || !std::isnan(value);
    if (value < 0)
      throw InputError("'" + path + "': the array '" + this->TemperatureArray +
                       "' gives temperatures below 0 K; check its unit");
    if (std::isinf(value))
      throw InputError("'" + path + "': the array '" + this->TemperatureArray +
                       "' gives temperatures that single precision cannot hold");
  }
  if (!any) throw InputError("'" + path + "': no voxel lies inside of a cell; take smaller voxels");
  std::vector<float> absorption;
  if (this->ConstantAbsorption > 0) {
    absorption.assign(temperature.size(), 0);
    for (std::size_t i = 0; i < absorption.size(); ++i)
      if (!std::isnan(temperature[i])) absorption[i] = static_cast<float>(this->ConstantAbsorption);
  } else {
    const bool soot = !this->SootArray.empty();
    const std::string& name = soot ? this->SootArray : this->AbsorptionArray;
    const double factor =
        soot ? plenoflame::soot_absorption(1, this->SootFunction, this->Wavelength) : to_per_metre;
    absorption = simulation::sample(parts, name, *lattice, path, watcher(0.6, 0.95));
    for (float& value : absorption) {
      // Interpolation of higher order and solvers leave tiny negative values: they are none.
      value = std::isnan(value) ? 0 : static_cast<float>(factor * static_cast<double>(value));
      value = std::max(value, 0.0F);
      if (std::isinf(value))
        throw InputError("'" + path + "': the array '" + name +
                         "' gives absorption that single precision cannot hold");
    }
    drop_nothing(absorption, longest * this->LengthScale);
  }
  extend(temperature, size, kMargin);
  image->Initialize();
  image->SetDimensions(size);
  image->SetSpacing(spacing[0] * this->LengthScale, spacing[1] * this->LengthScale,
                    spacing[2] * this->LengthScale);
  image->SetOrigin(origin[0] * this->LengthScale, origin[1] * this->LengthScale,
                   origin[2] * this->LengthScale);
  const auto add = [&](const char* name, const std::vector<float>& values, float outside) {
    vtkNew<vtkFloatArray> array;
    array->SetName(name);
    array->SetNumberOfValues(static_cast<vtkIdType>(values.size()));
    std::replace_copy_if(
        values.begin(), values.end(), array->GetPointer(0), [](float v) { return std::isnan(v); },
        outside);
    image->GetPointData()->AddArray(array);
  };
  add("temperature", temperature, static_cast<float>(this->AmbientTemperature));
  add("absorption", absorption, 0);
  image->GetPointData()->SetActiveScalars("temperature");
}
