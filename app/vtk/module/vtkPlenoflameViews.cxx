#include "vtkPlenoflameViews.h"

#include <vtkCompositeDataSet.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkInformationVector.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>

#include <array>
#include <cstdio>

#include "light_field_camera.h"
#include "light_field_image.h"
#include "made_image.h"
#include "pipeline_run.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/lightfield/views.h"

struct vtkPlenoflameViews::Internals {
  plenoflame::pipeline::MicroImageCache MicroImages;
  vtkNew<vtkMultiBlockDataSet> Views;
  plenoflame::pipeline::MadeImage Sheet;
};

vtkStandardNewMacro(vtkPlenoflameViews);

vtkPlenoflameViews::vtkPlenoflameViews() : Internal(std::make_unique<Internals>()) {
  this->SetNumberOfOutputPorts(2);
}

vtkPlenoflameViews::~vtkPlenoflameViews() = default;

void vtkPlenoflameViews::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Grid: " << this->Grid << "\n"
     << indent << "Spread: " << this->Spread << "\n"
     << indent << "Resampling: " << this->Resampling << "\n"
     << indent << "WhiteCorrection: " << this->WhiteCorrection << "\n"
     << indent << "Channel: " << this->Channel << "\n"
     << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
}

int vtkPlenoflameViews::FillInputPortInformation(int, vtkInformation* information) {
  information->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

int vtkPlenoflameViews::FillOutputPortInformation(int port, vtkInformation* information) {
  information->Set(vtkDataObject::DATA_TYPE_NAME(),
                   port == 0 ? "vtkMultiBlockDataSet" : "vtkImageData");
  return 1;
}

int vtkPlenoflameViews::RequestInformation(vtkInformation*, vtkInformationVector**,
                                           vtkInformationVector* outputs) {
  return this->Internal->Sheet.announce(*this, *outputs->GetInformationObject(1),
                                        [this](vtkImageData& sheet) { return this->Make(sheet); });
}

vtkImageData* vtkPlenoflameViews::GetContactSheet() {
  return vtkImageData::SafeDownCast(this->GetOutputDataObject(1));
}

int vtkPlenoflameViews::RequestData(vtkInformation*, vtkInformationVector**,
                                    vtkInformationVector* outputs) {
  vtkMultiBlockDataSet::GetData(outputs, 0)->ShallowCopy(this->Internal->Views);
  this->Internal->Sheet.give(*outputs, 1);
  return 1;
}

bool vtkPlenoflameViews::Make(vtkImageData& sheet) {
  using plenoflame::ViewResampling;
  vtkImageData* const in = vtkImageData::SafeDownCast(this->GetInputDataObject(0, 0));
  vtkMultiBlockDataSet* const out = this->Internal->Views;
  out->Initialize();
  return plenoflame::pipeline::run(
      *this, this->NumberOfThreads, [&](const plenoflame::Execution& execution) {
        const plenoflame::LightField field = plenoflame::pipeline::image_to_light_field(*in);
        plenoflame::ViewSettings settings;
        settings.grid = this->Grid;
        settings.spread = this->Spread;
        constexpr std::array resamplings{ViewResampling::nearest, ViewResampling::barycentric,
                                         ViewResampling::paper9, ViewResampling::paper10};
        settings.resampling = resamplings[static_cast<std::size_t>(this->Resampling)];
        settings.white_correction = this->WhiteCorrection;
        settings.channel = this->Channel;
        const plenoflame::MicroImages& micro =
            this->Internal->MicroImages.get(plenoflame::taken_through(field), this->WhiteCorrection,
                                            plenoflame::part_of_progress(execution, 0, 0.5));
        const plenoflame::Views views = plenoflame::extract_views(
            field, micro, settings, plenoflame::part_of_progress(execution, 0.5, 0.5));
        const char* const name = this->WhiteCorrection ? "radiance" : "flux";
        unsigned block = 0;
        for (const plenoflame::View& view : views.views) {
          vtkNew<vtkImageData> image;
          plenoflame::pipeline::image_to_vtk(view.image, name, *image);
          std::array<char, 40> label{};
          std::snprintf(label.data(), label.size(), "view_%02d_%02d", view.row, view.column);
          out->SetBlock(block, image);
          out->GetMetaData(block++)->Set(vtkCompositeDataSet::NAME(), label.data());
        }
        plenoflame::pipeline::image_to_vtk(plenoflame::contact_sheet(views), name, sheet);
      });
}
