#include "media/source_fit.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/constants.h"
#include "radiometry/gauss_rule.h"

namespace plenoflame::voxel {
namespace {

// Source functions below e^-80 of `highest` do not count. Values below kLeastSource [W/(m^2 sr)] do
// not count either: single precision holds them as denormal numbers, with which processors are
// slow.
constexpr double kLargestFall = 80, kLeastSource = 1e-36;

// Interpolates values f at points x by a polynomial, lowest power first (Newton's form, expanded).
std::vector<double> interpolate(const std::vector<double>& x, std::vector<double> f) {
  const std::size_t n = x.size();
  for (std::size_t order = 1; order < n; ++order)
    for (std::size_t i = n - 1; i >= order; --i) f[i] = (f[i] - f[i - 1]) / (x[i] - x[i - order]);
  std::vector<double> out{f[n - 1]};
  for (std::size_t i = n - 1; i-- > 0;) {
    out.insert(out.begin(), 0.0);
    for (std::size_t k = 0; k + 1 < out.size(); ++k) out[k] -= x[i] * out[k + 1];
    out[0] += f[i];
  }
  return out;
}

/// The polynomial p, highest power first, with log_of(v) = log_of(from) + (v - from) p(v - from).
/// Empty if it needs more terms, or if its terms cancel too much for single precision.
/// @param tolerance relative to 1 - log_of(v)
template <class LogOf>
std::vector<double> fit_piece(const LogOf& log_of, double from, double to, double tolerance,
                              int most_terms) {
  const double start = log_of(from), width = to - from;
  const auto slope = [&](double w) { return (log_of(from + w * width) - start) / w; };
  constexpr int kPlaces = 256;
  std::vector<double> expected;
  for (int i = 1; i <= kPlaces; ++i) expected.push_back(slope(double(i) / kPlaces));
  for (int terms = 1; terms <= most_terms; ++terms) {
    std::vector<double> x, f;
    for (int k = 0; k < terms; ++k) {
      x.push_back(0.5 - 0.5 * std::cos((k + 0.5) * constants::pi / terms));
      f.push_back(slope(x.back()));
    }
    const std::vector<double> c = interpolate(x, f);
    double worst = 0, largest = 0;
    for (int i = 1; i <= kPlaces; ++i) {
      const double w = double(i) / kPlaces, s = expected[static_cast<std::size_t>(i - 1)];
      double p = 0;
      for (int k = terms; k-- > 0;) p = p * w + c[static_cast<std::size_t>(k)];
      worst = std::max(worst, std::fabs((p - s) * w) / (1 - (start + s * w)));
    }
    for (const double coefficient : c) largest = std::max(largest, std::fabs(coefficient));
    if (worst > tolerance) continue;
    // Terms that cancel would cost digits in single precision.
    if (largest > 2 * std::max(1.0, start - log_of(to))) return {};
    std::vector<double> out(static_cast<std::size_t>(terms));
    double power = width;
    for (int k = 0; k < terms; ++k, power *= width)
      out[static_cast<std::size_t>(terms - 1 - k)] = c[static_cast<std::size_t>(k)] / power;
    return out;
  }
  return {};
}

}  // namespace

SourceFit fit_source(const SourceFunction& source, double coldest, double hottest, double tolerance,
                     int most_terms, int most_of_two) {
  SourceFit fit;
  fit.hottest = hottest;
  fit.highest = source(hottest);
  if (source.is_total() || !(fit.highest > 1e-30)) return fit;
  // Fall of ln S from the hottest, where it stays in range. ln S is nearly a line in 1/T: bisect.
  const auto fall = [&](double t) {
    const double s = source(t);
    return s > 0 ? std::log(fit.highest / s) : 1e3;
  };
  fit.coldest = coldest;
  const double largest_fall = std::min(kLargestFall, std::log(fit.highest / kLeastSource));
  if (!(coldest > 0) || fall(coldest) > largest_fall) {
    double low = std::max(coldest, 1e-6 * hottest), high = hottest;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (fall(middle) > largest_fall ? low : high) = middle;
    }
    fit.coldest = high;
  }
  const double span = 1 / fit.coldest - 1 / hottest;
  if (!(span > 0)) {  // one temperature only
    fit.terms = {0.0};
    return fit;
  }
  double exponent = 0;  // hc/(lambda k), mean over the band
  for (const auto& node : source.nodes())
    exponent += node.exponent / static_cast<double>(source.nodes().size());
  fit.occupation = std::exp(-exponent / hottest);
  const auto log_of = [&](double v) {  // ln E
    const double s = std::exp(-fall(1 / (1 / hottest + v)));
    return std::log(s / (1 - fit.occupation + fit.occupation * s));
  };
  fit.terms = fit_piece(log_of, 0, span, tolerance, most_terms);
  if (!fit.terms.empty()) return fit;
  // The split that needs the fewest terms, where the kernel takes all the same for every number.
  for (int most = 3; most <= most_of_two; ++most)
    for (const double share : {0.5, 0.4, 0.6, 0.3, 0.7, 0.25, 0.2, 0.15}) {
      std::vector<double> near = fit_piece(log_of, 0, share * span, tolerance, most);
      if (near.empty()) continue;
      std::vector<double> far = fit_piece(log_of, share * span, span, tolerance, most);
      if (far.empty()) continue;
      fit.terms = std::move(near);
      fit.far_terms = std::move(far);
      fit.split = share * span;
      fit.at_split = log_of(fit.split);
      return fit;
    }
  return fit;
}

std::vector<SourceFunction::Node> fewer_nodes(const SourceFunction& source, double coldest,
                                              double hottest, double tolerance) {
  const auto count = static_cast<int>(source.nodes().size());
  MeasurePoints measure;
  for (const auto& node : source.nodes()) {
    measure.places.push_back(node.exponent);
    measure.weights.push_back(node.weight / std::expm1(node.exponent / hottest));
  }
  for (int order = 1; order < count; ++order) {
    const MeasurePoints rule = gauss_rule(measure, order);
    std::vector<SourceFunction::Node> nodes;
    for (std::size_t i = 0; i < rule.places.size(); ++i)
      nodes.push_back({rule.places[i], rule.weights[i] * std::expm1(rule.places[i] / hottest)});
    double worst = 0;
    for (int i = 0; i <= 64; ++i) {
      const double inverse = 1 / hottest + (1 / coldest - 1 / hottest) * i / 64;
      double sum = 0;
      for (const auto& node : nodes) sum += node.weight / std::expm1(node.exponent * inverse);
      const double expected = source(1 / inverse);
      // As of the fit: where S has fallen far, its exponent costs as much.
      const double fall = std::log(source(hottest) / expected);
      worst = std::max(worst, std::fabs(sum / expected - 1) / (1 + fall));
    }
    if (worst <= tolerance) return nodes;
  }
  return source.nodes();
}

}  // namespace plenoflame::voxel
