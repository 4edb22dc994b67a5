#include "vtkPlenoflameScenePicture.h"

#include <vtkAutoInit.h>
#include <vtkBoundingBox.h>
#include <vtkCamera.h>
#include <vtkCellData.h>
#include <vtkColorTransferFunction.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPNGWriter.h>
#include <vtkPolyData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVolume.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <array>
#include <exception>
#include <memory>
#include <set>
#include <utility>

#include "display.h"
#include "flame_volume.h"
#include "picture_annotation.h"
#include "picture_camera.h"
#include "pipeline_run.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/scene/scene.h"
#include "scene_props.h"
#include "surface_props.h"
#include "vtkPlenoflameCameraSource.h"
#include "vtkPlenoflameFlameSource.h"
#include "vtkPlenoflameScene.h"
#include "window_props.h"

VTK_MODULE_INIT(vtkRenderingOpenGL2);
VTK_MODULE_INIT(vtkRenderingFreeType);
VTK_MODULE_INIT(vtkRenderingVolumeOpenGL2);

using plenoflame::Vec3;

vtkStandardNewMacro(vtkPlenoflameScenePicture);

vtkPlenoflameScenePicture::vtkPlenoflameScenePicture() = default;
vtkPlenoflameScenePicture::~vtkPlenoflameScenePicture() = default;

void vtkPlenoflameScenePicture::PrintSelf(ostream& os, vtkIndent indent) {
  this->Superclass::PrintSelf(os, indent);
  os << indent << "View: " << this->View << "\n"
     << indent << "RayColoring: " << this->RayColoring << "\n"
     << indent << "Pixel: " << this->Pixel[0] << " " << this->Pixel[1] << "\n"
     << indent << "Size: " << this->Size[0] << " " << this->Size[1] << "\n"
     << indent << "FlameResolution: " << this->FlameResolution << "\n"
     << indent << "ShowFlame: " << this->ShowFlame << "\n"
     << indent << "ShowSurfaces: " << this->ShowSurfaces << "\n"
     << indent << "ShowInsets: " << this->ShowInsets << "\n"
     << indent << "ShowAxes: " << this->ShowAxes << "\n"
     << indent << "Scene: " << this->Scene << "\n"
     << indent << "Rays: " << this->Rays << "\n"
     << indent << "SensorImage: " << this->SensorImage << "\n";
}

void vtkPlenoflameScenePicture::SetScene(vtkPlenoflameScene* scene) {
  this->Scene = scene;
  this->Modified();
}
vtkPlenoflameScene* vtkPlenoflameScenePicture::GetScene() {
  return this->Scene;
}
void vtkPlenoflameScenePicture::SetRays(vtkPolyData* rays) {
  this->Rays = rays;
  this->Modified();
}
vtkPolyData* vtkPlenoflameScenePicture::GetRays() {
  return this->Rays;
}
void vtkPlenoflameScenePicture::SetSensorImage(vtkImageData* image) {
  this->SensorImage = image;
  this->Modified();
}
vtkImageData* vtkPlenoflameScenePicture::GetSensorImage() {
  return this->SensorImage;
}

bool vtkPlenoflameScenePicture::CanRender() {
  return plenoflame::views::DisplayConnection().why_not().empty();
}
std::string vtkPlenoflameScenePicture::GetWhyNot() {
  return plenoflame::views::DisplayConnection().why_not();
}

vtkSmartPointer<vtkImageData> vtkPlenoflameScenePicture::Flame() {
  if (!this->ShowFlame || this->Scene->GetListSize("flames") < 1) return nullptr;
  vtkNew<vtkPlenoflameFlameSource> source;
  source->SetInputDataObject(this->OfCamera);
  source->SetResolution(this->FlameResolution);
  source->Update();
  return source->GetOutput()->GetNumberOfPoints() > 0 ? source->GetOutput() : nullptr;
}

namespace {

Vec3 middle_of(const std::array<double, 6>& b) {
  return {0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3]), 0.5 * (b[4] + b[5])};
}

/// Names of the rays on the picture, in their colours.
std::vector<plenoflame::views::LegendEntry> legend_of(vtkPolyData& rays, bool by_status,
                                                      const plenoflame::Scene& scene) {
  std::vector<plenoflame::views::LegendEntry> entries;
  vtkDataArray* const values = rays.GetCellData()->GetArray(by_status ? "status" : "type");
  if (!values) return entries;
  std::set<int> present;
  for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i)
    present.insert(static_cast<int>(values->GetTuple1(i)));
  const std::array<const char*, 4> statuses{"reached", "vignetted", "total internal reflection",
                                            "missed a surface"};
  for (const int value : present) {
    plenoflame::views::LegendEntry entry;
    if (by_status) {
      entry.text =
          std::string("rays: ") + statuses[static_cast<std::size_t>(std::clamp(value, 0, 3))];
      plenoflame::views::status_colour(value, entry.rgb);
    } else {
      const auto& types = scene.camera.array.types;
      const bool known = value >= 0 && static_cast<std::size_t>(value) < types.size();
      entry.text = known ? "rays through " + types[static_cast<std::size_t>(value)].name
                         : "rays through no microlens";
      vtkPlenoflameCameraSource::GetTypeColor(value, entry.rgb);
    }
    entries.push_back(entry);
  }
  return entries;
}

}  // namespace

/// The solid surfaces, when they are to be shown; null after an error event.
std::unique_ptr<plenoflame::views::SolidSurfaces> vtkPlenoflameScenePicture::Surfaces(
    vtkImageData* flame) {
  auto surfaces = std::make_unique<plenoflame::views::SolidSurfaces>();
  if (!this->ShowSurfaces) return surfaces;
  const plenoflame::Scene& scene = this->Scene->GetScene();
  vtkBoundingBox others;
  const auto add_place = [&](const plenoflame::CameraSpec& camera) {
    others.AddPoint(camera.position.x, camera.position.y, camera.position.z);
  };
  if (scene.cameras.empty()) add_place(scene.camera);
  for (const plenoflame::CameraSpec& camera : scene.cameras) add_place(camera);
  if (flame) others.AddBounds(flame->GetBounds());
  const bool good = plenoflame::pipeline::run_here(
      *this, [&] { *surfaces = plenoflame::views::solid_surfaces(scene, others); });
  return good ? std::move(surfaces) : nullptr;
}

/// The cameras beside the chosen one, and the names of all.
/// @param points gets what has to be in the picture of them
bool vtkPlenoflameScenePicture::AddOtherCameras(vtkRenderer* renderer, int font_size,
                                                std::vector<Vec3>& points) {
  namespace views = plenoflame::views;
  using Source = vtkPlenoflameCameraSource;
  const std::string chosen = this->OfCamera->GetSceneOfCamera().camera.name;
  const plenoflame::Scene& scene = this->Scene->GetScene();
  for (const plenoflame::CameraSpec& camera : scene.cameras) {
    const double side = camera.lens.surfaces.empty() ? 0.5 * camera.lens.diameter
                                                     : 0.5 * camera.lens.surfaces.front().diameter;
    const Vec3 top = camera.position + 1.5 * side * plenoflame::normalize(camera.up);
    views::add_label(camera.name, top, font_size, *renderer);
    points.push_back(top);
    if (camera.name == chosen) continue;
    vtkNew<vtkPlenoflameScene> other;
    other->DeepCopy(this->Scene);
    other->SetCamera(camera.name);
    vtkNew<Source> source;
    source->SetInputDataObject(other);
    source->SetLevelOfDetail(Source::PLATE);
    source->Update();
    vtkMultiBlockDataSet* const parts = source->GetOutput();
    if (parts->GetNumberOfBlocks() == 0) return false;  // after an error event of the source
    views::add_camera(*parts, source->GetPlateTexture(), 0.4, *renderer);
    vtkBoundingBox box;
    for (unsigned block = 0; block < parts->GetNumberOfBlocks(); ++block)
      if (auto* data = vtkPolyData::SafeDownCast(parts->GetBlock(block));
          data && data->GetNumberOfPoints() > 0)
        box.AddBounds(data->GetBounds());
    std::array<double, 6> bounds{};
    box.GetBounds(bounds.data());
    const auto corners = views::corners(bounds);
    points.insert(points.end(), corners.begin(), corners.end());
  }
  return true;
}

/// The scene with a camera chosen: its own choice, or the first.
vtkSmartPointer<vtkPlenoflameScene> vtkPlenoflameScenePicture::WithCamera() {
  if (this->Scene->GetNumberOfCameras() == 1 || !this->Scene->GetCamera().empty())
    return this->Scene;
  const auto scene = vtkSmartPointer<vtkPlenoflameScene>::New();
  scene->DeepCopy(this->Scene);
  scene->SetCamera(this->Scene->GetCameraName(0));
  return scene;
}

bool vtkPlenoflameScenePicture::AddView(vtkRenderer* renderer, int view, bool inset,
                                        vtkImageData* flame,
                                        const plenoflame::views::SolidSurfaces& surfaces) {
  namespace views = plenoflame::views;
  const plenoflame::Scene scene = this->OfCamera->GetSceneOfCamera();
  const plenoflame::CameraSpec& spec = scene.camera;
  const Vec3 axis = plenoflame::normalize(spec.look_direction);
  const Vec3 right = plenoflame::normalize(plenoflame::cross(axis, spec.up));
  const Vec3 up = plenoflame::cross(right, axis);

  vtkNew<vtkPlenoflameCameraSource> source;
  source->SetInputDataObject(this->OfCamera);
  const bool close = view == ARRAY;
  // The pixel in the middle of the close-up, and a window of a few microlenses around it.
  std::array<int, 2> pixel{spec.sensor.columns / 2, spec.sensor.rows / 2};
  if (this->Pixel[0] >= 0) {
    pixel = {this->Pixel[0], this->Pixel[1]};
  } else if (this->Rays) {
    vtkDataArray* const pixels = this->Rays->GetCellData()->GetArray("pixel");
    if (pixels && pixels->GetNumberOfTuples() > 0 && pixels->GetComponent(0, 0) >= 0)
      pixel = {static_cast<int>(pixels->GetComponent(0, 0)),
               static_cast<int>(pixels->GetComponent(0, 1))};
  }
  const bool array = spec.array.present;
  const bool scene_has_several = this->Scene->GetNumberOfCameras() > 1;
  const double pitch = array ? spec.array.pitch : 10 * spec.sensor.pixel_pitch;
  const int span = std::max(4, static_cast<int>(5 * pitch / spec.sensor.pixel_pitch));
  if (close && array) {
    source->SetLevelOfDetail(vtkPlenoflameCameraSource::WINDOW);
    source->SetWindow(pixel[0] - span / 2, pixel[1] - span / 2, span, span);
    source->SetMicrolensResolution(32);
  } else if (inset) {
    source->SetLevelOfDetail(vtkPlenoflameCameraSource::PLATE);
  }
  source->Update();
  vtkMultiBlockDataSet* const camera = source->GetOutput();
  const auto bounds_of = [&](std::initializer_list<unsigned> blocks) {
    vtkBoundingBox box;
    for (const unsigned block : blocks)
      if (auto* data = vtkPolyData::SafeDownCast(camera->GetBlock(block));
          data && data->GetNumberOfPoints() > 0)
        box.AddBounds(data->GetBounds());
    std::array<double, 6> bounds{};
    box.GetBounds(bounds.data());
    return bounds;
  };
  if (camera->GetNumberOfBlocks() == 0) return false;  // after an error event of the source
  using Source = vtkPlenoflameCameraSource;
  const auto camera_bounds = bounds_of({Source::LENS_SURFACES, Source::LENS_EDGES, Source::STOP,
                                        Source::MICROLENSES, Source::ARRAY_PLATE, Source::SENSOR});
  const auto sensor_bounds = bounds_of({Source::SENSOR});

  renderer->SetBackground(views::kBackground[0], views::kBackground[1], views::kBackground[2]);
  views::add_camera(*camera, source->GetPlateTexture(), close ? 0.45 : 0.4, *renderer);
  if (this->SensorImage)
    views::add_picture(vtkPolyData::SafeDownCast(camera->GetBlock(Source::SENSOR)),
                       *views::picture_of(*this->SensorImage), *renderer);
  if (this->Rays && this->Rays->GetNumberOfLines() > 0)
    views::add_rays(*this->Rays, this->RayColoring == BY_STATUS, *renderer);
  vtkSmartPointer<vtkColorTransferFunction> colours;
  std::array<double, 6> flame_bounds{};
  if (flame) {
    flame->GetBounds(flame_bounds.data());
    colours = views::temperature_colours(*flame);
    if (view == WHOLE_SCENE || view == FLAME)
      renderer->AddVolume(views::flame_volume(*flame, colours));
  }

  if (view == WHOLE_SCENE || view == FLAME) views::add_surfaces(surfaces, *renderer);
  std::vector<std::vector<Vec3>> windows;
  if (view == WHOLE_SCENE || view == FLAME) windows = views::window_outlines(scene);
  views::add_windows(windows, *renderer);

  // All that has to be in the picture.
  std::vector<Vec3> points;
  views::Subject subject = views::Subject::scene;
  double far = 0;
  const double scene_size = plenoflame::length(middle_of(camera_bounds) -
                                               (flame ? middle_of(flame_bounds) : spec.position)) +
                            (surfaces.all.IsValid() ? 2 * surfaces.all.GetDiagonalLength() : 0) + 1;
  if (close) {
    // In front of the pixel, from the sensor to beyond the array.
    const plenoflame::Vec2 p = spec.sensor.pixel();
    const Vec3 centre = middle_of(sensor_bounds) +
                        (0.5 * spec.sensor.columns - pixel[0] - 0.5) * p.x * right +
                        (0.5 * spec.sensor.rows - pixel[1] - 0.5) * p.y * -up;
    const double half = 0.5 * span * p.x;
    const double depth = array ? spec.array.sensor_distance + 2 * spec.array.thickness : 4 * half;
    for (const double x : {-half, half})
      for (const double y : {-half, half})
        for (const double z : {0.0, depth})
          points.push_back(centre + x * right + y * up + z * axis);
    subject = views::Subject::array;
    far = 40 * half;
  } else if (view == FLAME && (flame || surfaces.all.IsValid())) {
    vtkBoundingBox box = surfaces.bodies;
    if (flame) box.AddBounds(flame_bounds.data());
    if (!box.IsValid()) box = surfaces.all;  // nothing but planes
    std::array<double, 6> bounds{};
    box.GetBounds(bounds.data());
    points = views::corners(bounds);
    subject = views::Subject::flame;
    far = 4 * scene_size;
  } else {
    points = views::corners(camera_bounds);
    if (view == WHOLE_SCENE && !this->AddOtherCameras(renderer, inset ? 12 : 15, points))
      return false;
    if (view == WHOLE_SCENE && flame) {
      const auto more = views::corners(flame_bounds);
      points.insert(points.end(), more.begin(), more.end());
    }
    if (view == WHOLE_SCENE && surfaces.all.IsValid()) {
      std::array<double, 6> bounds{};
      surfaces.all.GetBounds(bounds.data());
      const auto more = views::corners(bounds);
      points.insert(points.end(), more.begin(), more.end());
    }
    for (const std::vector<Vec3>& loop : windows)
      points.insert(points.end(), loop.begin(), loop.end());
    if (view != WHOLE_SCENE) subject = views::Subject::camera;
    for (const Vec3 p : points) far = std::max(far, plenoflame::length(p - points.front()));
    far = 4 * std::max(far, scene_size);
  }
  const int font = inset ? 12 : 15;
  const views::Surroundings around{surfaces.all.IsValid() != 0, surfaces.bodies.IsValid() != 0,
                                   scene_has_several};
  const Vec3 ahead = -plenoflame::normalize(views::way_to_eye(subject, axis, right, up, around));
  const Vec3 seen_right = plenoflame::normalize(plenoflame::cross(ahead, up));
  if (this->ShowAxes) {
    Vec3 low = points.front();
    double extent = 0;
    for (const Vec3 p : points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      extent = std::max(extent, plenoflame::length(p - points.front()));
    }
    const double axis_length = views::round_length(0.25 * extent);
    views::add_axes(low, axis_length, seen_right, plenoflame::cross(seen_right, ahead), font,
                    *renderer);
    if (view == WHOLE_SCENE)
      for (const Vec3 end : {Vec3{}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
        points.push_back(low + axis_length * end);
  }
  int* const size = renderer->GetSize();
  const double aspect = size[1] > 0 ? static_cast<double>(size[0]) / size[1] : 1.5;
  // All of the scene is below the insets.
  const double height = view == WHOLE_SCENE && this->ShowInsets ? 0.64 : 1;
  views::look_at(points, ahead, up, aspect / height, far, *renderer);
  if (height < 1) views::keep_below(height, *renderer);
  const std::array<const char*, 4> titles{"", "camera", "microlenses", ""};
  if (inset) {
    const std::string title = titles[static_cast<std::size_t>(view)];
    views::add_title(scene_has_several ? spec.name + ": " + title : title, font + 1, *renderer);
    return true;
  }
  if (this->Rays && this->Rays->GetNumberOfLines() > 0)
    views::add_legend(legend_of(*this->Rays, this->RayColoring == BY_STATUS, scene), font,
                      *renderer);
  if (colours && (view == WHOLE_SCENE || view == FLAME))
    views::add_temperature_bar(colours, *renderer);
  return true;
}

bool vtkPlenoflameScenePicture::AddTo(vtkRenderer* renderer) {
  if (!renderer || !this->Scene) {
    vtkErrorMacro("there is no scene to show: call SetScene()");
    return false;
  }
  this->OfCamera = this->WithCamera();
  const auto flame = this->Flame();
  const auto surfaces = this->Surfaces(flame);
  return surfaces && this->AddView(renderer, this->View, false, flame, *surfaces);
}

vtkImageData* vtkPlenoflameScenePicture::RenderToImage() {
  if (!this->Scene) {
    vtkErrorMacro("there is no scene to show: call SetScene()");
    return nullptr;
  }
  const plenoflame::views::DisplayConnection display;
  if (!display.why_not().empty()) {
    vtkErrorMacro(<< display.why_not());
    return nullptr;
  }
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetAlphaBitPlanes(1);
  window->SetSize(this->Size);
  this->OfCamera = this->WithCamera();
  const auto flame = this->Flame();
  const auto surfaces = this->Surfaces(flame);
  if (!surfaces) return nullptr;
  bool good = true;
  const auto add = [&](int view, bool inset, double left, double bottom, double right, double top) {
    vtkNew<vtkRenderer> renderer;
    renderer->SetViewport(left, bottom, right, top);
    window->AddRenderer(renderer);
    renderer->SetUseDepthPeeling(1);
    renderer->SetMaximumNumberOfPeels(12);
    renderer->SetUseFXAA(true);
    good = this->AddView(renderer, view, inset, flame, *surfaces) && good;
  };
  add(this->View, false, 0, 0, 1, 1);
  if (this->ShowInsets && this->View == WHOLE_SCENE) {
    add(CAMERA, true, 0.015, 0.645, 0.415, 0.985);
    add(ARRAY, true, 0.585, 0.645, 0.985, 0.985);
  }
  if (!good) return nullptr;
  window->Render();
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(window);
  grab->ReadFrontBufferOff();
  grab->Update();
  this->Picture = vtkSmartPointer<vtkImageData>::New();
  this->Picture->DeepCopy(grab->GetOutput());
  return this->Picture;
}

bool vtkPlenoflameScenePicture::WritePNG(const std::string& path) {
  vtkImageData* const image = this->RenderToImage();
  if (!image) return false;
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* const bytes = writer->GetResult();
  try {
    plenoflame::write_file(path, {reinterpret_cast<const char*>(bytes->GetPointer(0)),
                                  static_cast<std::size_t>(bytes->GetNumberOfValues())});
    return true;
  } catch (const std::exception& error) {
    vtkErrorMacro(<< error.what());
    return false;
  }
}
