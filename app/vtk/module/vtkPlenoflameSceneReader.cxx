#include "vtkPlenoflameSceneReader.h"

#include <vtkDemandDrivenPipeline.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>

#include "pipeline_run.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/validate.h"
#include "vtkPlenoflameScene.h"

vtkStandardNewMacro(vtkPlenoflameSceneReader);

vtkPlenoflameSceneReader::vtkPlenoflameSceneReader() {
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(1);
}

vtkPlenoflameSceneReader::~vtkPlenoflameSceneReader() {
  this->SetFileName(nullptr);
}

void vtkPlenoflameSceneReader::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
}

vtkPlenoflameScene* vtkPlenoflameSceneReader::GetOutput() {
  return vtkPlenoflameScene::SafeDownCast(this->GetOutputDataObject(0));
}

int vtkPlenoflameSceneReader::FillOutputPortInformation(int, vtkInformation* information) {
  information->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkPlenoflameScene");
  return 1;
}

vtkTypeBool vtkPlenoflameSceneReader::ProcessRequest(vtkInformation* request,
                                                     vtkInformationVector** inputs,
                                                     vtkInformationVector* outputs) {
  vtkInformation* const information = outputs->GetInformationObject(0);
  vtkDataObject* const held = information->Get(vtkDataObject::DATA_OBJECT());
  if (request->Has(vtkDemandDrivenPipeline::REQUEST_DATA_OBJECT())) {
    // VTK makes only its own kinds of data by name.
    if (!vtkPlenoflameScene::SafeDownCast(held)) {
      vtkNew<vtkPlenoflameScene> scene;
      information->Set(vtkDataObject::DATA_OBJECT(), scene);
    }
    return 1;
  }
  // With the information already, since the sensor's size is the extent of images to come.
  if (request->Has(vtkDemandDrivenPipeline::REQUEST_INFORMATION()) ||
      request->Has(vtkDemandDrivenPipeline::REQUEST_DATA())) {
    auto* const scene = vtkPlenoflameScene::SafeDownCast(held);
    return plenoflame::pipeline::run_here(*this, [&] {
      const std::string path = this->FileName ? this->FileName : "";
      const plenoflame::SceneDocument document = plenoflame::read_scene_file(path);
      plenoflame::validate(document);
      scene->SetDocument(document);
    });
  }
  return this->Superclass::ProcessRequest(request, inputs, outputs);
}
