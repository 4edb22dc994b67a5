#include "made_image.h"

#include <vtkAlgorithm.h>
#include <vtkAlgorithmOutput.h>
#include <vtkDataObject.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include <algorithm>

namespace plenoflame::pipeline {

MadeImage::MadeImage() = default;
MadeImage::~MadeImage() = default;

int MadeImage::announce(vtkAlgorithm& algorithm, vtkInformation& port,
                        const std::function<bool(vtkImageData&)>& make) {
  vtkMTimeType time = algorithm.GetMTime();
  if (algorithm.GetNumberOfInputPorts() > 0) {
    vtkAlgorithmOutput* const from = algorithm.GetInputConnection(0, 0);
    from->GetProducer()->Update(from->GetIndex());
    time = std::max(time, algorithm.GetInputDataObject(0, 0)->GetMTime());
  }
  if (time != time_) {
    time_ = 0;
    image_->Initialize();
    if (!make(*image_)) return 0;
    time_ = time;
  }
  port.Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), image_->GetExtent(), 6);
  port.Set(vtkDataObject::ORIGIN(), image_->GetOrigin(), 3);
  port.Set(vtkDataObject::SPACING(), image_->GetSpacing(), 3);
  vtkDataObject::SetPointDataActiveScalarInfo(&port, VTK_FLOAT, 1);
  return 1;
}

void MadeImage::give(vtkInformationVector& outputs, int port) {
  vtkImageData::GetData(&outputs, port)->ShallowCopy(image_);
}

}  // namespace plenoflame::pipeline
