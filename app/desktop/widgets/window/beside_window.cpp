#include "widgets/window/beside_window.h"

#include <QVTKOpenGLNativeWidget.h>
#include <vtkActor.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkColorTransferFunction.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkFloatArray.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkImageData.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkVolume.h>

#include <QComboBox>
#include <QLabel>
#include <QSignalBlocker>
#include <QVBoxLayout>
#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "colour_map.h"
#include "flame_volume.h"
#include "picture_annotation.h"
#include "picture_camera.h"
#include "plenoflame/base/units.h"
#include "widgets/scene/scene_labels.h"

namespace plenoflame::desktop {
namespace {

using Fields = ReconstructFields;

constexpr double kBarTop = 0.14, kTitleBottom = 0.93;  ///< shares of the view's height
constexpr double kEdgeInk = 0.5;
constexpr float kSampleShare = 0.25F;  ///< of a voxel, between samples
constexpr int kLabelSize = 14;

const Fields::Field* field_named(const Fields& fields, const std::string& name) {
  for (const Fields::Field& field : fields.fields)
    if (field.name == name) return &field;
  return nullptr;
}

/// Corners of the box in which the flame was looked for [m]. Number 4 i + 2 k + l is at the upper
/// end of x, y and z where i, k and l are 1.
std::vector<Vec3> corners_of(const VoxelPlace& place) {
  std::vector<Vec3> corners;
  const auto at = [](double first, double spacing, std::size_t cells, int end) {
    return first + spacing * (end * static_cast<double>(cells) - 0.5);
  };
  for (const int x : {0, 1})
    for (const int y : {0, 1})
      for (const int z : {0, 1})
        corners.push_back({at(place.origin.x, place.spacing[0], place.size[0], x),
                           at(place.origin.y, place.spacing[1], place.size[1], y),
                           at(place.origin.z, place.spacing[2], place.size[2], z)});
  return corners;
}

/// The edges of this box, three of them with their lengths.
void add_box(const std::vector<Vec3>& corners, SceneLabels& labels, vtkRenderer& renderer) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> edges;
  for (const Vec3& corner : corners) points->InsertNextPoint(corner.x, corner.y, corner.z);
  for (vtkIdType from = 0; from < 8; ++from)
    for (const vtkIdType axis : {1, 2, 4})
      if ((from & axis) == 0) edges->InsertNextCell({from, from | axis});
  vtkNew<vtkPolyData> box;
  box->SetPoints(points);
  box->SetLines(edges);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(box);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(kEdgeInk, kEdgeInk, kEdgeInk);
  actor->GetProperty()->LightingOff();
  renderer.AddActor(actor);
  labels.clear();
  // Edges at the rim of the box as it is seen first.
  for (const auto& [name, from, to] : {std::tuple{"x ", 0U, 4U}, {"y ", 4U, 6U}, {"z ", 0U, 1U}})
    labels.add(name + readable_quantity(length(corners[to] - corners[from]), Dimension::length, 3),
               {0.5 * (corners[from] + corners[to])}, kLabelSize, renderer);
}

/// Values as a VTK volume. @param density how visible each place is
vtkSmartPointer<vtkImageData> image_of(const VoxelPlace& place, const std::vector<float>& values,
                                       const std::vector<float>& density) {
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(static_cast<int>(place.size[0]), static_cast<int>(place.size[1]),
                       static_cast<int>(place.size[2]));
  image->SetOrigin(place.origin.x, place.origin.y, place.origin.z);
  image->SetSpacing(place.spacing[0], place.spacing[1], place.spacing[2]);
  for (const auto& [name, of] : {std::pair{"temperature", &values}, {"absorption", &density}}) {
    vtkNew<vtkFloatArray> array;
    array->SetName(name);
    array->SetNumberOfValues(static_cast<vtkIdType>(of->size()));
    std::copy(of->begin(), of->end(), array->GetPointer(0));
    image->GetPointData()->AddArray(array);
  }
  return image;
}

}  // namespace

struct BesideWindow::View {
  QVTKOpenGLNativeWidget* widget = nullptr;
  vtkNew<vtkGenericOpenGLRenderWindow> window;
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  std::array<vtkSmartPointer<vtkRenderer>, 2> renderers;
  std::array<SceneLabels, 2> labels;
  vtkNew<vtkCallbackCommand> before_drawing;
  bool aimed = false;
};

BesideWindow::BesideWindow(QWidget* parent)
    : QDialog(parent), view_(std::make_unique<View>()), field_(new QComboBox(this)) {
  setObjectName("besideWindow");
  setWindowTitle(tr("Found beside the scene"));
  field_->setObjectName("besideField");
  field_->setToolTip(tr("The field that gives the colours"));
  View& v = *view_;
  v.widget = new QVTKOpenGLNativeWidget(this);
  v.widget->setObjectName("beside3d");
  v.widget->setRenderWindow(v.window);
  v.window->SetMultiSamples(0);
  v.before_drawing->SetClientData(&v);
  v.before_drawing->SetCallback([](vtkObject* drawn, unsigned long, void* drawn_by, void*) {
    const View& view = *static_cast<View*>(drawn_by);
    const std::size_t side = drawn == view.renderers[1] ? 1 : 0;
    const int* const size = view.window->GetSize();
    const double middle = 0.5 * size[0], low = kBarTop * size[1], high = kTitleBottom * size[1];
    const double left = side == 0 ? 0 : middle;
    view.labels[side].place(
        *view.renderers[side],
        {{left, 0, left + middle, low}, {left, high, left + middle, static_cast<double>(size[1])}});
  });
  for (std::size_t side : {0U, 1U}) {
    v.renderers[side] = vtkSmartPointer<vtkRenderer>::New();
    v.renderers[side]->SetViewport(0.5 * static_cast<double>(side), 0,
                                   0.5 + 0.5 * static_cast<double>(side), 1);
    v.renderers[side]->SetBackground(0.04, 0.04, 0.05);
    v.renderers[side]->AddObserver(vtkCommand::StartEvent, v.before_drawing);
    v.window->AddRenderer(v.renderers[side]);
  }
  // One camera: what is turned in one half is turned in both.
  v.renderers[1]->SetActiveCamera(v.renderers[0]->GetActiveCamera());
  v.widget->interactor()->SetInteractorStyle(v.style);
  auto* layout = new QVBoxLayout(this);
  layout->addWidget(field_, 0, Qt::AlignLeft);
  layout->addWidget(v.widget, 1);
  layout->addWidget(new QLabel(tr("Drag turns both, the wheel zooms."), this));
  resize(900, 560);
  connect(field_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &BesideWindow::draw);
}

BesideWindow::~BesideWindow() = default;

void BesideWindow::set_fields(std::shared_ptr<const ReconstructFields> fields) {
  fields_ = std::move(fields);
  const QSignalBlocker quiet(field_);
  const QString before = field_->currentText();
  field_->clear();
  for (const auto& field : fields_->fields)
    if (!field.truth.empty() || fields_->fields.size() == 1)
      field_->addItem(QString::fromStdString(field.name));
  if (field_->count() == 0)
    for (const auto& field : fields_->fields) field_->addItem(QString::fromStdString(field.name));
  field_->setCurrentIndex(std::max(0, field_->findText(before)));
  draw();
}

void BesideWindow::draw() {
  if (!fields_) return;
  const Fields::Field* const field = field_named(*fields_, field_->currentText().toStdString());
  if (!field) return;
  // The opacity of a place follows its emission, as for eyes.
  const Fields::Field* const emission = field_named(*fields_, "emission");
  const bool is_temperature = field->name == "temperature";
  vtkNew<vtkColorTransferFunction> colours;
  const double low = is_temperature ? 0.5 * field->largest : 0;
  constexpr int kStops = 17;
  for (int i = 0; i < kStops; ++i) {
    const double t = static_cast<double>(i) / (kStops - 1);
    const Rgb c = flame_colour(ColourMap::inferno, t);
    colours->AddRGBPoint(low + t * (field->largest - low), c.red / 255.0, c.green / 255.0,
                         c.blue / 255.0);
  }
  for (std::size_t side : {0U, 1U}) {
    vtkRenderer& renderer = *view_->renderers[side];
    renderer.RemoveAllViewProps();
    const std::vector<float>& values = side == 0 ? field->found : field->truth;
    const std::vector<float>* density = &values;
    if (emission && !(side == 0 ? emission->found : emission->truth).empty())
      density = side == 0 ? &emission->found : &emission->truth;
    if (!values.empty()) {
      const auto image = image_of(fields_->place, values, *density);
      const auto volume = views::flame_volume(*image, colours);
      // With a sample in each voxel, voxels that are seen aslant have stripes.
      if (auto* mapper = vtkFixedPointVolumeRayCastMapper::SafeDownCast(volume->GetMapper())) {
        mapper->SetSampleDistance(kSampleShare * mapper->GetSampleDistance());
        mapper->SetInteractiveSampleDistance(mapper->GetSampleDistance());
      }
      renderer.AddVolume(volume);
    }
    add_box(corners_of(fields_->place), view_->labels[side], renderer);
    vtkNew<vtkTextActor> title;
    title->SetInput(side == 0        ? "found"
                    : values.empty() ? "in the scene: not known"
                                     : "in the scene");
    views::set_typeface(*title->GetTextProperty());
    title->GetTextProperty()->SetFontSize(18);
    title->GetTextProperty()->SetColor(0.92, 0.92, 0.92);
    title->GetTextProperty()->SetVerticalJustificationToTop();
    title->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
    title->SetPosition(0.02, 0.98);
    renderer.AddActor2D(title);
  }
  vtkNew<vtkScalarBarActor> bar;
  bar->SetLookupTable(colours);
  // The empty line keeps the title above the labels.
  bar->SetTitle((field->name + " [" + field->unit + "]\n ").c_str());
  bar->SetNumberOfLabels(4);
  bar->SetMaximumNumberOfColors(256);  // the map's own, with no steps to be seen
  bar->SetLabelFormat("%.4g");
  bar->SetUnconstrainedFontSize(true);
  for (auto* style : {bar->GetTitleTextProperty(), bar->GetLabelTextProperty()}) {
    views::set_typeface(*style);
    style->SetFontSize(14);
    style->SetColor(0.92, 0.92, 0.92);
    style->BoldOff();
    style->ItalicOff();
    style->ShadowOff();
  }
  bar->SetOrientationToHorizontal();
  bar->SetPosition(0.2, 0.01);
  bar->SetWidth(0.6);
  bar->SetHeight(0.13);
  view_->renderers[1]->AddActor2D(bar);
  if (!view_->aimed) {
    views::look_at(corners_of(fields_->place), {-0.8, 0.5, -0.25}, {0, 0, 1}, 0.9, 10,
                   *view_->renderers[0]);
    view_->renderers[0]->GetActiveCamera()->SetWindowCenter(0, -kBarTop);  // above the bar
    view_->aimed = true;
  }
  view_->window->Render();
}

QImage BesideWindow::picture() {
  view_->window->Render();
  return view_->widget->grabFramebuffer();
}

}  // namespace plenoflame::desktop
