#include "widgets/image/ruler.h"

#include <vtkAxisActor2D.h>
#include <vtkDistanceRepresentation2D.h>
#include <vtkDistanceWidget.h>
#include <vtkFocalPlanePointPlacer.h>
#include <vtkHandleRepresentation.h>
#include <vtkNew.h>
#include <vtkProperty2D.h>
#include <vtkTextProperty.h>

#include <array>

#include "plenoflame/math/vector.h"

namespace plenoflame::desktop {
namespace {

vtkDistanceRepresentation2D* shape_of(vtkDistanceWidget& ruler) {
  return vtkDistanceRepresentation2D::SafeDownCast(ruler.GetRepresentation());
}

}  // namespace

void set_up_ruler(vtkDistanceWidget& ruler) {
  ruler.CreateDefaultRepresentation();
  auto* const shape = shape_of(ruler);
  if (!shape) return;
  // Clicks are places in the plane through the focal point; VTK would put them on the near plane.
  vtkNew<vtkFocalPlanePointPlacer> placer;
  shape->InstantiateHandleRepresentation();
  shape->GetPoint1Representation()->SetPointPlacer(placer);
  shape->GetPoint2Representation()->SetPointPlacer(placer);
  vtkTextProperty& style = *shape->GetAxis()->GetTitleTextProperty();
  style.BoldOff();
  style.ItalicOff();
  style.ShadowOff();
}

void set_ruler_dark(vtkDistanceWidget& ruler, bool dark) {
  auto* const shape = shape_of(ruler);
  if (!shape) return;
  const double ink = dark ? 0.95 : 0.1;
  shape->GetAxis()->GetProperty()->SetColor(ink, ink, ink);
  shape->GetAxis()->GetTitleTextProperty()->SetColor(ink, ink, ink);
}

void set_ruler_text(vtkDistanceWidget& ruler, const std::string& text) {
  // The representation writes the distance by a format for printf: here it is the text itself.
  if (auto* const shape = shape_of(ruler)) shape->SetLabelFormat(text.c_str());
}

double ruler_length(vtkDistanceWidget& ruler) {
  auto* const shape = shape_of(ruler);
  if (!shape) return 0;
  std::array<double, 3> a{}, b{};
  shape->GetPoint1WorldPosition(a.data());
  shape->GetPoint2WorldPosition(b.data());
  return length(Vec3{a[0] - b[0], a[1] - b[1], a[2] - b[2]});
}

}  // namespace plenoflame::desktop
