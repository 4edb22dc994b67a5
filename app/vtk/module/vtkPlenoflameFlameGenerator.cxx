#include "vtkPlenoflameFlameGenerator.h"

#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include <array>
#include <nlohmann/json.hpp>

#include "flame_image.h"
#include "pipeline_run.h"
#include "plenoflame/volumes/flame_generators.h"

vtkStandardNewMacro(vtkPlenoflameFlameGenerator);

vtkPlenoflameFlameGenerator::vtkPlenoflameFlameGenerator() {
  this->SetNumberOfInputPorts(0);
}

void vtkPlenoflameFlameGenerator::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FlameName: " << this->FlameName << "\n" << indent << "Parameters:";
  for (const auto& [name, value] : this->Parameters) os << " " << name << "=" << value;
  os << "\n";
}

void vtkPlenoflameFlameGenerator::SetParameter(const std::string& name, const std::string& value) {
  this->Parameters[name] = value;
  this->Modified();
}

void vtkPlenoflameFlameGenerator::RemoveAllParameters() {
  this->Parameters.clear();
  this->Modified();
}

std::string vtkPlenoflameFlameGenerator::GetGeneratorsAsJson() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const plenoflame::FlameGenerator& generator : plenoflame::flame_generators()) {
    nlohmann::ordered_json parameters = nlohmann::ordered_json::array();
    for (const plenoflame::FlameParameter& p : generator.parameters())
      parameters.push_back({{"name", p.name},
                            {"about", p.about},
                            {"value", p.value},
                            {"unit", plenoflame::si_unit(p.dimension)}});
    list.push_back(
        {{"name", generator.name}, {"what", generator.what}, {"parameters", parameters}});
  }
  return list.dump();
}

int vtkPlenoflameFlameGenerator::RequestInformation(vtkInformation*, vtkInformationVector**,
                                                    vtkInformationVector* outputs) {
  // The flame's size is known when it has been made.
  const std::array<int, 6> extent{0, 0, 0, 0, 0, 0};
  outputs->GetInformationObject(0)->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(),
                                        extent.data(), 6);
  return 1;
}

int vtkPlenoflameFlameGenerator::RequestData(vtkInformation*, vtkInformationVector**,
                                             vtkInformationVector* outputs) {
  using namespace plenoflame;
  vtkImageData* const image = vtkImageData::GetData(outputs);
  return pipeline::run(*this, 0, [&](const Execution& execution) {
    pipeline::flame_to_image(generate_flame(this->FlameName, this->Parameters, execution), *image);
  });
}
