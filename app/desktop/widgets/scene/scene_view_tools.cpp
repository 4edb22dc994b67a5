#include <vtkAbstractVolumeMapper.h>
#include <vtkAnnotatedCubeActor.h>
#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkOrientationMarkerWidget.h>
#include <vtkPlane.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkProperty2D.h>
#include <vtkScalarBarActor.h>
#include <vtkTextProperty.h>
#include <vtkVolume.h>

#include <QAction>
#include <QActionGroup>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QHBoxLayout>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <array>

#include "emission_span.h"
#include "flame_volume.h"
#include "model/flame_glow.h"
#include "picture_annotation.h"
#include "picture_camera.h"
#include "widgets/controls/glyphs.h"
#include "widgets/controls/tool_row.h"
#include "widgets/flame/flame_opacity.h"
#include "widgets/scene/camera_body.h"
#include "widgets/scene/scene_geometry.h"
#include "widgets/scene/scene_view_parts.h"

// The look of the flame in the 3-D view, and the buttons above it.
namespace plenoflame::desktop {
namespace {

constexpr std::array<double, 3> kSurfaces{0.1, 0.5, 0.85};  ///< shares of the span of colours
constexpr double kInkOfBar = 0.9;
constexpr ScreenBox kBar{0.85, 0.2, 0.98, 0.8};  ///< of temperatures, in shares of the view
/// The place of the axes, in shares of the view. Flames are on the left and in the middle.
constexpr ScreenBox kCube{0.86, 0.85, 1, 1};
constexpr double kShine = 3;  ///< density of emission beside that of absorption

/// The same flame with what shines in the place of what absorbs.
vtkSmartPointer<vtkImageData> shining(vtkImageData& flame) {
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->ShallowCopy(&flame);
  auto* const t = flame.GetPointData()->GetArray("temperature");
  auto* const kappa = flame.GetPointData()->GetArray("absorption");
  vtkNew<vtkFloatArray> emission;
  emission->SetName("absorption");
  emission->SetNumberOfValues(flame.GetNumberOfPoints());
  for (vtkIdType i = 0; i < flame.GetNumberOfPoints(); ++i)
    emission->SetValue(i,
                       static_cast<float>(thermal_emission(t->GetTuple1(i), kappa->GetTuple1(i))));
  // A clear flame may have no temperatures: what it has in place of absorption is its light.
  if (emission->GetRange()[1] > 0) image->GetPointData()->AddArray(emission);
  return image;
}

vtkSmartPointer<vtkActor> surface_of(vtkImageData& flame, double temperature,
                                     vtkColorTransferFunction& colours, double opacity) {
  vtkNew<vtkFlyingEdges3D> edges;
  flame.GetPointData()->SetActiveScalars("temperature");
  edges->SetInputData(&flame);
  edges->SetValue(0, temperature);
  edges->ComputeScalarsOff();
  edges->ComputeNormalsOn();
  vtkNew<vtkPolyDataMapper> mapper;
  edges->Update();
  mapper->SetInputData(edges->GetOutput());
  mapper->ScalarVisibilityOff();
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  std::array<double, 3> rgb{};
  colours.GetColor(temperature, rgb.data());
  actor->GetProperty()->SetColor(rgb.data());
  actor->GetProperty()->SetOpacity(opacity);
  actor->GetProperty()->SetAmbient(0.35);  // it shines by itself
  return actor;
}

/// A flame where it is drawn; it keeps its shape.
vtkSmartPointer<vtkImageData> placed(const vtkSmartPointer<vtkImageData>& flame,
                                     const Schematic& schematic) {
  if (!flame || schematic.is_to_scale()) return flame;
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->ShallowCopy(flame);
  std::array<double, 3> centre{}, origin{};
  flame->GetCenter(centre.data());
  flame->GetOrigin(origin.data());
  const Vec3 middle{centre[0], centre[1], centre[2]};
  const Vec3 by = schematic.place(middle) - middle;
  image->SetOrigin(origin[0] + by.x, origin[1] + by.y, origin[2] + by.z);
  return image;
}

/// Nothing is left beyond a place along an axis.
void cut_volume(vtkVolume& volume, int axis, double end) {
  auto* const image = vtkImageData::SafeDownCast(volume.GetMapper()->GetDataSetInput());
  auto* const both =
      image ? vtkFloatArray::SafeDownCast(image->GetPointData()->GetScalars()) : nullptr;
  if (!both || both->GetNumberOfComponents() != 2) return;
  for (vtkIdType i = 0; i < both->GetNumberOfTuples(); ++i) {
    std::array<double, 3> place{};
    image->GetPoint(i, place.data());
    if (place[static_cast<std::size_t>(axis)] > end) both->SetTypedComponent(i, 1, 0);
  }
  both->Modified();
}

void set_bar_style(vtkScalarBarActor& bar) {
  bar.SetTitle("K");
  bar.SetOrientationToVertical();
  bar.SetTextPositionToPrecedeScalarBar();
  bar.SetPosition(kBar.left, kBar.bottom);
  bar.SetWidth(kBar.right - kBar.left);
  bar.SetHeight(kBar.top - kBar.bottom);
  // Else they lie over the bar from its second layout on.
  bar.GetLabelTextProperty()->SetJustificationToRight();
  bar.SetBarRatio(0.25);
  bar.SetLabelFormat("%.0f  ");
  bar.SetMaximumNumberOfColors(256);  // the map's own, with no steps to be seen
  bar.DrawBackgroundOn();             // rays pass behind it
  bar.GetBackgroundProperty()->SetColor(views::kBackground[0], views::kBackground[1],
                                        views::kBackground[2]);
  bar.GetBackgroundProperty()->SetOpacity(kTextGround);
  for (auto* style : {bar.GetTitleTextProperty(), bar.GetLabelTextProperty()}) {
    views::set_typeface(*style);
    style->SetColor(kInkOfBar, kInkOfBar, kInkOfBar);
    style->SetFontSize(13);
  }
}

}  // namespace

std::array<double, 2> span_of(vtkImageData& flame) {
  auto* const t = vtkFloatArray::SafeDownCast(flame.GetPointData()->GetArray("temperature"));
  auto* const kappa = vtkFloatArray::SafeDownCast(flame.GetPointData()->GetArray("absorption"));
  if (!t || !kappa) return {0, 0};
  const auto count = static_cast<std::size_t>(flame.GetNumberOfPoints());
  return emission_span({t->GetPointer(0), count}, {kappa->GetPointer(0), count});
}

void SceneView::View::add_axes_cube() {
  vtkNew<vtkAnnotatedCubeActor> cube;
  cube->SetXPlusFaceText("+X");
  cube->SetXMinusFaceText("-X");
  cube->SetYPlusFaceText("+Y");
  cube->SetYMinusFaceText("-Y");
  cube->SetZPlusFaceText("+Z");
  cube->SetZMinusFaceText("-Z");
  cube->SetFaceTextScale(0.5);
  cube->GetCubeProperty()->SetColor(0.3, 0.32, 0.37);
  // Faces seen nearly edge-on must differ from the background, too.
  cube->GetCubeProperty()->SetAmbient(0.6);
  cube->GetCubeProperty()->SetDiffuse(0.5);
  cube->GetTextEdgesProperty()->SetColor(0.6, 0.62, 0.66);
  cube->GetXPlusFaceProperty()->SetColor(0.95, 0.45, 0.4);
  cube->GetXMinusFaceProperty()->SetColor(0.95, 0.45, 0.4);
  cube->GetYPlusFaceProperty()->SetColor(0.55, 0.85, 0.45);
  cube->GetYMinusFaceProperty()->SetColor(0.55, 0.85, 0.45);
  cube->GetZPlusFaceProperty()->SetColor(0.5, 0.7, 1);
  cube->GetZMinusFaceProperty()->SetColor(0.5, 0.7, 1);
  axes->SetOrientationMarker(cube);
  axes->SetInteractor(widget->interactor());
  axes->SetViewport(kCube.left, kCube.bottom, kCube.right, kCube.top);
}

void SceneView::View::place_labels() {
  const int* const size = renderer->GetSize();
  std::vector<ScreenBox> furniture{scale_bar->box(*renderer)};
  for (const ScreenBox& share : {kBar, kCube})
    furniture.push_back(
        {share.left * size[0], share.bottom * size[1], share.right * size[0], share.top * size[1]});
  labels.place(*renderer, furniture);
}

void SceneView::make_tools() {
  tools_ = new ToolRow("moreOfScene",
                       tr("Drawing of the flame, exposure, cut, direction of view, picture"), this);
  auto* group = new QActionGroup(this);
  const std::array<std::array<QString, 2>, 5> parts{
      {{tr("Scene"), tr("Flame and camera from the side")},
       {tr("Flame"), tr("The flame as large as it fits")},
       {tr("Camera"), tr("Main lens to sensor")},
       {tr("Array"), tr("A few microlenses and the pixels behind them")},
       {tr("Pixel"), tr("The microlens in front of the selected pixel")}}};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    auto* action = new QAction(parts[i][0], this);
    action->setObjectName("view" + parts[i][0]);
    action->setToolTip(parts[i][1]);
    action->setCheckable(true);
    action->setChecked(i == 0);
    group->addAction(action);
    tools_->add(button_for(action, tools_));
    part_actions_[i] = action;
    connect(action, &QAction::triggered, this,
            [this, i] { emit part_requested(static_cast<int>(i)); });
  }
  section_mode_ = new QAction(tr("Section"), this);
  section_mode_->setObjectName("viewSection");
  section_mode_->setToolTip(tr("The section through the optical axis, with names; again: 3-D"));
  section_mode_->setCheckable(true);
  section_mode_->setVisible(false);
  auto* section = button_for(section_mode_, tools_);
  section->hide();
  tools_->add(section);
  connect(section_mode_, &QAction::toggled, this, &SceneView::show_section);
  connect(section_mode_, &QAction::changed, section,
          [this, section] { section->setVisible(section_mode_->isVisible()); });
  const auto tool = [&](Glyph glyph, const QString& text, const char* name, const QString& tip) {
    auto* action = new QAction(glyph_icon(glyph), text, this);
    action->setObjectName(name);
    action->setToolTip(tip);
    space_tools_.push_back(button_for(action, tools_, true));
    tools_->add(space_tools_.back());
    return action;
  };
  shortened_ = tool(Glyph::shortened, tr("Shorten gaps"), "shortenGaps",
                    tr("Long empty stretches between flame, main lens and array are drawn short; "
                       "otherwise the whole scene is to scale"));
  shortened_->setCheckable(true);
  shortened_->setChecked(true);
  connect(shortened_, &QAction::toggled, this, &SceneView::draw_to_scale);
  move_ = tool(Glyph::hand, tr("Move"), "moveThings",
               tr("Handles to drag flames and camera by, to scale; one drag is one step to undo"));
  move_->setCheckable(true);
  light_ = tool(Glyph::light, tr("Light"), "runLight",
                tr("Light runs along the rays, from the scene to the sensor"));
  light_->setCheckable(true);
  connect(light_, &QAction::toggled, this, &SceneView::run_light);
  measure_ =
      tool(Glyph::ruler, tr("Measure"), "measure",
           tr("Distance between two clicks, in the plane through the middle of the view [m]"));
  measure_->setCheckable(true);
  connect(measure_, &QAction::toggled, this, [this](bool on) {
    view_->ruler->SetWidgetStateToStart();
    view_->ruler->SetEnabled(on ? 1 : 0);
    if (on) move_->setChecked(false);
    emit measured_changed(0);
    draw_to_scale();
  });
  connect(move_, &QAction::toggled, this, [this](bool on) {
    if (on) measure_->setChecked(false);
    draw_to_scale();
    place_handles();
  });
  make_drawing_tools();
  auto* const picture = new QAction(glyph_icon(Glyph::picture), tr("Picture..."), this);
  picture->setObjectName("scenePicture");
  picture->setToolTip(tr("Save this view as a picture"));
  connect(picture, &QAction::triggered, this, &SceneView::picture_requested);
  tools_->add_spare(button_for(picture, tools_, true));
}

void SceneView::set_section(QWidget* section) {
  section_ = section;
  section_->hide();
  static_cast<QVBoxLayout*>(layout())->addWidget(section_, 1);
  section_mode_->setVisible(true);
}

bool SceneView::shows_section() const {
  return section_mode_->isChecked();
}

void SceneView::show_section(bool on) {
  section_mode_->setChecked(on);
  view_->widget->setVisible(!on);
  section_->setVisible(on);
  for (QWidget* const tool : space_tools_) tool->setVisible(!on);
  tools_->show_spare(!on);
}

/// Choices of the flame's drawing, of what is cut away of it, and from where it is seen.
void SceneView::make_drawing_tools() {
  auto* const tools = new QWidget(tools_);
  drawing_ = new QComboBox(tools_);
  drawing_->setObjectName("flameDrawing");
  drawing_->addItems({tr("As seen"), tr("Emission"), tr("Absorption"), tr("Surfaces")});
  drawing_->setToolTip(
      tr("What makes the flame visible: its light in the colours that eyes see, or, in colours of "
         "temperature, its light, its soot, or surfaces of equal temperature"));
  exposure_ = new QDoubleSpinBox(tools_);
  exposure_->setObjectName("flameExposure");
  exposure_->setRange(-10, 10);
  exposure_->setDecimals(1);
  exposure_->setSingleStep(0.5);
  exposure_->setSuffix(tr(" stops"));
  exposure_->setKeyboardTracking(false);
  exposure_->setToolTip(
      tr("Exposure of the flame as it is seen: 0 is automatic, +1 is twice as "
         "bright"));
  cut_ = new QComboBox(tools_);
  cut_->setObjectName("flameCut");
  cut_->addItems({tr("Whole"), tr("Cut x"), tr("Cut y"), tr("Cut z")});
  cut_->setToolTip(tr("Leaves away what lies beyond a plane across an axis of the world"));
  housing_ = new QComboBox(tools_);
  housing_->setObjectName("cameraHousing");
  housing_->addItems({tr("No housing"), tr("Housing cut open"), tr("Housing closed")});
  housing_->setCurrentIndex(static_cast<int>(Housing::cut_open));
  housing_->setToolTip(tr("A body around the camera, which no scene describes"));
  cut_place_ = new QSlider(Qt::Horizontal, tools);
  cut_place_->setObjectName("flameCutPlace");
  cut_place_->setRange(1, 99);
  cut_place_->setValue(50);
  cut_place_->setEnabled(false);
  cut_place_->setMinimumWidth(40);
  cut_place_->setToolTip(tr("Where the plane is"));
  auto* row = new QHBoxLayout(tools);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(3);
  row->addWidget(cut_place_, 1);
  for (int axis = 0; axis < 3; ++axis) {
    auto* along = new QToolButton(tools);
    const QString name("XYZ"[axis]);
    along->setObjectName("along" + name);
    along->setText(name);
    along->setAutoRaise(true);
    along->setToolTip(
        tr("Looks along the %1 axis of the world; again: from the other side").arg(name));
    row->addWidget(along);
    connect(along, &QToolButton::clicked, this, [this, axis] { look_along(axis); });
  }
  const auto chosen = QOverload<int>::of(&QComboBox::currentIndexChanged);
  connect(drawing_, chosen, this, [this](int index) {
    FlameLook look = look_;
    look.drawing = static_cast<FlameDrawing>(index);
    emit look_edited(look, tr("drawing of the flame"));
  });
  connect(exposure_, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
          [this](double stops) {
            FlameLook look = look_;
            look.exposure = stops;
            emit look_edited(look, tr("exposure of the flame"));
          });
  connect(cut_, chosen, this, [this](int index) {
    cut_place_->setEnabled(index > 0);
    add_flame();
    render();
  });
  connect(housing_, chosen, this, [this] {
    if (!geometry_) return;
    add_housings();
    if (is_as_aimed() && !along_axis_) aim();
    render();
  });
  connect(cut_place_, &QSlider::valueChanged, this, [this] {
    add_flame();
    render();
  });
  for (QWidget* const spare : {static_cast<QWidget*>(drawing_), static_cast<QWidget*>(exposure_),
                               static_cast<QWidget*>(cut_), tools, static_cast<QWidget*>(housing_)})
    tools_->add_spare(spare);
}

void SceneView::look_along(int axis) {
  if (!scene_ || !geometry_) return;
  std::array<double, 3> way{};
  view_->renderer->GetActiveCamera()->GetDirectionOfProjection(way.data());
  const auto k = static_cast<std::size_t>(axis);
  Vec3 direction;
  // ParaView's habit: from the positive side, then from the other one.
  const double sign = way[k] < -0.99 ? 1 : -1;
  (axis == 0 ? direction.x : axis == 1 ? direction.y : direction.z) = sign;
  const Vec3 up = axis == 2 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  Vec3 from;
  look(drawn_subject(from), direction, up);
  along_axis_ = true;
  render();
}

bool SceneView::shows_eye() const {
  return look_.drawing == FlameDrawing::eye && (view_->eye->has_light() || !light_known_);
}

void SceneView::add_flame() {
  if (!geometry_) return;
  const vtkSmartPointer<vtkImageData> flame = placed(geometry_->flame, schematic_);
  exposure_->setEnabled(look_.drawing == FlameDrawing::eye);
  if (geometry_->flame) {
    const auto vec = [](const double* p) { return Vec3{p[0], p[1], p[2]}; };
    std::array<double, 6> box{};
    geometry_->flame->GetBounds(box.data());
    Box kept{{-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}};
    const double share = cut_place_->value() / 100.0;
    const int axis = cut_->currentIndex() - 1;
    if (axis == 0) kept.upper.x = box[0] + (box[1] - box[0]) * share;
    if (axis == 1) kept.upper.y = box[2] + (box[3] - box[2]) * share;
    if (axis == 2) kept.upper.z = box[4] + (box[5] - box[4]) * share;
    view_->eye->set_shift(vec(flame->GetOrigin()) - vec(geometry_->flame->GetOrigin()));
    view_->eye->set_look(look_.exposure, kept);
  }
  view_->replace("flame", [&](vtkRenderer& renderer) {
    if (flame && !shows_eye()) add_volume(*flame, renderer);
  });
  for (const auto& prop : view_->layers["flame"])
    if (auto* bar = vtkScalarBarActor::SafeDownCast(prop)) set_bar_style(*bar);
  show_flame();
}

/// Or hides it, with parts that it is none of.
void SceneView::show_flame() {
  view_->eye->set_visible(geometry_ && geometry_->flame && shows_eye() && shows_flame());
  view_->show("flame", shows_flame());
}

/// The flame by a quantity, in colours of its temperature.
void SceneView::add_volume(vtkImageData& flame, vtkRenderer& renderer) {
  const double cold = look_.automatic ? temperatures_[0] : look_.cold,
               hot = look_.automatic ? temperatures_[1] : look_.hot;
  auto colours = views::temperature_colours(flame);
  colours->RemoveAllPoints();
  constexpr int kStops = 17;
  for (int i = 0; i < kStops; ++i) {
    const double t = static_cast<double>(i) / (kStops - 1);
    const Rgb c = flame_colour(look_.map, t);
    colours->AddRGBPoint(cold + t * (hot - cold), c.red / 255.0, c.green / 255.0, c.blue / 255.0);
  }
  // Flames that give no light to see are drawn by what else there is.
  const FlameDrawing drawing =
      look_.drawing == FlameDrawing::eye ? FlameDrawing::emission : look_.drawing;
  const int axis = cut_->currentIndex() - 1;
  std::array<double, 6> box{};
  flame.GetBounds(box.data());
  if (axis >= 0) {
    const auto k = 2 * static_cast<std::size_t>(axis);
    box[k + 1] = box[k] + (box[k + 1] - box[k]) * cut_place_->value() / 100.0;
  }
  if (drawing == FlameDrawing::surfaces) {
    for (std::size_t i = 0; i < kSurfaces.size(); ++i) {
      const auto surface =
          surface_of(flame, cold + kSurfaces[i] * (hot - cold), *colours,
                     std::clamp((0.15 + 0.25 * static_cast<double>(i)) * look_.density, 0.02, 1.0));
      if (axis >= 0) {
        vtkNew<vtkPlane> plane;
        std::array<double, 3> normal{}, origin{};
        normal[static_cast<std::size_t>(axis)] = -1;
        origin[static_cast<std::size_t>(axis)] = box[2 * static_cast<std::size_t>(axis) + 1];
        plane->SetNormal(normal.data());
        plane->SetOrigin(origin.data());
        surface->GetMapper()->AddClippingPlane(plane);
      }
      renderer.AddActor(surface);
    }
  } else {
    const auto drawn =
        drawing == FlameDrawing::emission ? shining(flame) : vtkSmartPointer<vtkImageData>(&flame);
    const auto volume = views::flame_volume(*drawn, colours);
    FlameLook look = look_;
    // Shining places are to be seen as such: thin hot sheets of it, too.
    if (drawing == FlameDrawing::emission) look.density *= kShine;
    apply_opacity(look, cold, hot, *volume);
    if (axis >= 0) cut_volume(*volume, axis, box[2 * static_cast<std::size_t>(axis) + 1]);
    if (auto* mapper = vtkFixedPointVolumeRayCastMapper::SafeDownCast(volume->GetMapper())) {
      mapper->SetAutoAdjustSampleDistances(1);
      mapper->SetMinimumImageSampleDistance(1);
      mapper->SetMaximumImageSampleDistance(8);
    }
    renderer.AddVolume(volume);
  }
  // A clear flame may have no temperatures to tell.
  if (flame.GetPointData()->GetArray("temperature")->GetRange()[1] > 0)
    views::add_temperature_bar(colours, renderer);
}

}  // namespace plenoflame::desktop
