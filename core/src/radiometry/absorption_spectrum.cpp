#include "plenoflame/radiometry/absorption_spectrum.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

struct Row {
  double wavelength, n, k;
};
// Acetylene soot, 4358 A to 8065 A.
constexpr std::array<Row, 4> kDalzell{
    {{435.8e-9, 1.56, 0.46}, {550e-9, 1.56, 0.46}, {650e-9, 1.57, 0.44}, {806.5e-9, 1.57, 0.46}}};

void check_range(double wavelength, double shortest, double longest, const char* who) {
  if (wavelength >= shortest && wavelength <= longest) return;
  throw InputError(fmt::format(
      "the refractive index of soot by {} is known from {:g} nm to {:g} nm, and {:g} nm is asked "
      "for; take another source, or a power law",
      who, 1e9 * shortest, 1e9 * longest, 1e9 * wavelength));
}

}  // namespace

std::complex<double> soot_refractive_index(SootIndex source, double wavelength) {
  if (source == SootIndex::chang) {
    check_range(wavelength, 0.4e-6, 30e-6, "Chang and Charalampopoulos");
    const double l = std::log(1e6 * wavelength);
    return {1.811 + l * (0.1263 + l * (0.027 + l * 0.0417)),
            -(0.5821 + l * (0.1213 + l * (0.2309 - l * 0.01)))};
  }
  check_range(wavelength, kDalzell.front().wavelength, kDalzell.back().wavelength,
              "Dalzell and Sarofim");
  std::size_t i = 0;
  while (i + 2 < kDalzell.size() && wavelength > kDalzell[i + 1].wavelength) ++i;
  const Row &a = kDalzell[i], &b = kDalzell[i + 1];
  const double share = (wavelength - a.wavelength) / (b.wavelength - a.wavelength);
  return {a.n + share * (b.n - a.n), -(a.k + share * (b.k - a.k))};
}

double soot_absorption_function(std::complex<double> index) {
  const std::complex<double> square = index * index;
  return -std::imag((square - 1.0) / (square + 2.0));
}

AbsorptionSpectrum AbsorptionSpectrum::power(double reference, double exponent) {
  AbsorptionSpectrum spectrum;
  spectrum.kind_ = Kind::power;
  spectrum.reference_ = reference;
  spectrum.exponent_ = exponent;
  return spectrum;
}

AbsorptionSpectrum AbsorptionSpectrum::soot(double reference, SootIndex index,
                                            double absorption_function) {
  AbsorptionSpectrum spectrum;
  spectrum.kind_ = Kind::soot;
  spectrum.reference_ = reference;
  spectrum.index_ = index;
  spectrum.absorption_function_ = absorption_function;
  spectrum.absolute(reference);  // within the range of the measurements
  return spectrum;
}

AbsorptionSpectrum AbsorptionSpectrum::table(double reference, std::vector<SpectralPoint> points) {
  AbsorptionSpectrum spectrum;
  spectrum.kind_ = Kind::table;
  spectrum.reference_ = reference;
  spectrum.points_ = std::move(points);
  if (!(spectrum.absolute(reference) > 0))
    throw InputError(
        fmt::format("the absorption table is 0 at the reference wavelength, {:g} nm, at which the "
                    "absorption of the flame holds; choose another one",
                    1e9 * reference));
  return spectrum;
}

/// The absorption that factor() is a ratio of: [1/m] of a volume fraction of 1 for soot.
double AbsorptionSpectrum::absolute(double wavelength) const {
  switch (kind_) {
    case Kind::grey:
      break;
    case Kind::power:
      return std::pow(reference_ / wavelength, exponent_);
    case Kind::soot: {
      const double e = index_ == SootIndex::constant
                           ? absorption_function_
                           : soot_absorption_function(soot_refractive_index(index_, wavelength));
      return 6 * constants::pi * e / wavelength;
    }
    case Kind::table: {
      const auto after =
          std::upper_bound(points_.begin(), points_.end(), wavelength,
                           [](double w, const SpectralPoint& p) { return w < p.wavelength; });
      if (after == points_.begin()) return points_.front().value;
      if (after == points_.end()) return points_.back().value;
      const SpectralPoint& low = *(after - 1);
      const double share = (wavelength - low.wavelength) / (after->wavelength - low.wavelength);
      return low.value + share * (after->value - low.value);
    }
  }
  return 1;
}

double AbsorptionSpectrum::factor(double wavelength) const {
  return is_grey() ? 1 : absolute(wavelength) / absolute(reference_);
}

std::vector<double> AbsorptionSpectrum::breakpoints() const {
  std::vector<double> at;
  if (kind_ == Kind::table)
    for (const SpectralPoint& point : points_) at.push_back(point.wavelength);
  if (kind_ == Kind::soot && index_ == SootIndex::dalzell)
    for (const Row& row : kDalzell) at.push_back(row.wavelength);
  return at;
}

double AbsorptionSpectrum::per_volume_fraction() const {
  return kind_ == Kind::soot ? absolute(reference_) : 0;
}

}  // namespace plenoflame
