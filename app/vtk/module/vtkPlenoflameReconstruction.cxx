#include "vtkPlenoflameReconstruction.h"

#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "light_field_image.h"
#include "pipeline_run.h"
#include "plenoflame/base/error.h"
#include "reconstruction_task.h"
#include "voxel_image.h"
#include "vtkPlenoflameScene.h"

namespace pipeline = plenoflame::pipeline;

struct vtkPlenoflameReconstruction::Internals {
  plenoflame::ReconstructionTask Task;

  std::vector<plenoflame::ReconstructedField> fields() const {
    return Task.has_result() ? plenoflame::reconstructed_fields(Task.result())
                             : std::vector<plenoflame::ReconstructedField>();
  }
};

vtkStandardNewMacro(vtkPlenoflameReconstruction);

vtkPlenoflameReconstruction::vtkPlenoflameReconstruction()
    : Internal(std::make_unique<Internals>()) {
  this->SetNumberOfInputPorts(0);
}

vtkPlenoflameReconstruction::~vtkPlenoflameReconstruction() = default;

void vtkPlenoflameReconstruction::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Cameras: " << this->Internal->Task.cameras() << "\n"
     << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n"
     << indent << "Result: " << (this->HasResult() ? "yes" : "none") << "\n";
}

bool vtkPlenoflameReconstruction::SetOption(const std::string& name, const std::string& value) {
  return pipeline::run_here(*this, [&] {
    this->Internal->Task.set_option(name, value);
    this->Modified();
  });
}

void vtkPlenoflameReconstruction::AddCamera(vtkPlenoflameScene* scene, vtkImageData* picture,
                                            const std::string& name) {
  pipeline::run_here(*this, [&] {
    if (!scene || !picture) throw plenoflame::UsageError("a camera needs a scene and a picture");
    const vtkSmartPointer<vtkPlenoflameScene> kept = scene;
    this->Internal->Task.add_camera(
        [kept](const plenoflame::Execution& execution) {
          return kept->Compile(execution, {plenoflame::IssueCode::no_flame});
        },
        scene->GetCamera(), pipeline::image_to_light_field(*picture), name);
    this->Modified();
  });
}

bool vtkPlenoflameReconstruction::SetEarlierField(const std::string& use, const std::string& field,
                                                  vtkDoubleArray* values) {
  return pipeline::run_here(*this, [&] {
    if (!values) throw plenoflame::UsageError("there are no values of " + field);
    const double* const first = values->GetPointer(0);
    this->Internal->Task.set_earlier(
        use, field, std::vector<double>(first, first + values->GetNumberOfValues()));
    this->Modified();
  });
}

bool vtkPlenoflameReconstruction::HasResult() {
  return this->Internal->Task.has_result();
}

bool vtkPlenoflameReconstruction::IsComplete() {
  return this->HasResult() && this->Internal->Task.result().figures.complete;
}

std::string vtkPlenoflameReconstruction::GetFiguresAsJson() {
  return this->Internal->Task.report().json_text();
}

std::string vtkPlenoflameReconstruction::GetReport() {
  return this->Internal->Task.report_text();
}

int vtkPlenoflameReconstruction::GetShape(int axis) {
  return this->HasResult() && axis >= 0 && axis < 3
             ? this->Internal->Task.unknowns().shape()[static_cast<std::size_t>(axis)]
             : 0;
}

int vtkPlenoflameReconstruction::GetNumberOfFields() {
  return static_cast<int>(this->Internal->fields().size());
}

std::string vtkPlenoflameReconstruction::GetFieldName(int i) {
  const auto fields = this->Internal->fields();
  return i >= 0 && i < static_cast<int>(fields.size()) ? fields[static_cast<std::size_t>(i)].name
                                                       : "";
}

vtkDoubleArray* vtkPlenoflameReconstruction::GetField(int i) {
  const auto fields = this->Internal->fields();
  if (i < 0 || i >= static_cast<int>(fields.size())) return nullptr;
  const std::vector<double>& values = *fields[static_cast<std::size_t>(i)].values;
  vtkDoubleArray* const array = vtkDoubleArray::New();
  array->SetNumberOfValues(static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
}

vtkDoubleArray* vtkPlenoflameReconstruction::GetPlaces() {
  vtkDoubleArray* const places = vtkDoubleArray::New();
  places->SetNumberOfComponents(3);
  if (!this->HasResult()) return places;
  const plenoflame::Unknowns& unknowns = this->Internal->Task.unknowns();
  for (std::size_t j = 0; j < unknowns.size(); ++j) {
    const plenoflame::Vec3 p = unknowns.place(j);
    places->InsertNextTuple3(p.x, p.y, p.z);
  }
  return places;
}

int vtkPlenoflameReconstruction::GetNumberOfPictures() {
  return this->HasResult() ? static_cast<int>(this->Internal->Task.result().figures.residual.size())
                           : 0;
}

vtkImageData* vtkPlenoflameReconstruction::GetPicture(int i) {
  if (i < 0 || i >= this->GetNumberOfPictures()) return nullptr;
  const plenoflame::Reconstruction& figures = this->Internal->Task.result().figures;
  vtkImageData* const image = vtkImageData::New();
  pipeline::image_to_vtk(figures.residual[static_cast<std::size_t>(i)], "residual", *image);
  pipeline::add_image(figures.explained[static_cast<std::size_t>(i)], "explained", *image);
  return image;
}

bool vtkPlenoflameReconstruction::Write(const std::string& path) {
  return pipeline::run_here(*this, [&] { this->Internal->Task.write(path); });
}

int vtkPlenoflameReconstruction::RequestInformation(vtkInformation*, vtkInformationVector**,
                                                    vtkInformationVector* outputs) {
  // The size is known when the unknowns are.
  const std::array<int, 6> extent{0, 0, 0, 0, 0, 0};
  outputs->GetInformationObject(0)->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(),
                                        extent.data(), 6);
  return 1;
}

int vtkPlenoflameReconstruction::RequestData(vtkInformation*, vtkInformationVector**,
                                             vtkInformationVector* outputs) {
  vtkImageData* const image = vtkImageData::GetData(outputs);
  const bool ended =
      pipeline::run(*this, this->NumberOfThreads, [&](const plenoflame::Execution& execution) {
        const plenoflame::ReconstructionTask& task = this->Internal->Task;
        this->Internal->Task.run(execution);
        plenoflame::IndexBox box;
        const std::vector<plenoflame::VoxelField> fields = task.voxels(box);
        image->Initialize();
        if (box.empty()) return;
        pipeline::place_image(fields.front().index_to_world, box, false, *image);
        for (const plenoflame::VoxelField& field : fields)
          pipeline::add_array(plenoflame::voxel_values(field, box), *image);
        image->GetPointData()->SetActiveScalars("emission");
      });
  // Stopped before there was a result: there is none, and nothing went wrong.
  return ended || this->GetAbortExecute() ? 1 : 0;
}
