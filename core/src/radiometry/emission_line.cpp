#include "plenoflame/radiometry/emission_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "radiometry/gauss_legendre.h"

namespace plenoflame {
namespace {

struct LineRow {
  NamedLine line;
  std::array<double, 2> wavelengths;  ///< [nm] vacuum; the second 0: there is one
  double first_share;
};

constexpr std::string_view kBands =
    "Pearse and Gaydon, The Identification of Molecular Spectra, 4th ed., 1976; in vacuum";
constexpr std::string_view kAtoms =
    "NIST Atomic Spectra Database; in vacuum; 2 : 1, the statistical weights";

// Wavelengths in air 431.42, 473.71, 516.52, 563.55 and 308.9 nm; of sodium 588.995 and 589.592 nm.
constexpr LineRow kNamedLines[] = {
    {{"ch", "CH* A-X (0, 0)", kBands}, {431.54, 0}, 1},
    {{"c2_474", "C2* Swan band (1, 0)", kBands}, {473.84, 0}, 1},
    {{"c2_517", "C2* Swan band (0, 0)", kBands}, {516.66, 0}, 1},
    {{"c2_564", "C2* Swan band (0, 1)", kBands}, {563.71, 0}, 1},
    {{"oh", "OH* A-X (0, 0)", kBands}, {308.99, 0}, 1},
    {{"na_d", "sodium D lines", kAtoms}, {589.1583, 589.7558}, 2.0 / 3},
};

/// Mean of the response over a Gaussian of a full width.
double mean_response(const SpectralResponse& response, double wavelength, double width) {
  const double deviation = width / std::sqrt(8 * std::log(2.0));
  // Panels of half a deviation, cut where the response is not smooth.
  constexpr int kPanels = 18;  // to each side: beyond 9 deviations there is 2e-19 of a Gaussian
  std::vector<double> limits;
  for (int i = -kPanels; i <= kPanels; ++i) limits.push_back(wavelength + 0.5 * i * deviation);
  for (const double kink : response.breakpoints())
    if (kink > limits.front() && kink < wavelength + 0.5 * kPanels * deviation)
      limits.push_back(kink);
  std::sort(limits.begin(), limits.end());
  const GaussLegendreRule rule(10);
  double sum = 0;
  for (std::size_t k = 0; k + 1 < limits.size(); ++k) {
    const double middle = 0.5 * (limits[k] + limits[k + 1]);
    const double half = 0.5 * (limits[k + 1] - limits[k]);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double at = middle + half * rule.nodes[i], x = (at - wavelength) / deviation;
      sum += half * rule.weights[i] * std::exp(-0.5 * x * x) * response(at);
    }
  }
  return sum / (deviation * std::sqrt(2 * constants::pi));
}

}  // namespace

EmissionLine EmissionLine::at(double wavelength, double width) {
  if (!(wavelength > 0) || !std::isfinite(wavelength) || !(width >= 0) ||
      !(width < 0.25 * wavelength))
    throw InputError(fmt::format(
        "an emission line needs a wavelength above 0 and a width below a quarter of it; got "
        "wavelength {:g} m, width {:g} m",
        wavelength, width));
  EmissionLine line;
  line.components_ = {{wavelength, 1}};
  line.width_ = width;
  return line;
}

EmissionLine EmissionLine::named(std::string_view name, double width) {
  std::string known;
  for (const LineRow& entry : kNamedLines) {
    known.append(known.empty() ? "" : ", ").append(entry.line.name);
    if (entry.line.name != name) continue;
    EmissionLine line = at(1e-9 * entry.wavelengths[0], width);
    if (entry.wavelengths[1] > 0)
      line.components_ = {{1e-9 * entry.wavelengths[0], entry.first_share},
                          {1e-9 * entry.wavelengths[1], 1 - entry.first_share}};
    return line;
  }
  throw InputError(fmt::format("there is no emission line \"{}\"; known are {}", name, known));
}

double EmissionLine::wavelength() const {
  double mean = 0;
  for (const Component& component : components_) mean += component.share * component.wavelength;
  return mean;
}

double EmissionLine::seen_by(const std::optional<SpectralResponse>& response) const {
  if (!response) return 1;
  double sum = 0;
  for (const Component& component : components_)
    sum += component.share * (width_ > 0 ? mean_response(*response, component.wavelength, width_)
                                         : (*response)(component.wavelength));
  return sum;
}

std::vector<NamedLine> named_lines() {
  std::vector<NamedLine> lines;
  for (const LineRow& entry : kNamedLines) lines.push_back(entry.line);
  return lines;
}

std::optional<double> emission_unit(std::string_view unit, double wavelength) {
  std::string lower(unit);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  constexpr double kSphere = 4 * constants::pi, kPerMole = 6.02214076e23;
  const double photon = constants::planck * constants::light_speed / wavelength;
  const std::pair<std::string_view, double> known[] = {{"w/m^3", 1},
                                                       {"kw/m^3", 1e3},
                                                       {"w/cm^3", 1e6},
                                                       {"w/mm^3", 1e9},
                                                       {"w/(m^3 sr)", kSphere},
                                                       {"w/(cm^3 sr)", 1e6 * kSphere},
                                                       {"1/(m^3 s)", photon},
                                                       {"1/(cm^3 s)", 1e6 * photon},
                                                       {"mol/(m^3 s)", kPerMole * photon}};
  for (const auto& [name, factor] : known)
    if (lower == name) return factor;
  return std::nullopt;
}

std::string_view emission_unit_list() {
  return "W/m^3, kW/m^3, W/cm^3 or W/mm^3 into all directions, W/(m^3 sr) or W/(cm^3 sr), or "
         "photons as 1/(m^3 s), 1/(cm^3 s) or mol/(m^3 s)";
}

}  // namespace plenoflame
