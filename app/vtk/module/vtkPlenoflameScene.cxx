#include "vtkPlenoflameScene.h"

#include <vtkObjectFactory.h>

#include <utility>

#include "design_json.h"
#include "pipeline_run.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/scene_schema.h"
#include "plenoflame/scene/validate.h"
#include "plenoflame/volumes/flame_file.h"

using plenoflame::pipeline::report_error;
using plenoflame::pipeline::report_warning;
using plenoflame::pipeline::run_here;

struct vtkPlenoflameScene::Internals {
  plenoflame::SceneDocument Document;
  std::shared_ptr<const plenoflame::CompiledScene> Compiled;
  vtkMTimeType CompiledOf = 0;  ///< modified time that Compiled belongs to
};

vtkStandardNewMacro(vtkPlenoflameScene);

vtkPlenoflameScene::vtkPlenoflameScene() : Internal(std::make_unique<Internals>()) {}
vtkPlenoflameScene::~vtkPlenoflameScene() = default;

void vtkPlenoflameScene::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  const plenoflame::Scene& scene = this->GetScene();
  os << indent << "File: " << (scene.file.empty() ? "(none)" : scene.file) << "\n";
  os << indent << "Sensor: " << scene.camera.sensor.columns << " x " << scene.camera.sensor.rows
     << "\n";
  os << indent << "Flames: " << scene.flames.size() << "\n";
  os << indent << "Channels: " << scene.channels.size() << "\n";
}

bool vtkPlenoflameScene::ReadFile(const std::string& path) {
  return run_here(*this, [&] {
    plenoflame::SceneDocument document = plenoflame::read_scene_file(path);
    plenoflame::validate(document);
    this->Internal->Document = std::move(document);
    this->Modified();
  });
}

bool vtkPlenoflameScene::ReadText(const std::string& text, const std::string& name) {
  return run_here(*this, [&] {
    plenoflame::SceneDocument document = plenoflame::parse_scene(text, name);
    plenoflame::validate(document);
    this->Internal->Document = std::move(document);
    this->Modified();
  });
}

std::string vtkPlenoflameScene::GetText() {
  std::string text;
  run_here(*this, [&] { text = plenoflame::write_scene(this->GetScene()); });
  return text;
}

bool vtkPlenoflameScene::WriteFile(const std::string& path) {
  return run_here(*this, [&] { plenoflame::write_scene_file(path, this->GetScene()); });
}

std::string vtkPlenoflameScene::GetValue(const std::string& path) {
  std::string text;
  run_here(*this, [&] { text = plenoflame::get_text(this->GetScene(), path); });
  return text;
}

bool vtkPlenoflameScene::SetValue(const std::string& path, const std::string& text) {
  return run_here(*this, [&] {
    plenoflame::set_text(this->Internal->Document.scene, path, text);
    this->Modified();
  });
}

int vtkPlenoflameScene::GetNumberOfPaths() {
  return static_cast<int>(plenoflame::scene_paths(this->GetScene()).size());
}

std::string vtkPlenoflameScene::GetPath(int i) {
  const auto paths = plenoflame::scene_paths(this->GetScene());
  return i >= 0 && i < static_cast<int>(paths.size()) ? paths[static_cast<std::size_t>(i)] : "";
}

int vtkPlenoflameScene::GetListSize(const std::string& path) {
  int size = -1;
  run_here(*this, [&] { size = static_cast<int>(plenoflame::list_size(this->GetScene(), path)); });
  return size;
}

bool vtkPlenoflameScene::InsertListItem(const std::string& path, int position) {
  return run_here(*this, [&] {
    // A negative place becomes one that is too large, and its message says what there is.
    plenoflame::insert_item(this->Internal->Document.scene, path,
                            static_cast<std::size_t>(position));
    this->Modified();
  });
}

bool vtkPlenoflameScene::RemoveListItem(const std::string& path, int position) {
  return run_here(*this, [&] {
    plenoflame::erase_item(this->Internal->Document.scene, path,
                           static_cast<std::size_t>(position));
    this->Modified();
  });
}

bool vtkPlenoflameScene::Validate() {
  return run_here(*this, [&] {
    for (const auto& issue : plenoflame::validate(this->Internal->Document))
      report_warning(*this, plenoflame::to_string(issue));
  });
}

std::string vtkPlenoflameScene::GetDesignAsJson() {
  std::string text;
  run_here(*this, [&] {
    plenoflame::validate(this->Internal->Document);
    text = plenoflame::pipeline::design_json(this->GetScene());
  });
  return text;
}

int vtkPlenoflameScene::GetNumberOfColumns() {
  return this->GetScene().camera.sensor.columns;
}
int vtkPlenoflameScene::GetNumberOfRows() {
  return this->GetScene().camera.sensor.rows;
}
double vtkPlenoflameScene::GetPixelPitch() {
  return this->GetScene().camera.sensor.pixel_pitch;
}

int vtkPlenoflameScene::GetNumberOfChannels() {
  return static_cast<int>(this->GetScene().channels.size());
}

std::string vtkPlenoflameScene::GetChannelName(int i) {
  const auto& channels = this->GetScene().channels;
  return i >= 0 && i < static_cast<int>(channels.size())
             ? channels[static_cast<std::size_t>(i)].name
             : "";
}

void vtkPlenoflameScene::Initialize() {
  this->Superclass::Initialize();
  *this->Internal = {};
}

void vtkPlenoflameScene::ShallowCopy(vtkDataObject* source) {
  this->Superclass::ShallowCopy(source);
  if (auto* scene = vtkPlenoflameScene::SafeDownCast(source); scene && scene != this) {
    this->Internal->Document = scene->Internal->Document;
    this->Modified();
  }
}

void vtkPlenoflameScene::DeepCopy(vtkDataObject* source) {
  this->Superclass::DeepCopy(source);
  if (auto* scene = vtkPlenoflameScene::SafeDownCast(source); scene && scene != this) {
    this->Internal->Document = scene->Internal->Document;
    this->Modified();
  }
}

unsigned long vtkPlenoflameScene::GetActualMemorySize() {
  return this->Superclass::GetActualMemorySize() + 1;  // KiB
}

const plenoflame::Scene& vtkPlenoflameScene::GetScene() const {
  return this->Internal->Document.scene;
}

void vtkPlenoflameScene::SetScene(const plenoflame::Scene& scene) {
  this->Internal->Document = {scene, {}};
  this->Modified();
}

void vtkPlenoflameScene::SetDocument(const plenoflame::SceneDocument& document) {
  this->Internal->Document = document;
  this->Modified();
}

std::shared_ptr<const plenoflame::CompiledScene> vtkPlenoflameScene::Compile(
    const plenoflame::Execution& execution) {
  Internals& in = *this->Internal;
  if (!in.Compiled || in.CompiledOf != this->GetMTime()) {
    const auto load = [](const plenoflame::FlameSpec& flame, const std::string& folder,
                         const std::vector<plenoflame::SourceFunction>& channels,
                         const plenoflame::Execution& run) {
      return flame.kind == plenoflame::FlameKind::vdb
                 ? plenoflame::load_flame(flame, folder, channels, run)
                 : plenoflame::load_core_medium(flame, folder, channels, run);
    };
    in.Compiled = std::make_shared<const plenoflame::CompiledScene>(
        plenoflame::compile(in.Document.scene, load, execution, in.Document.positions));
    in.CompiledOf = this->GetMTime();
  }
  return in.Compiled;
}
