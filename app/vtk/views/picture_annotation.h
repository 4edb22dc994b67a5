#pragma once
#include <array>
#include <string>
#include <vector>

#include "plenoflame/math/vector.h"

class vtkColorTransferFunction;
class vtkRenderer;
class vtkTextProperty;

namespace plenoflame::views {

/// Behind everything, RGB: dark, as in the desktop application, so that what shines is the
/// brightest there is.
inline constexpr std::array<double, 3> kBackground{0.05, 0.055, 0.065};

/// DejaVu Sans, the typeface of all plots; VTK's own where it is not installed.
void set_typeface(vtkTextProperty& style);

/// "100 mm".
std::string length_label(double metres);

/// Axes of the world as three lines from `origin`, each `length` [m] long and labelled with it.
/// @param right, up of the picture: texts begin at the end of their axis
void add_axes(Vec3 origin, double length, Vec3 right, Vec3 up, int font_size,
              vtkRenderer& renderer);

/// A text at a place of the world, before everything.
void add_label(const std::string& text, Vec3 place, int font_size, vtkRenderer& renderer);

/// The scale of temperatures, in kelvin, at the right edge.
void add_temperature_bar(vtkColorTransferFunction* colours, vtkRenderer& renderer);

struct LegendEntry {
  std::string text;
  double rgb[3];
};

/// Coloured lines of text, one below the other, from the lower left corner upwards.
void add_legend(const std::vector<LegendEntry>& entries, int font_size, vtkRenderer& renderer);

/// A line of text in the upper left corner.
void add_title(const std::string& text, int font_size, vtkRenderer& renderer);

}  // namespace plenoflame::views
