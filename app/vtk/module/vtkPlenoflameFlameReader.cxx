#include "vtkPlenoflameFlameReader.h"

#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkMatrix4x4.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>

#include <vector>

#include "made_image.h"
#include "pipeline_run.h"
#include "plenoflame/volumes/flame_file.h"
#include "plenoflame/volumes/grid_file.h"
#include "voxel_image.h"

struct vtkPlenoflameFlameReader::Internals {
  plenoflame::pipeline::MadeImage Flame;
};

vtkStandardNewMacro(vtkPlenoflameFlameReader);

vtkPlenoflameFlameReader::vtkPlenoflameFlameReader() : Internal(std::make_unique<Internals>()) {
  this->SetNumberOfInputPorts(0);
}

vtkPlenoflameFlameReader::~vtkPlenoflameFlameReader() {
  this->SetFileName(nullptr);
}

void vtkPlenoflameFlameReader::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n"
     << indent << "GridName: " << this->GridName << "\n"
     << indent << "LocalFrame: " << this->LocalFrame << "\n"
     << indent << "LocalToWorld:\n";
  this->LocalToWorld->PrintSelf(os, indent.GetNextIndent());
}

vtkMatrix4x4* vtkPlenoflameFlameReader::GetLocalToWorld() {
  return this->LocalToWorld;
}

int vtkPlenoflameFlameReader::RequestInformation(vtkInformation*, vtkInformationVector**,
                                                 vtkInformationVector* outputs) {
  return this->Internal->Flame.announce(*this, *outputs->GetInformationObject(0),
                                        [this](vtkImageData& image) { return this->Make(image); });
}

int vtkPlenoflameFlameReader::RequestData(vtkInformation*, vtkInformationVector**,
                                          vtkInformationVector* outputs) {
  this->Internal->Flame.give(*outputs);
  return 1;
}

bool vtkPlenoflameFlameReader::Make(vtkImageData& image) {
  using namespace plenoflame;
  return plenoflame::pipeline::run(*this, 0, [&](const Execution& execution) {
    const std::string path = this->FileName ? this->FileName : "";
    std::vector<VoxelField> fields;
    if (this->GridName.empty())
      fields = read_flame_grids(path, execution);
    else
      fields.push_back(read_voxel_field(path, this->GridName));
    const LatticeFields found = on_one_lattice(fields, path, "SetGridName()", execution);
    pipeline::place_image(found.transform, found.box, this->LocalFrame, image);
    pipeline::local_to_world(found.transform, found.box, *this->LocalToWorld);
    for (const VoxelArray& array : found.arrays) pipeline::add_array(array, image);
    image.GetPointData()->SetActiveScalars(fields.front().name.c_str());
  });
}
