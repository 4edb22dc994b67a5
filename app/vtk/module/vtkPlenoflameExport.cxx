#include "vtkPlenoflameExport.h"

#include <vtkImageData.h>
#include <vtkObjectFactory.h>

#include <algorithm>

#include "export_folder.h"
#include "light_field_image.h"
#include "pipeline_run.h"
#include "plenoflame/lightfield/export.h"

vtkStandardNewMacro(vtkPlenoflameExport);

namespace {

std::string item(const std::vector<std::string>& list, int i) {
  return i >= 0 && i < static_cast<int>(list.size()) ? list[static_cast<std::size_t>(i)] : "";
}

}  // namespace

vtkPlenoflameExport::vtkPlenoflameExport() {
  this->SetNumberOfOutputPorts(0);
}

void vtkPlenoflameExport::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Folder: " << this->Folder << "\n"
     << indent << "Format: " << this->Format << "\n"
     << indent << "Stem: " << this->Stem << "\n"
     << indent << "Channel: " << this->Channel << "\n"
     << indent << "Channels: " << this->Channels << "\n"
     << indent << "Grid: " << this->Grid << "\n";
}

int vtkPlenoflameExport::GetNumberOfFormats() {
  return static_cast<int>(plenoflame::export_formats().size());
}

std::string vtkPlenoflameExport::GetFormatName(int i) {
  const auto& formats = plenoflame::export_formats();
  return i >= 0 && i < GetNumberOfFormats() ? formats[static_cast<std::size_t>(i)].name : "";
}

int vtkPlenoflameExport::GetNumberOfFiles() {
  return static_cast<int>(this->Files.size());
}

std::string vtkPlenoflameExport::GetWrittenFile(int i) {
  return item(this->Files, i);
}

int vtkPlenoflameExport::GetNumberOfNotes() {
  return static_cast<int>(this->Notes.size());
}

std::string vtkPlenoflameExport::GetNote(int i) {
  return item(this->Notes, i);
}

int vtkPlenoflameExport::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                     vtkInformationVector*) {
  using namespace plenoflame;
  vtkImageData* const in = vtkImageData::GetData(inputs[0]);
  return pipeline::run(*this, 0, [&](const Execution& execution) {
    const LightField field = pipeline::image_to_light_field(*in);
    const ExportResult result = export_to_folder(
        field, {this->Format, this->Folder, this->Stem, this->Channel, this->Grid, this->Channels},
        execution);
    this->Files = result.files;
    this->Notes = result.notes;
  });
}
