#include "media/transfer.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace plenoflame {
namespace {

constexpr std::size_t kNodes = 15;

// Gauss-Kronrod (7, 15), from QUADPACK (Piessens et al., 1983), routine QK15.
constexpr std::array<double, 8> kAbscissae{
    0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
    0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
    0.586087235467691130294144691258380, 0.405845151377397166906606412076961,
    0.207784955007898467600689403773245, 0.0};
constexpr std::array<double, 8> kKronrodWeights{
    0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
    0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
    0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
    0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
constexpr std::array<double, 4> kGaussWeights{
    0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
    0.381830050505118944950369775488975, 0.417959183673469387755102040816327};

// Gauss-Legendre with 8 nodes, positive halves (Abramowitz and Stegun, table 25.4): exact for
// degree 15; the polynomials through 15 nodes have degree 14.
constexpr std::array<double, 4> kExactNodes{
    0.1834346424956498049394761, 0.5255324099163289858177390, 0.7966664774136267395915539,
    0.9602898564975362316835609};
constexpr std::array<double, 4> kExactWeights{
    0.3626837833783619829651504, 0.3137066458778872873379622, 0.2223810344533744705443560,
    0.1012285362903762591525314};

struct Rule {
  std::array<double, kNodes> node{}, kronrod{}, gauss{};
  /// integral from -1 to node i of the Lagrange polynomial of node j
  std::array<std::array<double, kNodes>, kNodes> cumulative{};

  constexpr Rule() {
    for (std::size_t i = 0; i < kNodes; ++i) {
      const std::size_t k = i < 8 ? i : 14 - i;
      node[i] = i < 7 ? -kAbscissae[k] : kAbscissae[k];
      kronrod[i] = kKronrodWeights[k];
      gauss[i] = k % 2 == 1 ? kGaussWeights[k / 2] : 0;
    }
    for (std::size_t i = 0; i < kNodes; ++i)
      for (std::size_t j = 0; j < kNodes; ++j) {
        const double half = 0.5 * (node[i] + 1);
        double sum = 0;
        for (std::size_t q = 0; q < 8; ++q) {
          const double abscissa = q < 4 ? -kExactNodes[q] : kExactNodes[q - 4];
          const double x = -1 + half * (1 + abscissa);
          double product = kExactWeights[q % 4];
          for (std::size_t m = 0; m < kNodes; ++m)
            if (m != j) product *= (x - node[m]) / (node[j] - node[m]);
          sum += product;
        }
        cumulative[i][j] = half * sum;
      }
  }
};

/// Estimate of the relative error of the Kronrod value, as in QUADPACK: the difference to the
/// Gauss value overstates it when both are good.
double estimated_error(double kronrod, double gauss) {
  const double scale = std::fabs(kronrod);
  if (scale == 0) return gauss == 0 ? 0 : 1;
  const double difference = std::fabs(kronrod - gauss) / scale;
  return std::min(difference, std::pow(200 * difference, 1.5));
}

constexpr double kOpaque = 100;          ///< optical thickness behind which nothing is seen
constexpr double kThickest = 4;          ///< of one interval: keeps e^-tau a smooth function
constexpr int kDeepest = 48;             ///< bisections of one interval
constexpr int kMostIntervals = 1 << 15;  ///< of a whole ray: ends what rounding never lets converge

}  // namespace

TransferResult integrate_transfer(const RayCoefficients& coefficients, int channels,
                                  const std::vector<double>& limits, double tolerance) {
  static constexpr Rule rule;
  const auto count = static_cast<std::size_t>(channels);
  TransferResult result;
  result.radiance.assign(count, 0.0);
  std::vector<double> emission(kNodes * count), kronrod(count), gauss(count);
  std::array<double, kNodes> kappa{};

  struct Interval {
    double from, to;
    int depth;
  };
  std::vector<Interval> waiting;
  int evaluated = 0;
  for (std::size_t part = 0; part + 1 < limits.size(); ++part) {
    if (!(limits[part] < limits[part + 1])) continue;
    waiting.push_back({limits[part], limits[part + 1], 0});
    while (!waiting.empty()) {
      const Interval interval = waiting.back();
      waiting.pop_back();
      ++evaluated;
      const double half = 0.5 * (interval.to - interval.from);
      const double middle = interval.from + half;
      for (std::size_t i = 0; i < kNodes; ++i)
        kappa[i] = coefficients(middle + half * rule.node[i], &emission[i * count]);

      double thickness = 0, thickness_gauss = 0;
      for (std::size_t i = 0; i < kNodes; ++i) {
        thickness += half * rule.kronrod[i] * kappa[i];
        thickness_gauss += half * rule.gauss[i] * kappa[i];
      }
      const bool visible = result.optical_thickness < kOpaque;
      bool good = estimated_error(thickness, thickness_gauss) <= tolerance &&
                  (!visible || thickness <= kThickest);
      if (visible) {
        std::fill(kronrod.begin(), kronrod.end(), 0.0);
        std::fill(gauss.begin(), gauss.end(), 0.0);
        for (std::size_t i = 0; i < kNodes; ++i) {
          double in_front = 0;
          for (std::size_t j = 0; j < kNodes; ++j) in_front += rule.cumulative[i][j] * kappa[j];
          const double factor = half * std::exp(-half * in_front);
          for (std::size_t c = 0; c < count; ++c) {
            kronrod[c] += rule.kronrod[i] * factor * emission[i * count + c];
            gauss[c] += rule.gauss[i] * factor * emission[i * count + c];
          }
        }
        for (std::size_t c = 0; c < count; ++c)
          good = good && estimated_error(kronrod[c], gauss[c]) <= tolerance;
      }
      if (!good && interval.depth < kDeepest && evaluated < kMostIntervals) {
        waiting.push_back({middle, interval.to, interval.depth + 1});
        waiting.push_back({interval.from, middle, interval.depth + 1});
        continue;
      }
      if (visible) {
        const double transmittance = std::exp(-result.optical_thickness);
        for (std::size_t c = 0; c < count; ++c) result.radiance[c] += transmittance * kronrod[c];
      }
      result.optical_thickness += thickness;
    }
  }
  return result;
}

}  // namespace plenoflame
