// Exponentials, interval weights and Planck's law at their extremes. References: long double
// functions of the C library (64-bit mantissa) and series.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "plenoflame/radiometry/source_function.h"
#include "stress/stress_table.h"
#include "support/kernel_probes.h"

namespace plenoflame::radiometry_stress_test {

namespace {

using test::kernel_probes;
using test::StressCase;
using test::text;

constexpr const char* kArea = "Radiometry and radiative transfer";

// Exact SI constants, 64-bit mantissa.
constexpr long double kC1 = 2 * 6.62607015e-34L * 299792458.0L * 299792458.0L;
constexpr long double kC2 = 6.62607015e-34L * 299792458.0L / 1.380649e-23L;

template <class Real>
double ulps(Real actual, long double exact) {
  const Real size = std::fabs(static_cast<Real>(exact));
  const long double ulp = std::nextafter(size, std::numeric_limits<Real>::infinity()) - size;
  return static_cast<double>((static_cast<long double>(actual) - exact) / ulp);
}

/// psi - e^-t and 1 - psi, by series below 1.
long double far_weight(long double t) {
  if (t >= 1) return -expm1l(-t) / t - expl(-t);
  long double sum = 0, term = t / 2;
  for (int k = 0; k < 40; ++k, term *= -t / (k + 2)) sum += (k + 1) * term;
  return sum;
}
long double near_weight(long double t) {
  if (t >= 1) return 1 + expm1l(-t) / t;
  long double sum = 0, term = t / 2;
  for (int k = 0; k < 40; ++k, term *= -t / (k + 2)) sum += term;
  return sum;
}

template <class Real>
void exponentials(const std::string& precision) {
  const bool single = sizeof(Real) == 4;
  std::vector<Real> x;
  const double low = single ? -87.3 : -708.3, high = single ? 88 : 708.9;
  for (int i = 0; i <= 100000; ++i) x.push_back(static_cast<Real>(low + (high - low) * i * 1e-5));
  for (double s = 1e-30; s < 1; s *= 1.003)
    for (const double sign : {-1.0, 1.0}) x.push_back(static_cast<Real>(sign * s));
  StressCase exp(kArea, "e^x, " + precision + ", all results that are normal numbers [ulp]",
                 "long double", 1);
  StressCase expm1(kArea, "e^x - 1, " + precision + ", from 1e-30 [ulp]", "long double", 2);
  for (const auto& probe : kernel_probes<Real>()) {
    const auto r = probe.exponentials(x);
    for (std::size_t i = 0; i < x.size(); ++i) {
      exp.add(ulps(r.exp[i], expl(x[i])), text("x =", x[i]));
      expm1.add(ulps(r.expm1[i], expm1l(x[i])), text("x =", x[i]));
    }
  }
}

TEST(RadiometryStress, Exponentials) {
  exponentials<float>("single");
  exponentials<double>("double");
}

template <class Real>
void weights(const std::string& precision) {
  std::vector<Real> tau;
  for (double t = 1e-12; t < 1.1e6; t *= 1.0003) tau.push_back(static_cast<Real>(t));
  for (double t = 1.4; t < 1.6; t += 1e-5) tau.push_back(static_cast<Real>(t));  // the switch
  StressCase transmittance(kArea, "e^-tau, tau from 1e-12, " + precision + ", normal numbers [ulp]",
                           "long double", 1);
  StressCase emissivity(kArea, "1 - e^-tau, tau 1e-12 to 1e6, " + precision + " [ulp]",
                        "long double", 2);
  StressCase far(kArea, "linear source, far weight, tau 1e-12 to 1e6, " + precision + " [ulp]",
                 "long double, series", 4);
  StressCase near(kArea, "linear source, near weight, tau 1e-12 to 1e6, " + precision + " [ulp]",
                  "long double, series", 4);
  StressCase jump(kArea,
                  "weights, step between neighbours at the switch tau = 1.5, " + precision +
                      " [ulp of 0.5 to 1]",
                  "none: continuity", 2);
  const Real at = Real(1.5);
  const std::vector<Real> around{std::nextafter(at, Real(0)), at};
  for (const auto& probe : kernel_probes<Real>()) {
    const auto r = probe.exponentials(tau);
    for (std::size_t i = 0; i < tau.size(); ++i) {
      const std::string where = text("tau =", tau[i]);
      if (tau[i] <= (sizeof(Real) == 4 ? 87.3 : 708.3))
        transmittance.add(ulps(r.transmittance[i], expl(-static_cast<long double>(tau[i]))), where);
      emissivity.add(ulps(r.emissivity[i], -expm1l(-static_cast<long double>(tau[i]))), where);
      far.add(ulps(r.far_weight[i], far_weight(tau[i])), where);
      near.add(ulps(r.near_weight[i], near_weight(tau[i])), where);
    }
    const auto s = probe.exponentials(around);
    const double ulp = 0.5 * std::numeric_limits<Real>::epsilon();
    jump.add((s.far_weight[1] - s.far_weight[0]) / ulp, "far");
    jump.add((s.near_weight[1] - s.near_weight[0]) / ulp, "near");
  }
}

TEST(RadiometryStress, IntervalWeights) {
  weights<float>("single");
  weights<double>("double");
}

// Source function linear in optical thickness from 1 (near) to 3 (far), cut into 1e5 intervals and
// composed: the same as in one piece.
template <class Real>
void many_intervals(const std::string& precision, double bound) {
  StressCase radiance(kArea,
                      "radiance through 1e5 cells, tau 1e-12 to 1e6, " + precision + " [relative]",
                      "one interval, long double", bound);
  constexpr int cells = 100000;
  std::vector<double> total;
  for (double t = 1e-12; t <= 1.001e6; t *= 10) total.push_back(t);
  std::vector<Real> tau;
  for (const double t : total) tau.push_back(static_cast<Real>(t / cells));
  for (const auto& probe : kernel_probes<Real>()) {
    const auto r = probe.exponentials(tau);
    for (std::size_t i = 0; i < tau.size(); ++i) {
      Real light = 0;
      for (int c = cells - 1; c >= 0; --c) {  // from the far end
        const Real near_source = 1 + 2 * static_cast<Real>(c) / cells;
        const Real far_source = 1 + 2 * static_cast<Real>(c + 1) / cells;
        light = light * r.transmittance[i] + r.far_weight[i] * far_source +
                r.near_weight[i] * near_source;
      }
      const long double whole = static_cast<long double>(tau[i]) * cells;
      const long double exact = 3 * far_weight(whole) + near_weight(whole);
      radiance.add(static_cast<double>(light / exact - 1), text("tau =", total[i]));
    }
  }
}

TEST(RadiometryStress, HundredThousandCells) {
  many_intervals<float>("single", 1e-3);
  many_intervals<double>("double", 1e-11);
}

// Relative errors over 4 + hc/(lambda k T): rounding the temperature alone costs as much.
template <class Real>
void planck_kernel(const std::string& precision) {
  StressCase planck(kArea,
                    "Planck's law in kernels, 250 nm to 20 um, 200 K to 1e5 K, " + precision +
                        " [epsilon (4 + hc/lambda k T)]",
                    "long double", 0.6);
  std::vector<Real> temperature;
  for (double t = 200; t <= 1.001e5; t *= 1.01) temperature.push_back(static_cast<Real>(t));
  for (double wavelength = 250e-9; wavelength < 20.01e-6; wavelength *= 1.2) {
    const Real exponent = static_cast<Real>(kC2 / wavelength);
    const Real weight = static_cast<Real>(kC1 / std::pow(wavelength, 5) * 1e-9);
    for (const auto& probe : kernel_probes<Real>()) {
      const auto out = probe.source({exponent}, {weight}, temperature);
      for (std::size_t i = 0; i < out.size(); ++i) {
        const long double x = static_cast<long double>(exponent) / temperature[i];
        const long double exact = weight / expm1l(x);
        if (exact < std::numeric_limits<Real>::min()) {
          planck.add(out[i] < std::numeric_limits<Real>::min() ? 0 : HUGE_VAL, "underflow");
          continue;
        }
        planck.add(static_cast<double>((out[i] / exact - 1) / (4 + x)) /
                       std::numeric_limits<Real>::epsilon(),
                   text("lambda =", wavelength) +
                       text(" m, T =", static_cast<double>(temperature[i])) + " K");
      }
    }
  }
}

TEST(RadiometryStress, Planck) {
  planck_kernel<float>("single");
  planck_kernel<double>("double");
  StressCase planck(kArea, "planck_radiance, 100 nm to 1 m, 100 K to 1e7 K [relative]",
                    "long double", 2e-15);
  for (double wavelength = 100e-9; wavelength < 1; wavelength *= 1.07)
    for (double t = 100; t < 1e7; t *= 1.13) {
      const long double l = wavelength;
      const long double exact = kC1 / (l * l * l * l * l) / expm1l(kC2 / (l * t));
      if (exact < 1e-300L) continue;
      planck.add(static_cast<double>(planck_radiance(wavelength, t) / exact - 1),
                 text("lambda =", wavelength) + text(" m, T =", t) + " K");
    }
}

/// Integral of x^3 / (e^x - 1) from a to infinity: sum over n of e^-na (a^3/n + 3a^2/n^2 + 6a/n^3 +
/// 6/n^4) (Abramowitz and Stegun 27.1.2).
long double planck_tail(long double a) {
  long double sum = 0;
  for (int n = 1; n < 200000; ++n) {
    const long double m = n;
    const long double term = expl(-m * a) * (a * a * a / m + 3 * a * a / (m * m) +
                                             6 * a / (m * m * m) + 6 / (m * m * m * m));
    sum += term;
    if (term < 1e-21L * sum) break;
  }
  return sum;
}

/// The same from 0 to a < 1 by its power series with Bernoulli numbers (27.1.1): for narrow bands
/// of hot bodies, where the tails above cancel.
long double planck_head(long double a) {
  const long double s = a * a;
  const long double rest =
      1 / 60.0L +
      s * (-1 / 5040.0L +
           s * (1 / 272160.0L +
                s * (-1 / 13305600.0L + s * (1 / 622702080.0L + s * (-691 / 19615115520000.0L +
                                                                     s * 7 / 8892185702400.0L)))));
  return a * s * (1 / 3.0L - a / 8 + s * rest);
}

long double planck_between(long double a, long double b) {
  return b < 0.7L ? planck_head(b) - planck_head(a) : planck_tail(a) - planck_tail(b);
}

TEST(RadiometryStress, Bands) {
  StressCase bands(kArea, "bands of 10 % to 190 % around 0.3 to 15 um, 200 K to 1e5 K [relative]",
                   "series of the incomplete Planck integral, long double", 1e-12);
  for (const double wavelength : {0.3e-6, 0.65e-6, 2e-6, 15e-6})
    for (const double part : {0.1, 0.5, 1.0, 1.9}) {
      const double width = part * wavelength;
      const SourceFunction band = SourceFunction::band(wavelength, width);
      for (double t = 200; t < 1.001e5; t *= 1.5) {
        const long double longest = static_cast<long double>(wavelength) + 0.5L * width;
        const long double shortest = static_cast<long double>(wavelength) - 0.5L * width;
        const long double scale = static_cast<long double>(t) / kC2;
        const long double exact = kC1 * scale * scale * scale * scale *
                                  planck_between(1 / (longest * scale), 1 / (shortest * scale));
        bands.add(
            static_cast<double>(band(t) / exact - 1),
            text("lambda =", wavelength) + text(" m, width", width) + text(" m, T =", t) + " K");
      }
    }
}

}  // namespace
}  // namespace plenoflame::radiometry_stress_test
