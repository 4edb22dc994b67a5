#include "vtkPlenoflameScene.h"

#include <vtkImageData.h>
#include <vtkObjectFactory.h>

#include <mutex>
#include <utility>

#include "flame_image.h"
#include "pipeline_run.h"
#include "plenoflame/base/error.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/scene_schema.h"
#include "plenoflame/scene/validate.h"
#include "plenoflame/volumes/scene_session.h"

using plenoflame::pipeline::report_error;
using plenoflame::pipeline::report_warning;
using plenoflame::pipeline::run_here;

struct vtkPlenoflameScene::Internals {
  plenoflame::SceneSession Session;
  std::mutex Compiling;
  vtkMTimeType CompiledOf = 0;  ///< modified time that the session's compiled scenes belong to
};

vtkStandardNewMacro(vtkPlenoflameScene);

vtkPlenoflameScene::vtkPlenoflameScene() : Internal(std::make_unique<Internals>()) {}
vtkPlenoflameScene::~vtkPlenoflameScene() = default;

void vtkPlenoflameScene::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  const plenoflame::Scene& scene = this->GetScene();
  os << indent << "File: " << (scene.file.empty() ? "(none)" : scene.file) << "\n";
  os << indent << "Camera: " << this->Internal->Session.camera() << "\n";
  if (scene.cameras.empty())
    os << indent << "Sensor: " << scene.camera.sensor.columns << " x " << scene.camera.sensor.rows
       << "\n";
  for (const plenoflame::CameraSpec& camera : scene.cameras)
    os << indent << "Sensor of " << camera.name << ": " << camera.sensor.columns << " x "
       << camera.sensor.rows << "\n";
  os << indent << "Flames: " << scene.flames.size() << "\n";
  os << indent << "Channels: " << scene.channels.size() << "\n";
}

bool vtkPlenoflameScene::ReadFile(const std::string& path) {
  return run_here(*this, [&] {
    this->Internal->Session.read_file(path);
    this->Modified();
  });
}

bool vtkPlenoflameScene::ReadText(const std::string& text, const std::string& name) {
  return run_here(*this, [&] {
    this->Internal->Session.read_text(text, name);
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
    plenoflame::set_text(this->Internal->Session.change(), path, text);
    this->Modified();
  });
}

bool vtkPlenoflameScene::SetFlameImage(const std::string& name, vtkImageData* image,
                                       double ambient_temperature) {
  return run_here(*this, [&] {
    if (!image) throw plenoflame::UsageError("there is no image to take the flame from");
    this->Internal->Session.set_flame(
        name, plenoflame::pipeline::image_to_flame(*image, "temperature", "absorption",
                                                   ambient_temperature, {}));
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
    plenoflame::insert_item(this->Internal->Session.change(), path,
                            static_cast<std::size_t>(position));
    this->Modified();
  });
}

bool vtkPlenoflameScene::RemoveListItem(const std::string& path, int position) {
  return run_here(*this, [&] {
    plenoflame::erase_item(this->Internal->Session.change(), path,
                           static_cast<std::size_t>(position));
    this->Modified();
  });
}

bool vtkPlenoflameScene::Validate() {
  return run_here(*this, [&] {
    for (const auto& issue : plenoflame::validate(this->Internal->Session.document()))
      report_warning(*this, plenoflame::to_string(issue));
  });
}

int vtkPlenoflameScene::GetNumberOfCameras() {
  return static_cast<int>(plenoflame::camera_names(this->GetScene()).size());
}

std::string vtkPlenoflameScene::GetCameraName(int i) {
  const auto names = plenoflame::camera_names(this->GetScene());
  return i >= 0 && i < static_cast<int>(names.size()) ? names[static_cast<std::size_t>(i)] : "";
}

bool vtkPlenoflameScene::SetCamera(const std::string& name) {
  return run_here(*this, [&] {
    Internals& in = *this->Internal;
    const bool same = in.Session.camera() == name;
    in.Session.set_camera(name);
    if (same) return;
    const std::lock_guard lock(in.Compiling);
    const bool up_to_date = in.CompiledOf == this->GetMTime();
    this->Modified();
    if (up_to_date) in.CompiledOf = this->GetMTime();
  });
}

std::string vtkPlenoflameScene::GetCamera() {
  return this->Internal->Session.camera();
}

int vtkPlenoflameScene::GetFirstFrame() {
  int first = 0;
  run_here(*this, [&] { first = this->Internal->Session.frames().first; });
  return first;
}

int vtkPlenoflameScene::GetLastFrame() {
  int last = -1;
  run_here(*this, [&] { last = this->Internal->Session.frames().second; });
  return last;
}

bool vtkPlenoflameScene::MoveToTime(double time) {
  return run_here(*this, [&] {
    this->Internal->Session.move_to_time(time);
    this->Modified();
  });
}

bool vtkPlenoflameScene::MoveToFrame(int frame) {
  return run_here(*this, [&] {
    this->Internal->Session.move_to_frame(frame);
    this->Modified();
  });
}

int vtkPlenoflameScene::GetNumberOfColumns() {
  int columns = 0;
  run_here(*this, [&] { columns = this->GetSceneOfCamera().camera.sensor.columns; });
  return columns;
}
int vtkPlenoflameScene::GetNumberOfRows() {
  int rows = 0;
  run_here(*this, [&] { rows = this->GetSceneOfCamera().camera.sensor.rows; });
  return rows;
}
double vtkPlenoflameScene::GetPixelPitch() {
  double pitch = 0;
  run_here(*this, [&] { pitch = this->GetSceneOfCamera().camera.sensor.pixel_pitch; });
  return pitch;
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
  this->Internal = std::make_unique<Internals>();
}

void vtkPlenoflameScene::ShallowCopy(vtkDataObject* source) {
  this->Superclass::ShallowCopy(source);
  if (auto* scene = vtkPlenoflameScene::SafeDownCast(source); scene && scene != this) {
    this->Internal->Session = scene->Internal->Session;
    this->Modified();
  }
}

void vtkPlenoflameScene::DeepCopy(vtkDataObject* source) {
  this->Superclass::DeepCopy(source);
  if (auto* scene = vtkPlenoflameScene::SafeDownCast(source); scene && scene != this) {
    this->Internal->Session = scene->Internal->Session;
    this->Modified();
  }
}

unsigned long vtkPlenoflameScene::GetActualMemorySize() {
  return this->Superclass::GetActualMemorySize() + 1;  // KiB
}

const plenoflame::Scene& vtkPlenoflameScene::GetScene() const {
  return this->Internal->Session.scene();
}

plenoflame::Scene vtkPlenoflameScene::GetSceneOfCamera() const {
  return this->Internal->Session.scene_of_camera();
}

void vtkPlenoflameScene::SetScene(const plenoflame::Scene& scene) {
  this->Internal->Session.set_document({scene, {}});
  this->Modified();
}

void vtkPlenoflameScene::SetDocument(const plenoflame::SceneDocument& document) {
  this->Internal->Session.set_document(document);
  this->Modified();
}

std::shared_ptr<const plenoflame::CompiledScene> vtkPlenoflameScene::Compile(
    const plenoflame::Execution& execution, const std::vector<plenoflame::IssueCode>& unsaid) {
  Internals& in = *this->Internal;
  {
    const std::lock_guard lock(in.Compiling);
    const vtkMTimeType time = this->GetMTime();
    if (in.CompiledOf != time) in.Session.forget();
    in.CompiledOf = time;
  }
  return in.Session.compile(execution, unsaid);
}
