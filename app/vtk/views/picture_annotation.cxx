#include "picture_annotation.h"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkColorTransferFunction.h>
#include <vtkNew.h>
#include <vtkOpenGLPolyDataMapper.h>
#include <vtkOpenGLVertexBufferObject.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <system_error>

namespace plenoflame::views {
namespace {

constexpr double kInk = 0.88;  ///< grey of texts
constexpr int kLabelGap = 4;   ///< [pixel] between a scale and its labels
constexpr int kTitleGap = 10;  ///< more than that: from its labels to its title

void set_text_style(vtkTextProperty& style, int font_size) {
  set_typeface(style);
  style.SetFontSize(font_size);
  style.SetColor(kInk, kInk, kInk);
}

/// May stand before anything.
void set_plate(vtkTextProperty& style, double opacity) {
  style.SetBackgroundColor(kBackground[0], kBackground[1], kBackground[2]);
  style.SetBackgroundOpacity(opacity);
}

/// At the left edge. @param y of its lower or, `from_top`, its upper end, in heights of the picture
void add_text(const std::string& text, double y, bool from_top, int font_size,
              const double (&rgb)[3], vtkRenderer& renderer) {
  vtkNew<vtkTextActor> actor;
  actor->SetInput(text.c_str());
  set_text_style(*actor->GetTextProperty(), font_size);
  actor->GetTextProperty()->SetColor(rgb[0], rgb[1], rgb[2]);
  set_plate(*actor->GetTextProperty(), 0.8);
  if (from_top) actor->GetTextProperty()->SetVerticalJustificationToTop();
  actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  actor->SetPosition(0.015, y);
  renderer.AddActor2D(actor);
}

/// Before everything: no solid hides it.
vtkTextProperty& add_world_text(const std::string& text, Vec3 place, int font_size,
                                const std::array<double, 3>& rgb, vtkRenderer& renderer) {
  vtkNew<vtkTextActor> label;
  label->SetInput(text.c_str());
  label->GetPositionCoordinate()->SetCoordinateSystemToWorld();
  label->GetPositionCoordinate()->SetValue(place.x, place.y, place.z);
  set_text_style(*label->GetTextProperty(), font_size);
  label->GetTextProperty()->SetColor(rgb[0], rgb[1], rgb[2]);
  set_plate(*label->GetTextProperty(), 0.65);  // rays are seen through it
  renderer.AddActor2D(label);
  return *label->GetTextProperty();
}

}  // namespace

void set_typeface(vtkTextProperty& style) {
  static constexpr const char* kFile = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
  std::error_code ignored;
  if (!std::filesystem::exists(kFile, ignored)) return style.SetFontFamilyToArial();
  style.SetFontFamily(VTK_FONT_FILE);
  style.SetFontFile(kFile);
}

std::string length_label(double metres) {
  struct Unit {
    double size;
    const char* name;
  };
  for (const Unit unit : std::array<Unit, 4>{{{1, "m"}, {1e-3, "mm"}, {1e-6, "um"}, {1e-9, "nm"}}})
    if (metres >= unit.size * (1 - 1e-9)) {
      std::array<char, 40> text{};
      std::snprintf(text.data(), text.size(), "%.3g %s", metres / unit.size, unit.name);
      return text.data();
    }
  return "0 m";
}

void add_axes(Vec3 origin, double length, Vec3 right, Vec3 up, int font_size,
              vtkRenderer& renderer) {
  const std::array<Vec3, 3> directions{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const std::array<std::array<double, 3>, 3> colours{
      {{0.95, 0.45, 0.4}, {0.55, 0.85, 0.45}, {0.5, 0.7, 1}}};
  const std::array<const char*, 3> names{"x", "y", "z"};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 end = origin + length * directions[k];
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->InsertNextPoint(origin.x, origin.y, origin.z);
    points->InsertNextPoint(end.x, end.y, end.z);
    vtkNew<vtkCellArray> lines;
    const std::array<vtkIdType, 2> ids{0, 1};
    lines->InsertNextCell(2, ids.data());
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetLines(lines);
    vtkNew<vtkOpenGLPolyDataMapper> mapper;
    mapper->SetInputData(data);
    mapper->SetVBOShiftScaleMethod(vtkOpenGLVertexBufferObject::ALWAYS_AUTO_SHIFT_SCALE);
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(colours[k][0], colours[k][1], colours[k][2]);
    actor->GetProperty()->LightingOff();
    actor->GetProperty()->SetLineWidth(2);
    renderer.AddActor(actor);
    vtkTextProperty& style = add_world_text(std::string(names[k]) + "  " + length_label(length),
                                            end, font_size, colours[k], renderer);
    // The text begins where the axis ends, so that the line does not cross it.
    const double across = dot(directions[k], right), upward = dot(directions[k], up);
    if (across < 0) style.SetJustificationToRight();
    if (upward < 0) style.SetVerticalJustificationToTop();
  }
}

void add_label(const std::string& text, Vec3 place, int font_size, vtkRenderer& renderer) {
  add_world_text(text, place, font_size, {kInk, kInk, kInk}, renderer);
}

void add_temperature_bar(vtkColorTransferFunction* colours, vtkRenderer& renderer) {
  vtkNew<vtkScalarBarActor> bar;
  bar->SetLookupTable(colours);
  bar->SetTitle("Temperature (K)");
  bar->SetNumberOfLabels(5);
  bar->SetMaximumNumberOfColors(256);  // the map's own, with no steps to be seen
  bar->SetLabelFormat("%.0f");
  bar->SetOrientationToHorizontal();
  bar->SetTextPositionToPrecedeScalarBar();
  bar->UnconstrainedFontSizeOn();
  for (vtkTextProperty* style : {bar->GetTitleTextProperty(), bar->GetLabelTextProperty()}) {
    set_text_style(*style, 15);
    style->BoldOff();
    style->ItalicOff();
    style->ShadowOff();
  }
  bar->GetLabelTextProperty()->SetLineOffset(kLabelGap);
  bar->GetTitleTextProperty()->SetLineOffset(kTitleGap);
  bar->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  bar->SetPosition(0.66, 0.03);
  bar->SetWidth(0.3);
  bar->SetHeight(0.11);
  renderer.AddActor2D(bar);
}

void add_legend(const std::vector<LegendEntry>& entries, int font_size, vtkRenderer& renderer) {
  const double line = 1.5 * font_size / std::max(1, renderer.GetSize()[1]);
  double y = 0.02 + line * static_cast<double>(entries.size() - 1);
  for (const LegendEntry& entry : entries) {
    add_text(entry.text, y, false, font_size, entry.rgb, renderer);
    y -= line;
  }
}

void add_title(const std::string& text, int font_size, vtkRenderer& renderer) {
  add_text(text, 0.985, true, font_size, {kInk, kInk, kInk}, renderer);
}

}  // namespace plenoflame::views
