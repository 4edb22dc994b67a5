#include "plenoflame/radiometry/source_function.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "radiometry/gauss_legendre.h"
#include "radiometry/gauss_rule.h"

namespace plenoflame {
namespace {

using Node = SourceFunction::Node;

// hc/k [m K] as an unevaluated sum of two doubles. At 250 nm and 200 K the exponent is 288, and the
// rounding of the constant alone would cost two digits.
constexpr double kSecondRadiationHigh = 0.014387768775039339;
constexpr double kSecondRadiationLow = -6.7359864468049583e-19;

double evaluate(const std::vector<Node>& nodes, double temperature) {
  double sum = 0;
  for (const Node& node : nodes) sum += node.weight / std::expm1(node.exponent / temperature);
  return sum;
}

/// Panels over the wavenumbers [first, first + extent], each twice as wide as the one before: cold
/// bodies emit next to the longest wavelength only. In the wavenumber s = 1/lambda the integrand
/// is 2hc^2 s^3 / expm1(hc s/(kT)), an exponential times a polynomial, which suits Gauss's rule.
std::vector<Node> make_nodes(double first, double extent, int panels, int order) {
  const GaussLegendreRule rule(order);
  std::vector<Node> nodes;
  double start = 0;  // relative to `first`, so that narrow bands keep their width
  double width = extent / (std::ldexp(1.0, panels) - 1);
  for (int panel = 0; panel < panels; ++panel) {
    for (int i = 0; i < order; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double s = first + (start + width * 0.5 * (1 + rule.nodes[k]));
      nodes.push_back({constants::second_radiation * s,
                       0.5 * width * rule.weights[k] * constants::first_radiation * s * s * s});
    }
    start += width;
    width *= 2;
  }
  return nodes;
}

/// Fewest nodes whose integral agrees with a far finer rule at all temperatures.
std::vector<Node> fewest_nodes(double first, double extent) {
  constexpr std::array<double, 11> temperatures{200,  300,  500, 900,   1600, 2800,
                                                5000, 9000, 2e4, 4.5e4, 1e5};
  constexpr double tolerance = 3e-13;
  constexpr int most_panels = 24, most_order = 32;
  const std::vector<Node> finest = make_nodes(first, extent, most_panels, most_order);
  std::array<double, temperatures.size()> expected{};
  for (std::size_t i = 0; i < temperatures.size(); ++i)
    expected[i] = evaluate(finest, temperatures[i]);

  std::vector<Node> best = finest;
  for (int panels = 1; panels <= most_panels; ++panels)
    for (int order = 1; order <= most_order; ++order) {
      if (static_cast<std::size_t>(panels) * static_cast<std::size_t>(order) >= best.size()) break;
      std::vector<Node> nodes = make_nodes(first, extent, panels, order);
      bool good = true;
      for (std::size_t i = 0; good && i < temperatures.size(); ++i)
        good = std::fabs(evaluate(nodes, temperatures[i]) - expected[i]) <= tolerance * expected[i];
      if (good) best = std::move(nodes);
    }
  return best;
}

}  // namespace

double planck_radiance(double wavelength, double temperature) {
  if (!(temperature > 0)) return 0;
  // exponent = hc/(lambda k T) as a sum of two doubles, with the rounding errors of product and
  // quotient recovered by fused multiply-add.
  const double product = wavelength * temperature;
  const double product_error = std::fma(wavelength, temperature, -product);
  const double exponent = kSecondRadiationHigh / product;
  if (!std::isfinite(exponent)) return 0;
  const double rest = (std::fma(-exponent, product, kSecondRadiationHigh) -
                       exponent * product_error + kSecondRadiationLow) /
                      product;
  const double emissivity = -std::expm1(-exponent);
  const double squared = wavelength * wavelength;
  const double scale = constants::first_radiation / (squared * squared * wavelength);
  // e^-exponent on both sides of the large factor where it alone would lose digits to underflow.
  const double bose = exponent < 600
                          ? scale * (std::exp(-exponent) / emissivity)
                          : scale * std::exp(-0.5 * exponent) * std::exp(-0.5 * exponent);
  return bose * (1 - rest / emissivity);
}

SourceFunction SourceFunction::total() {
  return {};
}

SourceFunction SourceFunction::band(double wavelength, double width) {
  const double shortest = wavelength - 0.5 * width, longest = wavelength + 0.5 * width;
  if (!(width > 0) || !(shortest > 0) || !std::isfinite(longest)) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "a band needs a width above 0 and below twice its wavelength; "
                  "got wavelength %g m, width %g m",
                  wavelength, width);
    throw InputError(text);
  }
  // Wavenumbers 60 e-foldings beyond the first at 1e5 K add less than 1e-13 at any temperature.
  const double first = 1 / longest;
  const double negligible = 60 * 1e5 / constants::second_radiation;
  const double extent = std::fmin(width / (shortest * longest), negligible);
  SourceFunction source;
  source.nodes_ = fewest_nodes(first, extent);
  source.wavelength_ = wavelength;
  return source;
}

SourceFunction SourceFunction::of(const SpectralResponse& response) {
  // The rule is exact for polynomials of the wavenumber under the weight R(s) s^3. It needs few
  // nodes, because the remaining factor 1 / expm1(hc s/(kT)) is smooth. Its many points are the
  // reference, too.
  const MeasurePoints points = wavenumber_points(response, 12);
  constexpr std::array<double, 11> temperatures{200,  300,  500, 900,   1600, 2800,
                                                5000, 9000, 2e4, 4.5e4, 1e5};
  constexpr double tolerance = 3e-13;
  constexpr int most = 48;
  const auto nodes_of = [](const MeasurePoints& rule) {
    std::vector<Node> nodes;
    for (std::size_t i = 0; i < rule.places.size(); ++i)
      nodes.push_back({constants::second_radiation * rule.places[i],
                       constants::first_radiation * rule.weights[i]});
    return nodes;
  };
  MeasurePoints cubed = points;
  for (std::size_t i = 0; i < cubed.places.size(); ++i)
    cubed.weights[i] *= cubed.places[i] * cubed.places[i] * cubed.places[i];
  const std::vector<Node> all = nodes_of(cubed);
  std::array<double, temperatures.size()> expected{};
  for (std::size_t i = 0; i < temperatures.size(); ++i)
    expected[i] = evaluate(all, temperatures[i]);
  SourceFunction source;
  source.nodes_ = all;
  source.wavelength_ = response.centroid();
  for (int order = 1; order <= most && order < static_cast<int>(all.size()); ++order) {
    std::vector<Node> nodes = nodes_of(gauss_rule(cubed, order));
    bool good = true;
    for (std::size_t i = 0; good && i < temperatures.size(); ++i)
      good = std::fabs(evaluate(nodes, temperatures[i]) - expected[i]) <= tolerance * expected[i];
    if (!good) continue;
    source.nodes_ = std::move(nodes);
    break;
  }
  return source;
}

SourceFunction SourceFunction::scaled(double factor) const {
  if (factor == 1) return *this;
  SourceFunction source = *this;
  if (is_total()) {
    source = band(0.5 * (1e-7 + 1e-3), 1e-3 - 1e-7);
    source.wavelength_ = 0;
    source.share_ = share_;
    source.lines_ = lines_;
  }
  for (Node& node : source.nodes_) node.weight *= factor;
  return source;
}

SourceFunction SourceFunction::node(const Node& node, double wavelength, double share) {
  SourceFunction source;
  source.nodes_ = {node};
  source.wavelength_ = wavelength;
  source.share_ = share;
  return source;
}

SourceFunction SourceFunction::of_lines(double wavelength, std::vector<LineShare> lines) {
  return node({constants::second_radiation / wavelength, 0}, wavelength, 0)
      .with_lines(std::move(lines));
}

double SourceFunction::line_share(const EmissionLine& line) const {
  double sum = 0;
  for (const LineShare& known : lines_)
    if (known.line == line) sum += known.share;
  return sum;
}

struct SourceFunction::Shared {
  SourceFunction whole;
  std::vector<SourceFunction> parts;
};

std::vector<SourceFunction> SourceFunction::sharing(const SourceFunction& whole,
                                                    const std::vector<SourceFunction>& parts) {
  if (parts.size() == 1) return {whole.at(parts.front().wavelength())};
  const auto shared = std::make_shared<const Shared>(Shared{whole, parts});
  std::vector<SourceFunction> sources;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    SourceFunction source;
    source.wavelength_ = parts[i].wavelength_;
    source.share_ = parts[i].share_;
    source.shared_ = shared;
    source.part_ = i;
    sources.push_back(std::move(source));
  }
  return sources;
}

double SourceFunction::operator()(double temperature) const {
  if (!(temperature > 0)) return 0;
  if (shared_) {
    double sum = 0;
    for (const SourceFunction& part : shared_->parts) sum += part(temperature);
    const double own = shared_->parts[part_](temperature);
    // So cold that the parts underflow: what is left goes to the longest wavelength, the first one.
    if (!(sum > 0)) return part_ == 0 ? shared_->whole(temperature) : 0;
    return shared_->whole(temperature) * (own / sum);
  }
  if (!is_total()) return evaluate(nodes_, temperature);
  const double squared = temperature * temperature;
  return constants::stefan_boltzmann / constants::pi * squared * squared;
}

}  // namespace plenoflame
