#include "plenoflame/optics/f_number.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/optics/first_order.h"

namespace plenoflame {
namespace {

constexpr double kRounding = 1e-9;  // an f-number that the lens has already is not wider

std::string number_text(double value) {
  return readable_quantity(value, Dimension::none);
}

}  // namespace

void set_f_number(MainLensSpec& lens, double f_number) {
  if (!(f_number > 0) || !std::isfinite(f_number))
    throw InputError("an f-number is above 0, not " + number_text(f_number));
  double* diameter = &lens.diameter;
  if (!lens.surfaces.empty()) {
    const auto is_stop = [](const SurfaceSpec& surface) { return surface.stop; };
    if (std::count_if(lens.surfaces.begin(), lens.surfaces.end(), is_stop) != 1)
      throw InputError("an f-number needs one surface with stop = true, which it sets");
    diameter = &std::find_if(lens.surfaces.begin(), lens.surfaces.end(), is_stop)->diameter;
  }
  const double given = *diameter;
  if (!(given > 0)) *diameter = 1;  // [m], to be scaled
  const FirstOrder first = first_order(lens);
  const double now = first.focal_length / first.entrance_pupil_diameter;
  const double factor = now / f_number;
  if (!(now > 0) || !std::isfinite(now) || (given > 0 && factor > 1 + kRounding)) {
    *diameter = given;
    throw InputError(now > 0 && std::isfinite(now)
                         ? "f/" + number_text(f_number) + " is wider than the lens, which is f/" +
                               number_text(now) + "; give its stop a larger diameter, or none"
                         : "an f-number needs a lens that converges");
  }
  *diameter *= factor;
}

}  // namespace plenoflame
