#pragma once
#include <QByteArray>
#include <cstddef>
#include <optional>
#include <vector>

#include "colour_map.h"

namespace plenoflame::desktop {

/// A point of the curve of opacity over temperature.
struct OpacityPoint {
  double place = 0;    ///< share of the way from the coldest to the hottest colour, 0 to 1
  double opacity = 1;  ///< share of what absorption there is that is drawn, 0 to 1
};
bool operator==(const OpacityPoint& a, const OpacityPoint& b);

/// The quantity that makes a place of the flame visible.
enum class FlameDrawing {
  eye,         ///< the light that eyes see of it, in its colours
  emission,    ///< in proportion to absorption times T^4: what shines
  absorption,  ///< soot that does not shine as well
  surfaces,    ///< of equal temperature
};

/// Look of the flame in three dimensions: colour and opacity over temperature. The light field
/// does not depend on it.
struct FlameLook {
  ColourMap map = ColourMap::inferno;
  FlameDrawing drawing = FlameDrawing::eye;
  double exposure = 0;       ///< [stops] of what eyes see, beside the automatic one
  bool automatic = true;     ///< temperatures of the ends from the flame itself
  double cold = 0, hot = 0;  ///< [K] ends of the colours otherwise
  double density = 1;        ///< times what makes the thickest way nearly opaque
  std::vector<OpacityPoint> points{{0, 1}, {1, 1}};  ///< by place; the first at 0, the last at 1
};
bool operator==(const FlameLook& a, const FlameLook& b);

/// Opacity at a place: straight lines between the points, the ends beyond them.
double opacity_at(const std::vector<OpacityPoint>& points, double place);

/// Adds a point; places are clamped to the range between the ends. @return its number
std::size_t add_point(std::vector<OpacityPoint>& points, const OpacityPoint& point);
/// Moves a point; it stays between its neighbours, and the ends stay at the ends.
void move_point(std::vector<OpacityPoint>& points, std::size_t number, const OpacityPoint& to);
/// Takes a point away. False: it is an end, which stays.
bool remove_point(std::vector<OpacityPoint>& points, std::size_t number);

/// As text for the settings, and back; nothing when it is no look.
QByteArray look_to_text(const FlameLook& look);
std::optional<FlameLook> look_from_text(const QByteArray& text);

}  // namespace plenoflame::desktop
