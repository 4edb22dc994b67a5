#include "vtkPlenoflameRayStream.h"

#include <vtkAOSDataArrayTemplate.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkTable.h>

#include <algorithm>
#include <string>
#include <type_traits>

#include "pipeline_run.h"
#include "ray_block_queue.h"
#include "vtkPlenoflameScene.h"

namespace pipeline = plenoflame::pipeline;

struct vtkPlenoflameRayStream::Internals {
  std::unique_ptr<pipeline::RayBlockQueue<float>> Single;
  std::unique_ptr<pipeline::RayBlockQueue<double>> Double;
};

namespace {

template <class T>
using ArrayOf =
    std::conditional_t<std::is_same_v<T, int>, vtkIntArray,
                       std::conditional_t<std::is_same_v<T, float>, vtkFloatArray, vtkDoubleArray>>;

/// Moves a column into the table.
template <class T>
void add_column(const char* name, pipeline::GrowingColumn<T>& column, vtkTable& table) {
  vtkNew<ArrayOf<T>> array;
  array->SetName(name);
  array->SetNumberOfComponents(column.components());
  const auto count = static_cast<vtkIdType>(column.rows()) * column.components();
  array->SetArray(column.release(), count, 0, vtkAbstractArray::VTK_DATA_ARRAY_DELETE);
  table.AddColumn(array);
}

void add_field(const char* name, const std::vector<int>& values, vtkTable& table) {
  vtkNew<vtkIntArray> array;
  array->SetName(name);
  for (const int value : values) array->InsertNextValue(value);
  table.GetFieldData()->AddArray(array);
}

template <class Real>
vtkTable* to_table(pipeline::RayTable<Real>& rays) {
  vtkTable* const table = vtkTable::New();
  add_column("pixel", rays.pixel, *table);
  add_column("microlens", rays.microlens, *table);
  add_column("type", rays.type, *table);
  add_column("replicate", rays.replicate, *table);
  add_column("status", rays.status, *table);
  add_column("ended_at", rays.ended_at, *table);
  add_column("etendue", rays.etendue, *table);
  add_column("sampled_etendue", rays.sampled_etendue, *table);
  add_column("origin", rays.origin, *table);
  add_column("direction", rays.direction, *table);
  add_column("t_near", rays.t_near, *table);
  add_column("t_far", rays.t_far, *table);
  if (!rays.channels.empty()) add_column("radiance", rays.radiance, *table);
  vtkNew<vtkDoubleArray> anchor;
  anchor->SetName("anchor");
  for (const double value : {rays.anchor.x, rays.anchor.y, rays.anchor.z})
    anchor->InsertNextValue(value);
  table->GetFieldData()->AddArray(anchor);
  add_field("tile", {rays.tile}, *table);
  add_field("path", {rays.path}, *table);
  add_field("channels", rays.channels, *table);
  return table;
}

}  // namespace

vtkStandardNewMacro(vtkPlenoflameRayStream);

vtkPlenoflameRayStream::vtkPlenoflameRayStream() : Internal(std::make_unique<Internals>()) {}

vtkPlenoflameRayStream::~vtkPlenoflameRayStream() = default;

void vtkPlenoflameRayStream::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Samples: " << this->Samples << "\n"
     << indent << "Seed: " << this->Seed << "\n"
     << indent << "Window: " << this->Window[0] << " " << this->Window[1] << " " << this->Window[2]
     << " " << this->Window[3] << "\n"
     << indent << "DoublePrecision: " << this->DoublePrecision << "\n"
     << indent << "Skip: " << this->Skip << "\n"
     << indent << "Radiance: " << this->Radiance << "\n"
     << indent << "RaysPerBlock: " << this->RaysPerBlock << "\n"
     << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
}

bool vtkPlenoflameRayStream::Start(vtkPlenoflameScene* scene) {
  this->Stop();
  return pipeline::run_here(*this, [&] {
    plenoflame::Execution execution;
    execution.threads = this->NumberOfThreads;
    execution.message = [&](plenoflame::Severity severity, const std::string& text) {
      if (severity == plenoflame::Severity::warning) pipeline::report_warning(*this, text);
    };
    const auto compiled = scene->Compile(execution);
    plenoflame::RenderSettings settings;
    settings.samples = this->Samples;
    settings.replicates = std::clamp(settings.samples, 1, settings.replicates);
    settings.seed =
        this->Seed >= 0 ? static_cast<std::uint64_t>(this->Seed) : compiled->scene.render.seed;
    if (this->Window[2] != 0)
      settings.window = {this->Window[0], this->Window[1], this->Window[2], this->Window[3]};
    settings.skip = this->Skip;
    const auto content = this->Radiance ? plenoflame::RayStreamContent::radiance
                                        : plenoflame::RayStreamContent::rays;
    const auto rays = static_cast<std::size_t>(this->RaysPerBlock);
    if (this->DoublePrecision)
      this->Internal->Double = std::make_unique<pipeline::RayBlockQueue<double>>(
          compiled, settings, this->NumberOfThreads, content, rays);
    else
      this->Internal->Single = std::make_unique<pipeline::RayBlockQueue<float>>(
          compiled, settings, this->NumberOfThreads, content, rays);
  });
}

vtkTable* vtkPlenoflameRayStream::Next() {
  vtkTable* table = nullptr;
  pipeline::run_here(*this, [&] {
    if (this->Internal->Double) {
      if (auto rays = this->Internal->Double->next()) table = to_table(*rays);
    } else if (this->Internal->Single) {
      if (auto rays = this->Internal->Single->next()) table = to_table(*rays);
    }
  });
  if (!table) this->Stop();
  return table;
}

bool vtkPlenoflameRayStream::IsReady() {
  if (this->Internal->Double) return this->Internal->Double->is_ready();
  return !this->Internal->Single || this->Internal->Single->is_ready();
}

void vtkPlenoflameRayStream::Stop() {
  this->Internal->Single.reset();
  this->Internal->Double.reset();
}
