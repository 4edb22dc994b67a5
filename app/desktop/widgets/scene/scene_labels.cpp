#include "widgets/scene/scene_labels.h"

#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "picture_annotation.h"

namespace plenoflame::desktop {
namespace {

constexpr double kPixelsPerInch = 72;  ///< of a screen where a pixel of the layout is one of it
constexpr double kGap = 4;             ///< [layout pixel] between a thing and its text, and texts
constexpr double kLeaderInk = 0.6;     ///< grey of lines from texts to their things
constexpr int kRings = 8;              ///< steps away from the thing, each of a line's height
constexpr double kWorst = 1e6;         ///< cost of covering a text or mark, or leaving the view
constexpr double kBad = 30;            ///< cost of covering another thing
constexpr double kStep = 400;          ///< cost of a step away, beside which a corner costs one

ScreenBox seen(const std::vector<Vec3>& points, vtkRenderer& renderer) {
  ScreenBox box;
  for (const Vec3& p : points) {
    renderer.SetWorldPoint(p.x, p.y, p.z, 1);
    renderer.WorldToDisplay();
    const double* const place = renderer.GetDisplayPoint();
    if (place[2] <= 1) box.add(place[0], place[1]);  // else it is behind the eye
  }
  return box;
}

ScreenBox grown(const ScreenBox& box, double by) {
  return {box.left - by, box.bottom - by, box.right + by, box.top + by};
}

}  // namespace

void set_text_ground(vtkTextProperty& style) {
  style.SetBackgroundColor(views::kBackground.data());
  style.SetBackgroundOpacity(kTextGround);
}

void ScreenBox::add(double x, double y) {
  left = std::min(left, x);
  right = std::max(right, x);
  bottom = std::min(bottom, y);
  top = std::max(top, y);
}

double ScreenBox::overlap(const ScreenBox& other) const {
  const double wide = std::min(right, other.right) - std::max(left, other.left);
  const double high = std::min(top, other.top) - std::max(bottom, other.bottom);
  return wide > 0 && high > 0 ? wide * high : 0;
}

void SceneLabels::clear() {
  labels_.clear();
  things_.clear();
  leaders_ = nullptr;
}

void SceneLabels::add(const std::string& text, std::vector<Vec3> beside, int font_size,
                      vtkRenderer& renderer) {
  if (!leaders_) {
    leaders_ = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPolyDataMapper2D> mapper;
    mapper->SetInputData(leaders_);
    vtkNew<vtkActor2D> lines;
    lines->SetMapper(mapper);
    lines->GetProperty()->SetColor(kLeaderInk, kLeaderInk, kLeaderInk);
    renderer.AddActor2D(lines);
  }
  auto actor = vtkSmartPointer<vtkTextActor>::New();
  actor->SetInput(text.c_str());
  views::set_typeface(*actor->GetTextProperty());
  actor->GetTextProperty()->SetFontSize(font_size);
  actor->GetTextProperty()->SetColor(0.85, 0.87, 0.9);
  set_text_ground(*actor->GetTextProperty());
  renderer.AddActor2D(actor);
  labels_.push_back({actor, std::move(beside)});
}

void SceneLabels::avoid(std::vector<Vec3> thing, Keep keep) {
  things_.push_back({std::move(thing), keep});
}

void SceneLabels::place(vtkRenderer& renderer, const std::vector<ScreenBox>& furniture) const {
  if (labels_.empty()) return;
  const int *const size = renderer.GetSize(), *const corner = renderer.GetOrigin();
  const double gap = kGap * renderer.GetRenderWindow()->GetDPI() / kPixelsPerInch;
  ScreenBox view;
  for (const int end : {0, 1}) view.add(corner[0] + end * size[0], corner[1] + end * size[1]);
  std::vector<ScreenBox> taken = furniture, other;
  vtkNew<vtkPoints> ends;
  vtkNew<vtkCellArray> lines;
  for (const Thing& thing : things_)
    (thing.keep == Keep::off ? taken : other).push_back(seen(thing.points, renderer));
  for (const Label& label : labels_) {
    const ScreenBox thing = seen(label.beside, renderer);
    const bool in_view = thing.left <= view.right && thing.right >= view.left &&
                         thing.bottom <= view.top && thing.top >= view.bottom;
    label.actor->SetVisibility(in_view);
    if (!in_view) continue;
    std::array<double, 4> text{};
    label.actor->GetBoundingBox(&renderer, text.data());
    const double wide = text[1] - text[0] + 1, high = text[3] - text[2] + 1;
    const double middle_x = 0.5 * (thing.left + thing.right - wide),
                 middle_y = 0.5 * (thing.bottom + thing.top - high);
    double least = 1e300;
    ScreenBox best;
    for (int ring = 0; ring < kRings; ++ring) {
      const double away = gap + ring * high;
      const std::array<double, 3> x{middle_x, thing.right + away, thing.left - away - wide};
      const std::array<double, 3> y{thing.top + away, thing.bottom - away - high, middle_y};
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
          if (i == 0 && k == 2) continue;  // on the thing itself
          const ScreenBox here{x[i], y[k], x[i] + wide, y[k] + high};
          double cost = kStep * ring + (i > 0 && k < 2 ? kStep : 0);
          cost += static_cast<double>(i + k);  // above, below, beside, in this order
          cost += kWorst * (wide * high - here.overlap(view));
          for (const ScreenBox& box : taken) cost += kWorst * grown(here, gap).overlap(box);
          for (const ScreenBox& box : other) cost += kBad * here.overlap(box);
          if (cost >= least) continue;
          least = cost;
          best = here;
        }
    }
    taken.push_back(best);
    // From the middle of the text's side to the nearest place of the thing.
    const auto near = [](double at, double low, double high_end) {
      return std::clamp(at, low, std::max(low, high_end));
    };
    const double to_x = near(0.5 * (best.left + best.right), thing.left, thing.right),
                 to_y = near(0.5 * (best.bottom + best.top), thing.bottom, thing.top);
    const double from_x = near(to_x, best.left, best.right),
                 from_y = near(to_y, best.bottom, best.top);
    if (std::hypot(to_x - from_x, to_y - from_y) > std::max(high, 2 * gap)) {
      const vtkIdType first = ends->InsertNextPoint(from_x - corner[0], from_y - corner[1], 0);
      ends->InsertNextPoint(to_x - corner[0], to_y - corner[1], 0);
      lines->InsertNextCell({first, first + 1});
    }
    label.actor->SetDisplayPosition(static_cast<int>(best.left - text[0]),
                                    static_cast<int>(best.bottom - text[2]));
  }
  leaders_->SetPoints(ends);
  leaders_->SetLines(lines);
}

}  // namespace plenoflame::desktop
