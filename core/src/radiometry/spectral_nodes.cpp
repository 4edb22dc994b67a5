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
constexpr int kMostOfPieces = 64;               ///< nodes of all pieces together
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

/// The points between the kinks [m, ascending] of the spectra, as one measure each.
std::vector<MeasurePoints> split(const MeasurePoints& measure, const std::vector<double>& kinks) {
  std::vector<MeasurePoints> pieces(kinks.size() + 1);
  for (std::size_t i = 0; i < measure.places.size(); ++i) {
    const auto after = std::upper_bound(kinks.begin(), kinks.end(), 1 / measure.places[i]);
    // Wavenumbers ascend.
    MeasurePoints& piece = pieces[static_cast<std::size_t>(kinks.end() - after)];
    piece.places.push_back(measure.places[i]);
    piece.weights.push_back(measure.weights[i]);
  }
  std::erase_if(pieces, [](const MeasurePoints& piece) { return piece.places.empty(); });
  return pieces;
}

std::vector<double> kinks_of(const std::vector<AbsorptionSpectrum>& spectra) {
  std::vector<double> kinks;
  for (const AbsorptionSpectrum& spectrum : spectra)
    for (const double at : spectrum.breakpoints()) kinks.push_back(at);
  std::sort(kinks.begin(), kinks.end());
  return kinks;
}

/// A response times Planck's function at the reference, as points: what a channel counts.
MeasurePoints weighted_points(const SpectralResponse& response, const std::vector<double>& kinks) {
  MeasurePoints measure = wavenumber_points(response.broken_at(kinks), 8);
  for (std::size_t i = 0; i < measure.places.size(); ++i) {
    const double s = measure.places[i];
    measure.weights[i] *= s * s * s * planck_factor(s, kReferenceTemperature);
  }
  return measure;
}

/// Weights at the places with which polynomials are integrated as by the measure: that of each
/// place is the integral of Lagrange's polynomial.
std::vector<double> interpolatory_weights(const std::vector<double>& places,
                                          const MeasurePoints& measure) {
  std::vector<double> weights(places.size());
  for (std::size_t i = 0; i < measure.places.size(); ++i)
    for (std::size_t k = 0; k < places.size(); ++k) {
      double basis = measure.weights[i];
      for (std::size_t j = 0; j < places.size(); ++j)
        if (j != k) basis *= (measure.places[i] - places[j]) / (places[k] - places[j]);
      weights[k] += basis;
    }
  return weights;
}

/// A rule for the measure at some of the places, with positive weights only. Emission must not
/// become negative, even for gas of another spectrum than the rule's.
MeasurePoints positive_rule(std::vector<double> places, const MeasurePoints& measure) {
  for (;;) {
    std::vector<double> weights = interpolatory_weights(places, measure);
    const auto least = std::min_element(weights.begin(), weights.end());
    if (*least > 0) return {std::move(places), std::move(weights)};
    places.erase(places.begin() + (least - weights.begin()));
  }
}

}  // namespace

ChannelNodes channel_nodes(const std::optional<SpectralResponse>& response,
                           const std::vector<AbsorptionSpectrum>& spectra, int fewest) {
  const SourceFunction whole = response ? SourceFunction::of(*response) : SourceFunction::total();
  const bool grey = std::all_of(spectra.begin(), spectra.end(),
                                [](const AbsorptionSpectrum& s) { return s.is_grey(); });
  if (grey && (fewest == 1 || !response)) return {{whole}, 0};
  const std::vector<double> kinks = kinks_of(spectra);
  const SpectralResponse band =
      response ? *response
               : SpectralResponse::band(0.5 * (kShortest + kLongest), kLongest - kShortest);
  const MeasurePoints measure = weighted_points(band, kinks);
  const std::vector<SourceFunction> all = nodes_of(measure);
  ChannelNodes best;
  const auto good_enough = [&](std::vector<SourceFunction> nodes) {
    const double error = worst_error(nodes, all, spectra);
    if (best.nodes.empty() || error < best.error) best = {std::move(nodes), error};
    return best.error <= kSpectralTolerance;
  };
  for (int count = fewest; count <= kMostNodes; ++count) {
    const MeasurePoints rule = gauss_rule(measure, count);
    // The emission of a single wavelength is exact.
    if (good_enough(count == 1 && response ? std::vector{whole.at(1 / rule.places[0])}
                                           : nodes_of(rule)))
      return best;
  }
  // Tables that are too steep for one rule: a rule of its own in every straight piece.
  const std::vector<MeasurePoints> pieces = split(measure, kinks);
  for (int order = 1; order * static_cast<int>(pieces.size()) <= kMostOfPieces; ++order) {
    MeasurePoints rule;
    for (const MeasurePoints& piece : pieces) {
      const int count = std::min(order, static_cast<int>(piece.places.size()));
      const MeasurePoints own = gauss_rule(piece, count);
      rule.places.insert(rule.places.end(), own.places.begin(), own.places.end());
      rule.weights.insert(rule.weights.end(), own.weights.begin(), own.weights.end());
    }
    if (good_enough(nodes_of(rule))) break;
  }
  return best;
}

std::optional<SharedNodes> shared_nodes(const std::vector<SpectralResponse>& responses,
                                        const std::vector<AbsorptionSpectrum>& spectra, int most) {
  const std::vector<double> kinks = kinks_of(spectra);
  std::vector<MeasurePoints> measures;
  std::vector<std::vector<SourceFunction>> all;
  MeasurePoints together;
  for (const SpectralResponse& response : responses) {
    const MeasurePoints& measure = measures.emplace_back(weighted_points(response, kinks));
    all.push_back(nodes_of(measure));
    double sum = 0;
    for (const double weight : measure.weights) sum += weight;
    together.places.insert(together.places.end(), measure.places.begin(), measure.places.end());
    for (const double weight : measure.weights) together.weights.push_back(weight / sum);
  }
  const std::size_t channels = responses.size();
  const auto limit = std::min<std::size_t>(static_cast<std::size_t>(std::min(most, kMostNodes)),
                                           together.places.size() - 1);
  for (std::size_t count = 2; count <= limit; ++count) {
    std::vector<double> places = gauss_rule(together, static_cast<int>(count)).places;
    std::vector<MeasurePoints> rules;
    double error = 0;
    for (std::size_t c = 0; c < channels && error <= kSpectralTolerance; ++c) {
      rules.push_back(positive_rule(places, measures[c]));
      error = std::max(error, worst_error(nodes_of(rules[c]), all[c], spectra));
    }
    if (error > kSpectralTolerance) continue;
    // One node represents the first channel (transmittance, optical thickness): the one with its
    // largest weight.
    const auto heaviest = std::max_element(rules[0].weights.begin(), rules[0].weights.end());
    const double first =
        rules[0].places[static_cast<std::size_t>(heaviest - rules[0].weights.begin())];
    std::swap(places.front(), *std::find(places.begin(), places.end(), first));
    // Every place carries the largest of its channels' weights, of which these take their shares.
    MeasurePoints joint;
    for (const double place : places) {
      double largest = 0;
      for (const MeasurePoints& rule : rules)
        for (std::size_t k = 0; k < rule.places.size(); ++k)
          if (rule.places[k] == place) largest = std::max(largest, rule.weights[k]);
      if (largest == 0) continue;
      joint.places.push_back(place);
      joint.weights.push_back(largest);
    }
    const std::size_t nodes = joint.places.size();
    std::vector<double> shares(channels * nodes);
    for (std::size_t c = 0; c < channels; ++c)
      for (std::size_t n = 0; n < nodes; ++n)
        for (std::size_t k = 0; k < rules[c].places.size(); ++k)
          if (rules[c].places[k] == joint.places[n])
            shares[c * nodes + n] = rules[c].weights[k] / joint.weights[n];
    return SharedNodes{nodes_of(joint), {static_cast<int>(channels), std::move(shares)}, error};
  }
  return std::nullopt;
}

}  // namespace plenoflame
