#pragma once
#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace plenoflame {

/// One point of a spectral curve.
struct SpectralPoint {
  double wavelength = 0;  ///< [m] vacuum
  double value = 0;
  friend bool operator==(const SpectralPoint&, const SpectralPoint&) = default;
};

/// Reads "450 nm 0.2, 460 nm 0.35, ...": a wavelength with its unit, then the value, separated by
/// commas.
/// @throws InputError that names the item: no unit, not a number, fewer than two points, values
///         below 0 or none above
/// @throws InputError for wavelengths that do not ascend or lie outside of 10 nm to 1 mm
std::vector<SpectralPoint> parse_spectral_points(std::string_view text);
std::string format_spectral_points(const std::vector<SpectralPoint>& points);

/// Reads a CSV file: two columns, wavelength and value, one point per line; # begins a comment. A
/// header may state the unit of the first column ("wavelength_um"); without one it is nm.
/// @throws FileError; InputError with file and line: as above, and wavelengths that are evidently
/// in another unit than stated, naming the likely one
std::vector<SpectralPoint> read_spectral_csv(const std::string& path);

/// Share of the light of each wavelength that a channel counts, R(lambda) >= 0: dimensionless, 1 in
/// the middle of an ideal filter.
class SpectralResponse {
 public:
  /// 1 within the band. @throws InputError unless 0 < width < 2 * wavelength
  static SpectralResponse band(double wavelength, double width);
  /// A line filter, exp(-4 ln 2 ((lambda - wavelength) / width)^2); width: full, at half the
  /// maximum. Cut off at 4 standard deviations (6e-5 of its area).
  /// @throws InputError unless 0 < width < wavelength
  static SpectralResponse gaussian(double wavelength, double width);
  /// Straight lines between the points, 0 outside. @throws InputError as parse_spectral_points
  static SpectralResponse curve(std::vector<SpectralPoint> points);
  /// A named response (response_names()). @throws InputError listing them
  static SpectralResponse named(std::string_view name);

  double operator()(double wavelength) const;
  double shortest() const { return breakpoints_.front(); }
  double longest() const { return breakpoints_.back(); }
  /// Wavelengths between which the response is smooth, ascending [m].
  const std::vector<double>& breakpoints() const { return breakpoints_; }
  /// Mean wavelength, weighted by the response [m].
  double centroid() const;
  /// For a curve that is a quantum efficiency: R(lambda) lambda / centroid(), with which flux *
  /// centroid() / (hc) is the rate of electrons, exactly.
  SpectralResponse of_photons() const;
  /// R(lambda) times a factor that is smooth where R is.
  SpectralResponse times(std::function<double(double)> factor) const;
  /// The same, with points of these that lie within it among its breakpoints.
  SpectralResponse broken_at(const std::vector<double>& wavelengths) const;
  /// Integral over wavelength [m].
  double integral() const;
  /// The response behind a filter. @throws InputError when nothing is left
  SpectralResponse behind(const SpectralResponse& filter) const;

 private:
  std::array<double, 2> moments() const;  ///< of R and R (lambda - shortest)
  std::vector<double> breakpoints_;
  std::function<double(double)> value_;
};

/// A response that has a name, and where it comes from.
struct NamedResponse {
  std::string_view name, source;
};
std::vector<NamedResponse> response_names();

}  // namespace plenoflame
