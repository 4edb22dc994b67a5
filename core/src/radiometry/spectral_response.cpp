#include "plenoflame/radiometry/spectral_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "radiometry/gauss_legendre.h"

namespace plenoflame {
namespace {

/// height * exp(-x^2 / 2), x in standard deviations, which differ below and above the middle [nm].
struct Lobe {
  double height, middle, below, above;
};

struct ResponseRow {
  NamedResponse name;
  double shortest, longest;  ///< [nm]
  std::array<Lobe, 3> lobes;
};

double sum_of_lobes(const std::array<Lobe, 3>& lobes, double wavelength) {
  double sum = 0;
  for (const Lobe& lobe : lobes) {
    if (lobe.height == 0) continue;
    const double away = 1e9 * wavelength - lobe.middle;
    const double x = away / (away < 0 ? lobe.below : lobe.above);
    sum += lobe.height * std::exp(-0.5 * x * x);
  }
  return std::max(sum, 0.0);
}

constexpr std::string_view kCie =
    "CIE 1931 2 degree observer; fit of Wyman, Sloan and Shirley, J. Computer Graphics Techniques "
    "2 (2013) 2";
constexpr std::string_view kNikon =
    "Nikon D5100, measured at NPL: Darrodi et al., J. Opt. Soc. Am. A 32 (2015) 381; our fit of "
    "three lobes to the response relative to its maximum, RMS 0.3 % (blue), 1 % (green), 1.5 % "
    "(red)";

constexpr ResponseRow kNamedResponses[] = {
    {{"cie_x", kCie},
     360,
     830,
     {{{1.056, 599.8, 37.9, 31.0}, {0.362, 442.0, 16.0, 26.7}, {-0.065, 501.1, 20.4, 26.2}}}},
    {{"cie_y", kCie}, 360, 830, {{{0.821, 568.8, 46.9, 40.5}, {0.286, 530.9, 16.3, 31.1}, {}}}},
    {{"cie_z", kCie}, 360, 830, {{{1.217, 437.0, 11.8, 36.0}, {0.681, 459.0, 26.0, 13.8}, {}}}},
    {{"nikon_d5100_red", kNikon},
     400,
     720,
     {{{0.874, 588.12, 7.365, 31.631},
       {0.216, 652.639, 54.443, 10.846},
       {0.077, 533.176, 80.0, 7.367}}}},
    {{"nikon_d5100_green", kNikon},
     400,
     720,
     {{{0.991, 532.128, 31.01, 39.545},
       {0.15, 476.418, 12.193, 7.787},
       {0.157, 436.079, 11.329, 39.368}}}},
    {{"nikon_d5100_blue", kNikon},
     400,
     720,
     {{{0.604, 424.564, 3.883, 55.279},
       {0.343, 476.555, 21.948, 22.362},
       {0.255, 450.635, 16.589, 42.497}}}},
};

}  // namespace

std::vector<NamedResponse> response_names() {
  std::vector<NamedResponse> list;
  for (const ResponseRow& entry : kNamedResponses) list.push_back(entry.name);
  return list;
}

SpectralResponse SpectralResponse::band(double wavelength, double width) {
  const double shortest = wavelength - 0.5 * width, longest = wavelength + 0.5 * width;
  if (!(width > 0) || !(shortest > 0) || !std::isfinite(longest))
    throw InputError(
        fmt::format("a band needs a width above 0 and below twice its wavelength; got wavelength "
                    "{:g} m, width {:g} m",
                    wavelength, width));
  SpectralResponse response;
  response.breakpoints_ = {shortest, longest};
  response.value_ = [](double) { return 1.0; };
  return response;
}

SpectralResponse SpectralResponse::gaussian(double wavelength, double width) {
  if (!(width > 0) || !(width < wavelength) || !std::isfinite(wavelength))
    throw InputError(
        fmt::format("a line filter needs a width above 0 and below its wavelength; got wavelength "
                    "{:g} m, width {:g} m",
                    wavelength, width));
  const double deviation = width / std::sqrt(8 * std::log(2.0));
  SpectralResponse response;
  // Panels of half a deviation: a rule of ten nodes in each has no error left.
  for (int i = -8; i <= 8; ++i)
    response.breakpoints_.push_back(wavelength + 0.5 * i * std::min(deviation, wavelength / 4.5));
  response.value_ = [wavelength, deviation](double at) {
    const double x = (at - wavelength) / deviation;
    return std::exp(-0.5 * x * x);
  };
  return response;
}

SpectralResponse SpectralResponse::curve(std::vector<SpectralPoint> points) {
  // The same checks as of a text.
  points = parse_spectral_points(format_spectral_points(points));
  SpectralResponse response;
  for (const SpectralPoint& point : points) response.breakpoints_.push_back(point.wavelength);
  response.value_ = [points = std::move(points)](double at) {
    const auto after =
        std::upper_bound(points.begin(), points.end(), at,
                         [](double w, const SpectralPoint& p) { return w < p.wavelength; });
    if (after == points.begin()) return at < points.front().wavelength ? 0.0 : points.front().value;
    if (after == points.end()) return at > points.back().wavelength ? 0.0 : points.back().value;
    const SpectralPoint& low = *(after - 1);
    const double share = (at - low.wavelength) / (after->wavelength - low.wavelength);
    return low.value + share * (after->value - low.value);
  };
  return response;
}

SpectralResponse SpectralResponse::named(std::string_view name) {
  std::string known;
  for (const ResponseRow& entry : kNamedResponses) {
    known.append(known.empty() ? "" : ", ").append(entry.name.name);
    if (entry.name.name != name) continue;
    SpectralResponse response;
    std::vector<double> kinks{entry.shortest, entry.longest};
    for (double w = entry.shortest; w < entry.longest; w += 10) kinks.push_back(w);
    for (const Lobe& lobe : entry.lobes)
      if (lobe.height != 0) kinks.push_back(lobe.middle);
    std::sort(kinks.begin(), kinks.end());
    for (const double kink : kinks)
      if (response.breakpoints_.empty() || 1e-9 * kink > response.breakpoints_.back())
        response.breakpoints_.push_back(1e-9 * kink);
    response.value_ = [lobes = entry.lobes](double at) { return sum_of_lobes(lobes, at); };
    return response;
  }
  throw InputError(fmt::format("there is no response \"{}\"; known are {}", name, known));
}

double SpectralResponse::operator()(double wavelength) const {
  return wavelength < shortest() || wavelength > longest() ? 0.0 : value_(wavelength);
}

double SpectralResponse::integral() const {
  return moments()[0];
}

double SpectralResponse::centroid() const {
  const auto [sum, moment] = moments();
  return shortest() + moment / sum;
}

std::array<double, 2> SpectralResponse::moments() const {
  const GaussLegendreRule rule(10);
  double sum = 0, moment = 0;
  for (std::size_t k = 0; k + 1 < breakpoints_.size(); ++k) {
    const double middle = 0.5 * (breakpoints_[k] + breakpoints_[k + 1]);
    const double half = 0.5 * (breakpoints_[k + 1] - breakpoints_[k]);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
      const double w = half * rule.weights[i] * value_(middle + half * rule.nodes[i]);
      sum += w;
      moment += w * half * rule.nodes[i] + w * (middle - shortest());
    }
  }
  return {sum, moment};
}

SpectralResponse SpectralResponse::broken_at(const std::vector<double>& wavelengths) const {
  SpectralResponse response = *this;
  std::vector<double>& breaks = response.breakpoints_;
  for (const double at : wavelengths)
    if (at > shortest() && at < longest()) breaks.push_back(at);
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  return response;
}

SpectralResponse SpectralResponse::behind(const SpectralResponse& filter) const {
  const double low = std::max(shortest(), filter.shortest());
  const double high = std::min(longest(), filter.longest());
  const auto refuse = [&] {
    throw InputError(fmt::format(
        "the filter ({:g} to {:g} nm) lets nothing through of the channel ({:g} to {:g} nm)",
        1e9 * filter.shortest(), 1e9 * filter.longest(), 1e9 * shortest(), 1e9 * longest()));
  };
  if (!(low < high)) refuse();
  SpectralResponse response;
  for (const std::vector<double>* list : {&breakpoints_, &filter.breakpoints_})
    for (const double at : *list)
      if (at >= low && at <= high) response.breakpoints_.push_back(at);
  std::sort(response.breakpoints_.begin(), response.breakpoints_.end());
  const auto end = std::unique(response.breakpoints_.begin(), response.breakpoints_.end());
  response.breakpoints_.erase(end, response.breakpoints_.end());
  response.value_ = [a = *this, b = filter](double at) { return a(at) * b(at); };
  if (!(response.integral() > 0)) refuse();  // 0 where they meet
  return response;
}

SpectralResponse SpectralResponse::of_photons() const {
  return times([inverse = 1 / centroid()](double at) { return at * inverse; });
}

SpectralResponse SpectralResponse::times(std::function<double(double)> factor) const {
  SpectralResponse response = *this;
  response.value_ = [value = value_, factor = std::move(factor)](double at) {
    return value(at) * factor(at);
  };
  return response;
}

}  // namespace plenoflame
