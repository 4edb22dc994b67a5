#include "scene_algorithm.h"

#include <vtkAlgorithm.h>
#include <vtkDataObject.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>

#include "vtkPlenoflameScene.h"

namespace plenoflame::pipeline {

void want_scene(vtkInformation& port) {
  port.Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPlenoflameScene");
}

vtkPlenoflameScene* scene_of(vtkInformationVector** inputs) {
  vtkInformation* const information = inputs[0]->GetInformationObject(0);
  return information
             ? vtkPlenoflameScene::SafeDownCast(information->Get(vtkDataObject::DATA_OBJECT()))
             : nullptr;
}

}  // namespace plenoflame::pipeline
