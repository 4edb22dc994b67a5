#include "widgets/scene_view.h"

#include <QVTKOpenGLNativeWidget.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkDistanceWidget.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPropCollection.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkTextProperty.h>
#include <vtkVolume.h>

#include <QAction>
#include <QActionGroup>
#include <QLayout>
#include <QMouseEvent>
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
#include "widgets/flame_opacity.h"
#include "widgets/notice.h"
#include "widgets/pointer.h"
#include "widgets/ray_lines.h"
#include "widgets/ruler.h"
#include "widgets/scene_geometry.h"
#include "widgets/scene_view_parts.h"

namespace plenoflame::desktop {
namespace {

constexpr int kFlamePoints = 72;  ///< along the longest side: software drawing must keep up
constexpr int kSensorTexture = 640;

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
  v.before_drawing->SetClientData(v.renderer.Get());
  v.before_drawing->SetCallback([](vtkObject*, unsigned long, void* drawn_by, void*) {
    fit_clipping(*static_cast<vtkRenderer*>(drawn_by));
  });
  v.renderer->AddObserver(vtkCommand::StartEvent, v.before_drawing);
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

  tools_ = new QToolBar(this);
  tools_->setToolButtonStyle(Qt::ToolButtonTextOnly);
  tools_->layout()->setSpacing(0);
  auto* group = new QActionGroup(this);
  const std::array<std::array<QString, 2>, 5> parts{
      {{tr("Scene"), tr("Flame and camera from the side")},
       {tr("Flame"), tr("The flame as large as it fits")},
       {tr("Camera"), tr("Main lens to sensor")},
       {tr("Array"), tr("A few microlenses and the pixels behind them")},
       {tr("Pixel"), tr("The microlens in front of the selected pixel")}}};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    QAction* const action = tools_->addAction(parts[i][0]);
    action->setObjectName("view" + parts[i][0]);
    action->setToolTip(parts[i][1]);
    action->setCheckable(true);
    action->setChecked(i == 0);
    group->addAction(action);
    part_actions_[i] = action;
    connect(action, &QAction::triggered, this, [this, i] { show_part(static_cast<Part>(i)); });
  }
  tools_->addSeparator();
  measure_ = tools_->addAction(tr("Measure"));
  measure_->setCheckable(true);
  measure_->setToolTip(
      tr("Distance between two clicks, in the plane through the middle of the view [m]"));
  measure_->setObjectName("measure");
  connect(measure_, &QAction::toggled, this, [this](bool on) {
    view_->ruler->SetWidgetStateToStart();
    view_->ruler->SetEnabled(on ? 1 : 0);
    emit measured_changed(0);
    render();
  });
  QAction* const save = tools_->addAction(tr("Picture..."));
  save->setToolTip(tr("Save this view as a picture"));
  connect(save, &QAction::triggered, this, &SceneView::picture_requested);
  // As an icon: the texts of the others fill the bar.
  save->setIcon(style()->standardIcon(QStyle::SP_DialogSaveButton));
  if (auto* button = qobject_cast<QToolButton*>(tools_->widgetForAction(save)))
    button->setToolButtonStyle(Qt::ToolButtonIconOnly);

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
  set_dark(false);
}

SceneView::~SceneView() {
  task_.cancel();
  view_->ruler->RemoveObserver(view_->ruler_moved);
  view_->ruler->SetInteractor(nullptr);
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
  render_later_.start(0);
}

void SceneView::set_dark(bool dark) {
  dark_ = dark;
  if (dark)
    view_->renderer->SetBackground(0.11, 0.12, 0.14);
  else
    view_->renderer->SetBackground(0.97, 0.97, 0.98);
  set_ruler_dark(*view_->ruler, dark);
  if (geometry_) add_flame();
  add_rays();
  render();
}

void SceneView::warm_up() {
  if (warm_ || scene_) return;  // what is there must stay
  warm_ = true;
  view_->widget->grabFramebuffer();  // from here on there is something to draw with
  const Scene scene = parse_scene("[camera]\npreset = \"paper-previous-60x60\"\n", "").scene;
  geometry_ = std::make_shared<SceneGeometry>(
      scene, std::array<int, 2>{scene.camera.sensor.columns / 2, scene.camera.sensor.rows / 2});
  geometry_->flame = small_flame();
  temperatures_ = {1000, 2000};
  image_ = std::make_shared<const ImagePyramid>(std::make_shared<const Image>(8, 8, 1.0F),
                                                Execution{1, {}, {}, {}});
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
    view_->window->Render();
  }
  part_ = Part::scene;
  highlighted_ = -1;
  geometry_ = nullptr;
  image_ = nullptr;
  rays_ = nullptr;
  temperatures_ = {0, 0};
  for (const char* layer : {"camera", "flame", "rays"}) view_->replace(layer, [](vtkRenderer&) {});
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
  built_ = ++newest_;
  show_all();
  scene_ = nullptr;
  geometry_ = nullptr;
  rays_ = nullptr;
  image_ = nullptr;
  others_.clear();
  temperatures_ = {0, 0};
  aimed_ = false;
  for (const char* layer : {"camera", "flame", "rays"}) view_->replace(layer, [](vtkRenderer&) {});
  if (measure_->isChecked()) measure_->setChecked(false);
  render();
}

void SceneView::set_notice(const QString& text) {
  notice_->say(text);
}

void SceneView::build_geometry() {
  if (!scene_) return;
  const unsigned number = ++newest_;
  std::array<int, 2> pixel{scene_->scene.camera.sensor.columns / 2,
                           scene_->scene.camera.sensor.rows / 2};
  if (rays_ && rays_->selection.kind == Selection::Kind::pixel)
    pixel = {rays_->selection.column, rays_->selection.row};
  task_.request([this, scene = scene_, others = others_, number, pixel](std::stop_token stop) {
    Execution execution;
    execution.stop = std::move(stop);
    try {
      const auto built = std::make_shared<SceneGeometry>(scene->scene, pixel, others);
      if (scene->medium)
        built->flame = pipeline::flame_image(*scene->medium, kFlamePoints, execution);
      if (built->flame) show_glow(*scene->medium, *built->flame, execution);
      post(this, [this, number, built] {
        if (number != newest_) return;
        built_ = number;
        std::array<double, 6> before{};
        if (geometry_ && geometry_->flame) geometry_->flame->GetBounds(before.data());
        geometry_ = built;
        add_geometry();
        if (aimed_) follow(before);
      });
    } catch (const std::exception&) {  // what is wrong with the scene is said by the compiler
      post(this, [this, number] { built_ = number; });
    }
  });
}

void SceneView::add_geometry() {
  temperatures_ = {0, 0};
  if (geometry_->flame) {
    const auto colours = views::temperature_colours(*geometry_->flame);
    temperatures_ = {std::max(0.0, colours->GetRange()[0]), colours->GetRange()[1]};
  }
  if (!aimed_) aim();
  if (first_) {
    // The first frame of each kind of thing compiles programs for the graphics card: one thing at a
    // time, and none to begin with, so that the window answers in between.
    view_->window->Render();
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
  render();
}

void SceneView::add_layers() {
  add_camera();
  add_flame();
  add_rays();
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
  const bool close = (part_ == Part::array || part_ == Part::pixel) && geometry_->detail;
  vtkSmartPointer<vtkImageData> texture;
  if (image_ && !image_->empty())
    texture = texture_of(image_->level(image_->level_within(kSensorTexture)));
  view_->replace("camera", [&](vtkRenderer& renderer) {
    views::add_camera(close ? *geometry_->detail : *geometry_->camera, geometry_->plate_texture,
                      texture, close ? 0.45 : 0.4, renderer);
    for (const SceneGeometry::Other& other : geometry_->others)
      views::add_camera(*other.camera, other.plate_texture, nullptr, 0.4, renderer);
  });
}

void SceneView::add_flame() {
  if (!geometry_) return;
  vtkImageData* const flame = geometry_->flame;
  view_->replace("flame", [&](vtkRenderer& renderer) {
    if (!flame) return;
    auto colours = views::temperature_colours(*flame);
    const double cold = look_.automatic ? temperatures_[0] : look_.cold,
                 hot = look_.automatic ? temperatures_[1] : look_.hot;
    colours->RemoveAllPoints();
    constexpr int kStops = 17;
    for (int i = 0; i < kStops; ++i) {
      const double t = static_cast<double>(i) / (kStops - 1);
      const Rgb c = flame_colour(look_.map, t);
      colours->AddRGBPoint(cold + t * (hot - cold), c.red / 255.0, c.green / 255.0, c.blue / 255.0);
    }
    const auto volume = views::flame_volume(*flame, colours);
    apply_opacity(look_, cold, hot, *volume);
    if (auto* mapper = vtkFixedPointVolumeRayCastMapper::SafeDownCast(volume->GetMapper())) {
      mapper->SetAutoAdjustSampleDistances(1);
      mapper->SetMinimumImageSampleDistance(1);
      mapper->SetMaximumImageSampleDistance(8);
    }
    renderer.AddVolume(volume);
    // A clear flame may have no temperatures to tell.
    if (flame->GetPointData()->GetArray("temperature")->GetRange()[1] > 0)
      views::add_temperature_bar(colours, renderer);
  });
  for (const auto& prop : view_->layers["flame"])
    if (auto* bar = vtkScalarBarActor::SafeDownCast(prop)) {
      const double ink = dark_ ? 0.9 : 0.1;
      bar->SetPosition(0.54, 0.02);
      bar->SetWidth(0.38);
      bar->SetHeight(0.2);
      // VTK aligns labels when it makes them, and forgets it when they are drawn again.
      bar->GetLabelTextProperty()->SetJustificationToCentered();
      bar->GetLabelTextProperty()->SetVerticalJustificationToTop();
      for (auto* style : {bar->GetTitleTextProperty(), bar->GetLabelTextProperty()}) {
        style->SetColor(ink, ink, ink);
        style->SetFontSize(12);
      }
    }
  view_->show("flame", part_ == Part::scene || part_ == Part::flame);
}

void SceneView::add_rays() {
  view_->replace("rays", [&](vtkRenderer& renderer) {
    if (!rays_ || rays_->paths.rays.empty()) return;
    add_ray_lines(rays_->paths, highlighted_, dark_, renderer);
  });
}

void SceneView::set_rays(std::shared_ptr<const SelectedRays> rays, int chosen) {
  const bool moved = rays && rays->selection.kind == Selection::Kind::pixel &&
                     !(rays_ && rays_->selection == rays->selection);
  rays_ = std::move(rays);
  highlighted_ = chosen;
  add_rays();
  if (moved && geometry_) build_geometry();  // the microlenses near the pixel
  if (part_ == Part::pixel || part_ == Part::array) aim();
  render();
}

void SceneView::set_highlighted(int ray) {
  if (ray == highlighted_) return;
  highlighted_ = ray;
  add_rays();
  render();
}

void SceneView::set_image(const std::shared_ptr<const ImagePyramid>& image) {
  image_ = image;
  if (!geometry_) return;
  add_camera();
  render();
}

void SceneView::set_flame_look(const FlameLook& look) {
  look_ = look;
  add_flame();
  render();
}

void SceneView::show_part(Part part) {
  show_all();
  part_ = part;
  part_actions_[static_cast<std::size_t>(part)]->setChecked(true);
  add_camera();
  view_->show("flame", part_ == Part::scene || part_ == Part::flame);
  aim();
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
  return built_ == newest_ && view_->hidden.empty() && !render_later_.isActive();
}

QImage SceneView::picture() {
  show_all();
  render_later_.stop();
  // While somebody turns the scene the flame is drawn as coarsely as the machine is slow: not here.
  std::vector<vtkFixedPointVolumeRayCastMapper*> mappers;
  for (const auto& prop : view_->layers["flame"])
    if (auto* volume = vtkVolume::SafeDownCast(prop))
      if (auto* mapper = vtkFixedPointVolumeRayCastMapper::SafeDownCast(volume->GetMapper())) {
        mapper->AutoAdjustSampleDistancesOff();
        mapper->SetImageSampleDistance(1);
        mappers.push_back(mapper);
      }
  view_->window->Render();
  // A view that was resized a moment ago is drawn once more by the grab: finely, too.
  QImage picture = view_->widget->grabFramebuffer();
  for (auto* mapper : mappers) mapper->AutoAdjustSampleDistancesOn();
  return picture;
}

}  // namespace plenoflame::desktop
