#pragma once
#include <vector>

namespace plenoflame {

/// Spectral radiance of a blackbody, B = 2hc^2 / (lambda^5 (exp(hc/(lambda k T)) - 1)).
/// @param wavelength [m] vacuum, > 0   @param temperature [K], >= 0 (0 gives 0)
/// @return [W/(m^3 sr)], per metre of wavelength   Source: Planck's law; physics as in any text.
double planck_radiance(double wavelength, double temperature);

/// Source function S(T) of one channel [W/(m^2 sr)]: what a volume in local thermal equilibrium
/// emits into it, per unit of absorption.
class SourceFunction {
 public:
  /// sigma T^4 / pi.
  static SourceFunction total();
  /// Planck's function integrated over [wavelength - width/2, wavelength + width/2] by
  /// Gauss-Legendre quadrature with as many nodes as a relative error of 1e-12 between 200 K and
  /// 1e5 K needs. @throws InputError unless 0 < width < 2 * wavelength.
  static SourceFunction band(double wavelength, double width);

  double operator()(double temperature) const;

  bool is_total() const { return nodes_.empty(); }
  /// Quadrature nodes: S(T) = sum weight / expm1(exponent / T); empty for total().
  struct Node {
    double exponent;  ///< hc/(lambda k) [K]
    double weight;    ///< quadrature weight * 2hc^2 / lambda^5 [W/(m^2 sr)]
  };
  const std::vector<Node>& nodes() const { return nodes_; }

 private:
  std::vector<Node> nodes_;
};

}  // namespace plenoflame
