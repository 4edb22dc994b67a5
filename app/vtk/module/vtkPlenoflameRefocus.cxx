#include "vtkPlenoflameRefocus.h"

#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkObjectFactory.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include <array>

#include "light_field_camera.h"
#include "light_field_image.h"
#include "made_image.h"
#include "pipeline_run.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/lightfield/refocus.h"

struct vtkPlenoflameRefocus::Internals {
  plenoflame::pipeline::MicroImageCache MicroImages;
  plenoflame::pipeline::MadeImage Picture;
};

vtkStandardNewMacro(vtkPlenoflameRefocus);

vtkPlenoflameRefocus::vtkPlenoflameRefocus() : Internal(std::make_unique<Internals>()) {}
vtkPlenoflameRefocus::~vtkPlenoflameRefocus() = default;

void vtkPlenoflameRefocus::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Depth: " << this->Depth << "\n"
     << indent << "Width: " << this->Width << "\n"
     << indent << "Aperture: " << this->Aperture << "\n"
     << indent << "Channel: " << this->Channel << "\n"
     << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n"
     << indent << "PixelSize: " << this->PixelSize << "\n"
     << indent << "Corner: " << this->Corner[0] << " " << this->Corner[1] << "\n";
}

int vtkPlenoflameRefocus::RequestInformation(vtkInformation*, vtkInformationVector**,
                                             vtkInformationVector* outputs) {
  return this->Internal->Picture.announce(
      *this, *outputs->GetInformationObject(0),
      [this](vtkImageData& picture) { return this->Make(picture); });
}

int vtkPlenoflameRefocus::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                              vtkInformationVector*) {
  // The whole light field, for any requested part of the picture.
  vtkInformation* const in = inputs[0]->GetInformationObject(0);
  std::array<int, 6> extent{};
  in->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent.data());
  in->Set(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), extent.data(), 6);
  return 1;
}

int vtkPlenoflameRefocus::RequestData(vtkInformation*, vtkInformationVector**,
                                      vtkInformationVector* outputs) {
  this->Internal->Picture.give(*outputs);
  return 1;
}

bool vtkPlenoflameRefocus::Make(vtkImageData& out) {
  vtkImageData* const in = vtkImageData::SafeDownCast(this->GetInputDataObject(0, 0));
  return plenoflame::pipeline::run(
      *this, this->NumberOfThreads, [&](const plenoflame::Execution& execution) {
        const plenoflame::LightField field = plenoflame::pipeline::image_to_light_field(*in);
        const plenoflame::TakenThrough optics = plenoflame::taken_through(field);
        plenoflame::check_refocus_depth(plenoflame::Camera(optics.camera), this->Depth);
        plenoflame::RefocusSettings settings;
        settings.depth = this->Depth;
        settings.width = this->Width;
        settings.aperture = this->Aperture;
        settings.channel = this->Channel;
        const plenoflame::MicroImages& micro = this->Internal->MicroImages.get(
            optics, true, plenoflame::part_of_progress(execution, 0, 0.5));
        const plenoflame::RefocusedImage picture = plenoflame::refocus(
            field, micro, settings, plenoflame::part_of_progress(execution, 0.5, 0.5));
        this->PixelSize = picture.pixel;
        this->Corner[0] = picture.corner.x;
        this->Corner[1] = picture.corner.y;
        plenoflame::pipeline::image_to_vtk(picture.image, "radiance", out);
      });
}
