#include "plenoflame/math/readable.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace plenoflame {
namespace {

std::string four_digits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace

std::string readable(double value, Dimension dimension) {
  return readable_quantity(value, dimension);
}

std::string readable_in(double value, const std::string& unit) {
  if (unit == "W") return readable(value, Dimension::flux);
  if (unit == "W/(m^2 sr)") return readable(value, Dimension::radiance);
  return four_digits(value) + " " + unit;
}

std::string readable_point(Vec3 point) {
  const double largest = std::max({std::fabs(point.x), std::fabs(point.y), std::fabs(point.z)});
  const bool metres = largest >= 1 || largest == 0;
  const double unit = metres ? 1 : largest >= 1e-3 ? 1e-3 : largest >= 1e-6 ? 1e-6 : 1e-9;
  const char* name = metres ? " m" : largest >= 1e-3 ? " mm" : largest >= 1e-6 ? " um" : " nm";
  const auto text = [&](double value) { return four_digits(value / unit) + name; };
  return text(point.x) + ", " + text(point.y) + ", " + text(point.z);
}

std::string readable_percent(double share) {
  return four_digits(100 * share) + " %";
}

std::string readable_number(double value) {
  return four_digits(value);
}

double tick_step(double length, int labels) {
  const double rough = length / labels, decade = std::pow(10.0, std::floor(std::log10(rough)));
  const double digits = rough / decade;
  return decade * (digits < 1.5 ? 1 : digits < 3.5 ? 2 : digits < 7.5 ? 5 : 10);
}

}  // namespace plenoflame
