#include "widgets/scene/scene_view.h"

#include <QVTKOpenGLNativeWidget.h>
#include <vtkActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkDistanceWidget.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkMapper.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPropCollection.h>
#include <vtkProperty.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkTextProperty.h>
#include <vtkTexture.h>
#include <vtkVolume.h>

#include <QAction>
#include <QActionGroup>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLayout>
#include <QMouseEvent>
#include <QSignalBlocker>
#include <QStyle>
#include <QToolBar>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "flame_image.h"
#include "flame_volume.h"
#include "model/scene_target.h"
#include "picture_annotation.h"
#include "picture_camera.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/scene/scene_file.h"
#include "scene_props.h"
#include "surface_props.h"
#include "vtkPlenoflameCameraSource.h"
#include "widgets/controls/notice.h"
#include "widgets/controls/pointer.h"
#include "widgets/controls/tool_row.h"
#include "widgets/flame/flame_opacity.h"
#include "widgets/image/ruler.h"
#include "widgets/scene/camera_body.h"
#include "widgets/scene/ray_lines.h"
#include "widgets/scene/scene_geometry.h"
#include "widgets/scene/scene_view_parts.h"
#include "window_props.h"

namespace plenoflame::desktop {
namespace {

constexpr int kFlamePoints = 72;  ///< along the longest side: software drawing must keep up
constexpr int kLightPoints = 112;
constexpr double kGlass = 0.4, kMicrolensGlass = 0.45;  ///< opacity

/// Parts that are made for paper are seen before the dark, too.
void stand_out(vtkActor& part) {
  if (part.GetTexture()) return;
  vtkProperty& look = *part.GetProperty();
  std::array<double, 3> rgb{};
  look.GetColor(rgb.data());
  const double light = std::max({rgb[0], rgb[1], rgb[2]});
  constexpr double kLeast = 0.55;
  if (light < kLeast)
    for (double& c : rgb) c += kLeast - light;
  look.SetColor(rgb.data());
  look.SetAmbientColor(rgb.data());
  look.SetAmbient(0.3);
}

}  // namespace

SceneView::SceneView(QWidget* parent) : QWidget(parent), view_(std::make_unique<View>()) {
  View& v = *view_;
  v.widget = new QVTKOpenGLNativeWidget(this);
  v.widget->setObjectName("scene3d");
  v.widget->setMinimumSize(160, 140);
  v.widget->setRenderWindow(v.window);
  v.window->SetMultiSamples(0);
  v.window->SetAlphaBitPlanes(1);
  v.renderer->SetUseDepthPeeling(1);
  v.renderer->SetMaximumNumberOfPeels(4);
  v.window->AddRenderer(v.renderer);
  vtkRenderWindowInteractor* const interactor = v.widget->interactor();
  interactor->SetInteractorStyle(v.style);
  interactor->SetDesiredUpdateRate(15);
  interactor->SetStillUpdateRate(15);
  v.style->AutoAdjustCameraClippingRangeOff();
  v.scale_bar = std::make_unique<ScaleBar>(*v.renderer);
  v.eye = std::make_unique<EyeLayer>(*v.renderer);
  connect(v.eye.get(), &EyeLayer::changed, this, &SceneView::render);
  v.before_drawing->SetClientData(this);
  v.before_drawing->SetCallback([](vtkObject*, unsigned long, void* self, void*) {
    static_cast<SceneView*>(self)->follow_eye();
  });
  v.renderer->AddObserver(vtkCommand::StartEvent, v.before_drawing);
  v.turning->SetClientData(&v);
  v.turning->SetCallback([](vtkObject*, unsigned long event, void* drawn_by, void*) {
    static_cast<View*>(drawn_by)->sort_glass(event == vtkCommand::EndInteractionEvent);
  });
  v.style->AddObserver(vtkCommand::StartInteractionEvent, v.turning);
  v.style->AddObserver(vtkCommand::EndInteractionEvent, v.turning);
  v.rest.setSingleShot(true);
  connect(&v.rest, &QTimer::timeout, this, [this] {
    view_->sort_glass(true);
    render();
  });
  v.ruler->SetInteractor(interactor);
  set_up_ruler(*v.ruler);
  v.ruler_moved->SetClientData(this);
  v.ruler_moved->SetCallback([](vtkObject*, unsigned long, void* self, void*) {
    static_cast<SceneView*>(self)->show_measured();
  });
  for (const unsigned long event :
       {vtkCommand::PlacePointEvent, vtkCommand::InteractionEvent, vtkCommand::EndInteractionEvent})
    v.ruler->AddObserver(event, v.ruler_moved);
  v.widget->installEventFilter(this);
  v.add_axes_cube();

  make_tools();
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addWidget(tools_);
  notice_ = new Notice(this);
  notice_->setObjectName("sceneViewNotice");
  layout->addWidget(notice_);
  layout->addWidget(v.widget, 1);
  render_later_.setSingleShot(true);
  connect(&render_later_, &QTimer::timeout, this, [this] { view_->window->Render(); });
  show_later_.setSingleShot(true);
  connect(&show_later_, &QTimer::timeout, this, &SceneView::show_next);
  light_timer_.setSingleShot(true);
  connect(&light_timer_, &QTimer::timeout, this, &SceneView::move_light);
  // Dark in both themes: what shines is to be the brightest there is.
  v.renderer->SetBackground(views::kBackground[0], views::kBackground[1], views::kBackground[2]);
  set_ruler_dark(*v.ruler, true);
}

SceneView::~SceneView() {
  task_.cancel();
  light_task_.cancel();
  view_->ruler->RemoveObserver(view_->ruler_moved);
  view_->ruler->SetInteractor(nullptr);
  for (const View::Handle& handle : view_->handles) handle.widget->SetInteractor(nullptr);
  view_->axes->SetInteractor(nullptr);
  // Another view may still watch a camera that both have.
  view_->moved_elsewhere->SetCallback(nullptr);
  view_->style->RemoveAllObservers();
}

void SceneView::follow_eye() {
  View& v = *view_;
  // VTK 9.1 now and then keeps an aspect of 1. The flame has rays of its own: it would then stand
  // beside its place, or outside of the picture.
  v.renderer->SetAspect(v.renderer->GetTiledAspectRatio(), 1);
  v.eye->follow_camera();
  fit_clipping(*v.renderer);
  add_arrays();
  v.scale_bar->update(*v.renderer);
  v.place_labels();
}

double SceneView::measured() const {
  if (!measure_->isChecked() || view_->ruler->GetWidgetState() == vtkDistanceWidget::Start)
    return 0;
  return ruler_length(*view_->ruler);
}

void SceneView::show_measured() {
  const double distance = measured();
  set_ruler_text(*view_->ruler, readable_quantity(distance, Dimension::length, 4));
  emit measured_changed(distance);
}

void SceneView::render() {
  // Once for all that happens before the event loop turns.
  if (!held_) render_later_.start(0);
}

void SceneView::hold(bool on) {
  if (on == held_) return;
  held_ = on;
  if (on) return;
  build_geometry();
  add_camera();
  add_rays();
  render();
}

void SceneView::warm_up() {
  if (warm_ || scene_) return;  // keeps the present scene
  warm_ = true;
  view_->widget->grabFramebuffer();  // from here on there is something to draw with
  const Scene scene = parse_scene("[camera]\npreset = \"paper-previous-60x60\"\n", "").scene;
  geometry_ = std::make_shared<SceneGeometry>(scene);
  geometry_->flame = small_flame();
  temperatures_ = {1000, 2000};
  picture_ = picture_on_sensor({std::make_shared<const Image>(8, 8, 1.0F), {1, {}, {}, {}}});
  auto rays = std::make_shared<SelectedRays>();
  rays->paths.rays.resize(1);
  rays->paths.vertices.resize(2);
  rays->paths.vertices[0].position = {0.1, 0, 0};
  rays->paths.rays[0].count = 2;
  rays_ = rays;
  highlighted_ = 0;
  for (const Part part : {Part::scene, Part::array}) {
    part_ = part;
    add_layers();
    view_->renderer->ResetCamera();
    for (const bool sorted : {false, true}) {
      view_->sort_glass(sorted);
      view_->window->Render();
    }
  }
  part_ = Part::scene;
  highlighted_ = -1;
  geometry_ = nullptr;
  picture_ = nullptr;
  rays_ = nullptr;
  temperatures_ = {0, 0};
  for (const char* layer : {"camera", "picture", "arrays", "housing", "flame", "rays"})
    view_->replace(layer, [](vtkRenderer&) {});
  view_->window->Render();
}

void SceneView::set_scene(std::shared_ptr<const CompiledScene> scene, const SceneChanges& changes,
                          std::vector<CameraSpec> others) {
  scene_ = std::move(scene);
  others_ = std::move(others);
  if (!changes.compiled() && geometry_) return;
  build_geometry();
}

void SceneView::clear() {
  task_.cancel();
  light_task_.cancel();
  lit_.clear();
  light_known_ = true;
  view_->eye->set_flame(nullptr);
  built_ = ++newest_;
  show_all();
  scene_ = nullptr;
  geometry_ = nullptr;
  rays_ = nullptr;
  picture_ = nullptr;
  others_.clear();
  temperatures_ = {0, 0};
  aimed_ = along_axis_ = false;
  schematic_ = {};
  other_schematics_.clear();
  for (const char* layer :
       {"camera", "picture", "arrays", "housing", "flame", "surroundings", "rays", "gaps"})
    view_->replace(layer, [](vtkRenderer&) {});
  find_ways();
  place_handles();
  view_->show_frame(false);
  if (measure_->isChecked()) measure_->setChecked(false);
  render();
}

void SceneView::set_notice(const QString& text) {
  notice_->say(text);
}

/// In the background, for flames that are others than before.
void SceneView::find_light() {
  if (scene_->flames == lit_) return;
  lit_ = scene_->flames;
  light_known_ = false;
  light_task_.request([this, scene = scene_](std::stop_token stop) {
    Execution execution;
    execution.stop = std::move(stop);
    std::shared_ptr<const EyeFlame> light;
    try {
      light = eye_flame(scene->scene, kLightPoints, execution, scene->loaded);
    } catch (const Cancelled&) {
      return;
    } catch (const std::exception&) {  // what is wrong with the scene is said by the compiler
    }
    post(this, [this, light, flames = scene->flames] {
      if (flames != lit_) return;
      light_known_ = true;
      view_->eye->set_flame(light);
      add_flame();
      render();
    });
  });
}

void SceneView::build_geometry() {
  if (!scene_ || held_) return;
  find_light();
  const unsigned number = ++newest_;
  task_.request([this, scene = scene_, others = others_, number](std::stop_token stop) {
    Execution execution;
    execution.stop = std::move(stop);
    try {
      const auto built = std::make_shared<SceneGeometry>(scene->scene, others);
      if (scene->medium)
        built->flame = pipeline::flame_image(*scene->medium, kFlamePoints, execution);
      if (built->flame) {
        show_glow(*scene->medium, *built->flame, execution);
        built->temperatures = span_of(*built->flame);
      }
      built->add_surroundings(scene->scene);
      post(this, [this, number, built] {
        if (number != newest_) return;
        built_ = number;
        std::array<double, 6> before{};
        if (geometry_ && geometry_->flame) geometry_->flame->GetBounds(before.data());
        geometry_ = built;
        add_geometry();
        if (aimed_ && dragged_ < 0) follow(before);
      });
    } catch (const std::exception&) {  // what is wrong with the scene is said by the compiler
      post(this, [this, number] { built_ = number; });
    }
  });
}

void SceneView::add_geometry() {
  temperatures_ = geometry_->temperatures;
  view_->show_frame(true);
  view_->axes->InteractiveOff();
  update_schematic();
  if (!aimed_) aim();
  if (first_) {
    // The first frame of each kind of thing compiles programs for the graphics card. Things are
    // added one at a time, beginning with none, so that the window answers in between.
    render();
    add_layers();
    for (const auto& [layer, props] : view_->layers)
      for (const auto& prop : props)
        if (prop->GetVisibility()) view_->hidden.push_back(prop);
    for (const auto& prop : view_->hidden) prop->VisibilityOff();
    first_ = false;
    show_later_.start(0);
    return;
  }
  show_all();
  add_layers();
  if (dragged_ < 0) place_handles();
  render();
}

void SceneView::add_layers() {
  add_camera();
  view_->arrays.clear();
  add_arrays();
  add_flame();
  add_surroundings();
  add_rays();
  add_gaps();
}

void SceneView::show_next() {
  if (view_->hidden.empty()) return;
  view_->hidden.back()->VisibilityOn();
  view_->hidden.pop_back();
  view_->window->Render();
  if (!view_->hidden.empty()) show_later_.start(0);
}

void SceneView::show_all() {
  for (const auto& prop : view_->hidden) prop->VisibilityOn();
  view_->hidden.clear();
}

void SceneView::add_camera() {
  if (!geometry_) return;
  view_->replace("camera", [&](vtkRenderer& renderer) {
    for (std::size_t i = 0; i < geometry_->drawn.size(); ++i)
      views::add_camera(*placed(*geometry_->drawn[i].parts, schematic_of(i)), nullptr, kGlass,
                        renderer);
  });
  polish("camera");
  add_picture();
  add_housings();
}

void SceneView::add_arrays() {
  if (!geometry_) return;
  const auto& cameras = geometry_->drawn;
  std::vector<ArrayPart>& shown = view_->arrays;
  bool changed = shown.size() != cameras.size();
  shown.resize(cameras.size());
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Camera& camera = cameras[i].optics;
    if (!camera.has_array()) continue;
    const bool near_pixel = i == 0 && is_close();
    const ArrayPart part = near_pixel ? lenses_near(camera, pixel())
                                      : large_lenses(camera, schematic_of(i), *view_->renderer);
    if (part == shown[i] || (!near_pixel && shown[i].suits(part, camera))) continue;
    shown[i] = near_pixel || part.empty() ? part : with_margin(part, camera);
    changed = true;
  }
  if (!changed) return;
  view_->replace("arrays", [&](vtkRenderer& renderer) {
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      if (!cameras[i].plate) continue;
      vtkNew<vtkMultiBlockDataSet> array;
      const bool plate = shown[i].empty();
      array->SetBlock(
          plate ? vtkPlenoflameCameraSource::ARRAY_PLATE : vtkPlenoflameCameraSource::MICROLENSES,
          placed(plate ? cameras[i].plate : lenses_of(cameras[i].optics, shown[i]),
                 schematic_of(i)));
      views::add_camera(*array, cameras[i].plate_texture, kMicrolensGlass, renderer);
    }
  });
  polish("arrays");
}

void SceneView::polish(const std::string& layer) {
  for (const auto& prop : view_->layers[layer])
    if (auto* actor = vtkActor::SafeDownCast(prop)) {
      stand_out(*actor);
      if (!actor->GetTexture() && actor->GetProperty()->GetOpacity() < 0.5) mirror_a_room(*actor);
    }
}

void SceneView::add_housings() {
  view_->replace("housing", [&](vtkRenderer& renderer) {
    for (std::size_t i = 0; i < geometry_->drawn.size(); ++i)
      if (auto* const housing = housing_shown(i))
        add_housing(*placed(housing, schematic_of(i)), renderer);
  });
}

vtkPolyData* SceneView::housing_shown(std::size_t camera) const {
  const auto chosen = static_cast<Housing>(housing_->currentIndex());
  if (is_close() || chosen == Housing::none) return nullptr;
  return geometry_->drawn.at(camera).housings[chosen == Housing::closed ? 1 : 0];
}

void SceneView::add_surroundings() {
  view_->replace("surroundings", [&](vtkRenderer& renderer) {
    if (!geometry_) return;
    views::SolidSurfaces solids = geometry_->solids;
    for (views::SolidSurfaces::Part& solid : solids.parts)
      solid.data = placed(solid.data, schematic_);
    views::add_surfaces(solids, renderer);
    std::vector<std::vector<Vec3>> windows = geometry_->windows;
    for (std::vector<Vec3>& outline : windows)
      for (Vec3& point : outline) point = schematic_.place(point);
    views::add_windows(windows, renderer);
  });
  for (const auto& prop : view_->layers["surroundings"])
    if (auto* actor = vtkActor::SafeDownCast(prop);
        actor && !actor->GetMapper()->GetScalarVisibility())
      stand_out(*actor);
  view_->show("surroundings", shows_flame());
}

void SceneView::add_rays() {
  view_->replace("rays", [&](vtkRenderer& renderer) {
    if (!rays_ || rays_->paths.rays.empty()) return;
    add_ray_lines(rays_->paths, highlighted_, true, schematic_, renderer);
  });
  find_ways();
}

void SceneView::set_rays(std::shared_ptr<const SelectedRays> rays, int chosen) {
  rays_ = std::move(rays);
  highlighted_ = chosen;
  add_rays();
  if (part_ == Part::pixel || part_ == Part::array) aim();
  render();
}

void SceneView::set_highlighted(int ray) {
  if (ray == highlighted_) return;
  highlighted_ = ray;
  add_rays();
  render();
}

void SceneView::set_flame_look(const FlameLook& look) {
  look_ = look;
  const QSignalBlocker quiet(drawing_);
  drawing_->setCurrentIndex(static_cast<int>(look.drawing));
  const QSignalBlocker still(exposure_);
  exposure_->setValue(look.exposure);
  add_flame();
  render();
}

void SceneView::show_part(Part part) {
  show_all();
  part_ = part;
  part_actions_[static_cast<std::size_t>(part)]->setChecked(true);
  const bool was_to_scale = schematic_.is_to_scale();
  update_schematic();
  if (was_to_scale && schematic_.is_to_scale()) {
    add_camera();
    show_flame();
    view_->show("surroundings", shows_flame());
    add_gaps();
  } else {
    add_layers();
  }
  aim();
  place_handles();
  render();
}

/// Recomputes the gaps after a change of something that they depend on.
void SceneView::draw_to_scale() {
  update_schematic();
  if (geometry_) {
    show_all();
    add_layers();
    aim();
  }
  render();
}

double SceneView::view_height() const {
  vtkCamera* const camera = view_->renderer->GetActiveCamera();
  return 2 * camera->GetDistance() *
         std::tan(0.5 * camera->GetViewAngle() * 3.14159265358979 / 180);
}

std::array<double, 2> SceneView::clipping_range() const {
  std::array<double, 2> range{};
  view_->renderer->GetActiveCamera()->GetClippingRange(range.data());
  return range;
}

bool SceneView::is_current() const {
  return built_ == newest_ && view_->hidden.empty() && !render_later_.isActive() && light_known_ &&
         !view_->rest.isActive() && view_->eye->is_fine();
}

QImage SceneView::poster(const QSize& size, const QColor& background, double& metres) {
  View& v = *view_;
  const QSize before = v.widget->size();
  const double ratio = v.widget->devicePixelRatioF();
  v.show_frame(false);
  v.renderer->SetBackground(background.redF(), background.greenF(), background.blueF());
  v.widget->resize((QSizeF(size) / ratio).toSize());
  const QImage drawn = picture();
  metres = view_height() / size.height();
  v.widget->resize(before);
  v.renderer->SetBackground(views::kBackground[0], views::kBackground[1], views::kBackground[2]);
  v.show_frame(geometry_ != nullptr);
  render();
  QImage exact = drawn.scaled(size, Qt::IgnoreAspectRatio, Qt::SmoothTransformation);
  exact.setDevicePixelRatio(1);
  return exact;
}

QImage SceneView::picture() {
  show_all();
  render_later_.stop();
  view_->sort_glass(true);
  // While somebody turns the scene the flame is drawn as coarsely as the machine is slow: not here.
  std::vector<vtkFixedPointVolumeRayCastMapper*> mappers;
  for (const auto& prop : view_->layers["flame"])
    if (auto* volume = vtkVolume::SafeDownCast(prop))
      if (auto* mapper = vtkFixedPointVolumeRayCastMapper::SafeDownCast(volume->GetMapper())) {
        mapper->AutoAdjustSampleDistancesOff();
        mapper->SetImageSampleDistance(1);
        mappers.push_back(mapper);
      }
  view_->eye->draw_at_once(true);
  view_->window->Render();
  // A view that was resized a moment ago is drawn once more by the grab: finely, too.
  QImage picture = view_->widget->grabFramebuffer();
  view_->eye->draw_at_once(false);
  for (auto* mapper : mappers) mapper->AutoAdjustSampleDistancesOn();
  return picture;
}

}  // namespace plenoflame::desktop
