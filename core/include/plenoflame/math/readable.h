#pragma once
#include <string>

#include "plenoflame/base/units.h"
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// A value for people, with unit: four significant digits. Computations must not use it.
std::string readable(double value, Dimension dimension);
/// A point or vector in one unit, that of its largest component: "750 mm, 0 mm, -16 mm".
std::string readable_point(Vec3 point);
/// A share as percentage: "1.234 %".
std::string readable_percent(double share);
/// A value of a light field, or of a picture made from one, in its unit. Watts and radiances get a
/// prefix; electrons, counts and others do not.
std::string readable_in(double value, const std::string& unit);
/// A number: four significant digits.
std::string readable_number(double value);
/// Between the labels of a linear axis of this length: 1, 2 or 5 times a power of ten.
double tick_step(double length, int labels);

}  // namespace plenoflame
