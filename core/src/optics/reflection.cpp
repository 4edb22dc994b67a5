#include "optics/reflection.h"

#include <cmath>
#include <complex>

#include "plenoflame/base/constants.h"

namespace plenoflame {

Coating coating_of(const AntiReflection& layer, double before, double behind) {
  Coating coating{before, before, behind, 0};
  if (layer.index > 0 && (before == 1) != (behind == 1)) {
    coating.layer = layer.index;
    coating.phase = layer.wavelength > 0 ? layer.quarter_wave / layer.wavelength : 1;
  }
  return coating;
}

double surface_transmission(const Coating& c, double cos_in) {
  using Complex = std::complex<double>;
  const double sine = c.before * std::sqrt((1 - cos_in) * (1 + cos_in));
  if (!(sine < c.behind) || !(sine < c.layer)) return 0;
  const double cos_layer = std::sqrt(1 - sine * sine / (c.layer * c.layer));
  const double cos_out = std::sqrt(1 - sine * sine / (c.behind * c.behind));
  const Complex turn = std::exp(Complex(0, -constants::pi * c.phase * cos_layer));
  const auto share = [&](double first, double second) {
    return 1 - std::norm((first + second * turn) / (1.0 + first * second * turn));
  };
  const auto amplitude = [](double a, double b) { return (a - b) / (a + b); };
  const double across = share(amplitude(c.before * cos_in, c.layer * cos_layer),
                              amplitude(c.layer * cos_layer, c.behind * cos_out));
  const double along = share(amplitude(c.layer * cos_in, c.before * cos_layer),
                             amplitude(c.behind * cos_layer, c.layer * cos_out));
  return 0.5 * (across + along);
}

double plate_transmission(double index, double cos_in) {
  const double once = surface_transmission({1, 1, index, 0}, cos_in);
  return once * once;
}

}  // namespace plenoflame
