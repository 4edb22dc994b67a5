#include "widgets/image/scale_bar.h"

#include <vtkActor2D.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <array>
#include <cmath>
#include <numbers>

#include "picture_annotation.h"
#include "picture_camera.h"

namespace plenoflame::desktop {
namespace {

constexpr double kShare = 0.25;  ///< of the width, at most
constexpr double kLeft = 0.2;    ///< share of the width left of it, where the axes are
constexpr double kBottom = 12;   ///< [pixel]
constexpr double kTick = 5;      ///< [pixel] height of its ends
constexpr double kScaleInk = 0.85;

}  // namespace

ScaleBar::ScaleBar(vtkRenderer& renderer)
    : points_(vtkSmartPointer<vtkPoints>::New()),
      line_(vtkSmartPointer<vtkActor2D>::New()),
      text_(vtkSmartPointer<vtkTextActor>::New()) {
  points_->SetNumberOfPoints(4);
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell({0, 1, 2, 3});
  vtkNew<vtkPolyData> data;
  data->SetPoints(points_);
  data->SetLines(cells);
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(data);
  line_->SetMapper(mapper);
  line_->GetProperty()->SetColor(kScaleInk, kScaleInk, kScaleInk);
  line_->GetProperty()->SetLineWidth(2);
  views::set_typeface(*text_->GetTextProperty());
  text_->GetTextProperty()->SetFontSize(12);
  text_->GetTextProperty()->SetColor(kScaleInk, kScaleInk, kScaleInk);
  text_->GetTextProperty()->SetJustificationToCentered();
  set_text_ground(*text_->GetTextProperty());
  set_visible(false);
  renderer.AddActor2D(line_);
  renderer.AddActor2D(text_);
}

void ScaleBar::set_visible(bool on) {
  line_->SetVisibility(on);
  text_->SetVisibility(on);
}

void ScaleBar::update(vtkRenderer& renderer) {
  vtkCamera* const camera = renderer.GetActiveCamera();
  const int* const size = renderer.GetSize();
  const double height =
      camera->GetParallelProjection()
          ? 2 * camera->GetParallelScale()
          : 2 * camera->GetDistance() * std::tan(camera->GetViewAngle() * std::numbers::pi / 360);
  const double per_pixel = height / size[1];
  if (size[0] < 1 || size[1] < 1 || !(per_pixel > 0) || !std::isfinite(per_pixel)) return;
  length_ = views::round_length(kShare * size[0] * per_pixel);
  const double left = kLeft * size[0], right = left + length_ / per_pixel;
  points_->SetPoint(0, left, kBottom + kTick, 0);
  points_->SetPoint(1, left, kBottom, 0);
  points_->SetPoint(2, right, kBottom, 0);
  points_->SetPoint(3, right, kBottom + kTick, 0);
  points_->Modified();
  text_->SetInput(views::length_label(length_).c_str());
  text_->SetDisplayPosition(static_cast<int>(0.5 * (left + right)),
                            static_cast<int>(kBottom + 2 * kTick));
}

ScreenBox ScaleBar::box(vtkRenderer& renderer) const {
  ScreenBox box;
  for (vtkIdType i = 0; i < points_->GetNumberOfPoints(); ++i) {
    std::array<double, 3> p{};
    points_->GetPoint(i, p.data());
    box.add(p[0], p[1]);
  }
  std::array<double, 4> text{};
  text_->GetBoundingBox(&renderer, text.data());
  const double* const at = text_->GetPosition();
  box.add(at[0] + text[0], at[1] + text[2]);
  box.add(at[0] + text[1], at[1] + text[3]);
  return box;
}

}  // namespace plenoflame::desktop
