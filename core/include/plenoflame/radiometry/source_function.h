#pragma once
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "plenoflame/radiometry/emission_line.h"
#include "plenoflame/radiometry/spectral_response.h"

namespace plenoflame {

/// Spectral radiance of a blackbody, B = 2hc^2 / (lambda^5 (exp(hc/(lambda k T)) - 1)).
/// @param wavelength [m] vacuum, > 0   @param temperature [K], >= 0 (0 gives 0)
/// @return [W/(m^3 sr)], per metre of wavelength   Source: Planck's law; physics as in any text.
double planck_radiance(double wavelength, double temperature);

/// Source function S(T) of one channel, or of one of its wavelengths [W/(m^2 sr)]. It is the
/// emission of a volume in local thermal equilibrium, per unit of absorption.
class SourceFunction {
 public:
  /// Quadrature nodes: S(T) = sum weight / expm1(exponent / T).
  struct Node {
    double exponent;  ///< hc/(lambda k) [K]
    double weight;    ///< quadrature weight * 2hc^2 / lambda^5 [W/(m^2 sr)]
    friend bool operator==(const Node&, const Node&) = default;
  };

  /// sigma T^4 / pi.
  static SourceFunction total();
  /// Planck's function integrated over [wavelength - width/2, wavelength + width/2] by
  /// Gauss-Legendre quadrature. The number of nodes gives a relative error below 1e-12 between 200
  /// K and 1e5 K.
  /// @throws InputError unless 0 < width < 2 * wavelength.
  static SourceFunction band(double wavelength, double width);
  /// Planck's function times the response, integrated over wavelength. It uses the Gauss rule of
  /// the response itself, with enough nodes for the same error.
  static SourceFunction of(const SpectralResponse& response);
  /// One wavelength [m]; `share` of a channel's light is its (see spectral_nodes.h).
  static SourceFunction node(const Node& node, double wavelength, double share);

  /// The same, with optical properties taken at another wavelength [m].
  SourceFunction at(double wavelength) const {
    SourceFunction source = *this;
    source.wavelength_ = wavelength;
    return source;
  }

  /// The same, with another share of what does not follow Planck's law.
  SourceFunction with_share(double share) const {
    SourceFunction source = *this;
    source.share_ = share;
    return source;
  }

  /// Share of an emission line's light that belongs to it.
  struct LineShare {
    EmissionLine line;
    double share;
    friend bool operator==(const LineShare&, const LineShare&) = default;
  };
  /// The same, with its shares of the light of emission lines, which does not follow Planck's law.
  SourceFunction with_lines(std::vector<LineShare> lines) const {
    SourceFunction source = *this;
    source.lines_ = std::move(lines);
    return source;
  }
  /// One wavelength [m] for emission lines only: S = 0.
  static SourceFunction of_lines(double wavelength, std::vector<LineShare> lines);

  /// A share of it; of all wavelengths the band from 0.1 um to 1 mm.
  SourceFunction scaled(double factor) const;

  /// Sources in the ratio of `parts` whose sum is exactly `whole` at every temperature. They are
  /// for surfaces and lights, which may be far colder than the range of the parts' few nodes. They
  /// have no nodes, so media cannot use them. A single part is the whole.
  static std::vector<SourceFunction> sharing(const SourceFunction& whole,
                                             const std::vector<SourceFunction>& parts);

  double operator()(double temperature) const;

  bool is_total() const { return nodes_.empty() && !shared_; }
  /// Empty for total(), and for what shares a whole.
  const std::vector<Node>& nodes() const { return nodes_; }
  /// Wavelength of optical properties [m]: the centroid of the response; 0 for total().
  double wavelength() const { return wavelength_; }
  /// Its share of its channel's light, where that does not follow Planck's law.
  double share() const { return share_; }
  /// Its share of the light of an emission line; 0 for unknown lines.
  double line_share(const EmissionLine& line) const;
  friend bool operator==(const SourceFunction&, const SourceFunction&) = default;

 private:
  std::vector<Node> nodes_;
  double wavelength_ = 0, share_ = 1;
  std::vector<LineShare> lines_;
  struct Shared;
  std::shared_ptr<const Shared> shared_;  ///< nullptr: it is all its own
  std::size_t part_ = 0;                  ///< which of them
};

}  // namespace plenoflame
