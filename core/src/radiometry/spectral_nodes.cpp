#include "plenoflame/radiometry/spectral_nodes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "plenoflame/base/constants.h"
#include "radiometry/gauss_rule.h"

namespace plenoflame {
namespace {

constexpr int kMostNodes = 16;
constexpr double kReferenceTemperature = 1700;  // [K] whose spectrum the rule is made for
constexpr std::array<double, 6> kTemperatures{1000, 1300, 1600, 1900, 2200, 2600};
constexpr std::array<double, 6> kDepths{0, 0.1, 0.4, 1, 3, 10};
constexpr double kShortest = 0.15e-6, kLongest = 300e-6;  // [m] of all wavelengths

double planck_factor(double wavenumber, double temperature) {
  return 1 / std::expm1(constants::second_radiation * wavenumber / temperature);
}

/// (1 - e^(-s depth)) / depth at s: what a path sends, per unit of its depth.
double emitted(double factor, double depth) {
  return depth > 0 ? -std::expm1(-factor * depth) / depth : factor;
}

struct Term {
  const SourceFunction* source;
  double factor;
};

double radiance(const std::vector<Term>& terms, double temperature, double depth) {
  double sum = 0;
  for (const Term& term : terms) sum += (*term.source)(temperature)*emitted(term.factor, depth);
  return sum;
}

std::vector<SourceFunction> nodes_of(const MeasurePoints& rule) {
  double total = 0;
  for (const double weight : rule.weights) total += weight;
  std::vector<SourceFunction> nodes;
  for (std::size_t i = 0; i < rule.places.size(); ++i) {
    const double s = rule.places[i];
    // The measure has Planck's function at the reference in it; the node brings its own.
    nodes.push_back(SourceFunction::node(
        {constants::second_radiation * s,
         constants::first_radiation * rule.weights[i] / planck_factor(s, kReferenceTemperature)},
        1 / s, rule.weights[i] / total));
  }
  return nodes;
}

double worst_error(const std::vector<SourceFunction>& nodes, const std::vector<SourceFunction>& all,
                   const std::vector<AbsorptionSpectrum>& spectra) {
  double worst = 0;
  for (const AbsorptionSpectrum& spectrum : spectra) {
    const auto terms_of = [&](const std::vector<SourceFunction>& sources) {
      std::vector<Term> terms;
      for (const SourceFunction& source : sources)
        terms.push_back({&source, spectrum.factor(source.wavelength())});
      return terms;
    };
    const std::vector<Term> few = terms_of(nodes), many = terms_of(all);
    for (const double t : kTemperatures)
      for (const double depth : kDepths) {
        const double expected = radiance(many, t, depth);
        worst = std::max(worst, std::fabs(radiance(few, t, depth) / expected - 1));
      }
  }
  return worst;
}

}  // namespace

ChannelNodes channel_nodes(const std::optional<SpectralResponse>& response,
                           const std::vector<AbsorptionSpectrum>& spectra) {
  const SourceFunction whole = response ? SourceFunction::of(*response) : SourceFunction::total();
  const bool grey = std::all_of(spectra.begin(), spectra.end(),
                                [](const AbsorptionSpectrum& s) { return s.is_grey(); });
  if (grey) return {{whole}, 0};
  MeasurePoints measure = wavenumber_points(
      response ? *response
               : SpectralResponse::band(0.5 * (kShortest + kLongest), kLongest - kShortest),
      8);
  for (std::size_t i = 0; i < measure.places.size(); ++i) {
    const double s = measure.places[i];
    measure.weights[i] *= s * s * s * planck_factor(s, kReferenceTemperature);
  }
  const std::vector<SourceFunction> all = nodes_of(measure);
  ChannelNodes best;
  for (int count = 1; count <= kMostNodes; ++count) {
    const MeasurePoints rule = gauss_rule(measure, count);
    std::vector<SourceFunction> nodes = nodes_of(rule);
    if (count == 1 && response)  // what it emits is exact then
      nodes = {whole.at(1 / rule.places[0])};
    const double error = worst_error(nodes, all, spectra);
    if (count == 1 || error < best.error) best = {std::move(nodes), error};
    if (best.error <= kSpectralTolerance) break;
  }
  return best;
}

}  // namespace plenoflame
