#include "vtkPlenoflameDevelop.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkUnsignedShortArray.h>

#include <algorithm>

#include "light_field_image.h"
#include "pipeline_run.h"
#include "plenoflame/lightfield/develop.h"

vtkStandardNewMacro(vtkPlenoflameDevelop);

void vtkPlenoflameDevelop::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Saturation: " << this->Saturation << "\n"
     << indent << "Bits: " << this->Bits << "\n"
     << indent << "Curve: " << this->Curve << "\n"
     << indent << "Channel: " << this->Channel << "\n"
     << indent << "UsedSaturation: " << this->UsedSaturation << "\n"
     << indent << "SaturatedShare: " << this->SaturatedShare << "\n";
}

int vtkPlenoflameDevelop::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                      vtkInformationVector* outputs) {
  vtkImageData* const in = vtkImageData::GetData(inputs[0]);
  vtkImageData* const out = vtkImageData::GetData(outputs);
  return plenoflame::pipeline::run_here(*this, [&] {
    const plenoflame::LightField field = plenoflame::pipeline::image_to_light_field(*in);
    plenoflame::DevelopSpec spec;
    spec.saturation = this->Saturation;
    spec.bits = this->Bits;
    spec.curve =
        this->Curve == LINEAR ? plenoflame::ToneCurve::linear : plenoflame::ToneCurve::display;
    const plenoflame::DevelopedImage developed = plenoflame::develop(field, spec, this->Channel);
    this->UsedSaturation = developed.saturation;
    this->SaturatedShare = developed.saturated_share;
    out->CopyStructure(in);
    vtkNew<vtkUnsignedShortArray> array;
    array->SetName("digital_number");
    const auto& samples = developed.picture.samples;
    array->SetNumberOfValues(static_cast<vtkIdType>(samples.size()));
    const auto width = static_cast<std::size_t>(developed.picture.width);
    const std::size_t height = samples.size() / width;
    for (std::size_t row = 0; row < height; ++row)
      std::copy_n(samples.data() + row * width, width,
                  array->GetPointer(0) + (height - 1 - row) * width);
    out->GetPointData()->SetScalars(array);
  });
}
