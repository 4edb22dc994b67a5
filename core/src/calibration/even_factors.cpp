#include "calibration/even_factors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

double middle_ratio(std::vector<float> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

/// A picture of the wrong kind has dark pixels everywhere.
void check_dark_share(const EvenFactors& even, bool white) {
  constexpr double kMost = 0.05;
  const auto dark = std::count_if(even.factors.begin(), even.factors.end(),
                                  [](float factor) { return factor < 0; });
  const double share = static_cast<double>(dark) / static_cast<double>(even.factors.size());
  if (share > kMost)
    throw InputError(fmt::format(
        "{:.0f} % of the pixels are too dark in the {}, and 5 % is the most that dirt and edges "
        "may be: {}, well exposed; a dark frame or a picture of a flame is none",
        100 * share, white ? "white picture" : "flat field",
        white ? "a white picture shows an evenly bright scene through this camera"
              : "a flat field is the bare sensor, evenly lit"));
}

/// How much light varies as it is expected to: their correlation; 1 where nothing varies.
class Likeness {
 public:
  void add(double light, double wanted) {
    ++count_;
    x_ += light, y_ += wanted;
    xx_ += light * light, yy_ += wanted * wanted, xy_ += light * wanted;
  }
  double correlation() const {
    constexpr double kLeastSpread = 0.1;  // of the mean: noise is not to decide
    const double n = count_, varied = yy_ * n - y_ * y_;
    if (!(varied > kLeastSpread * kLeastSpread * y_ * y_)) return 1;
    const double spread = std::sqrt(std::max(0.0, xx_ * n - x_ * x_) * varied);
    return spread > 0 ? (xy_ * n - x_ * y_) / spread : 0;
  }

 private:
  double count_ = 0, x_ = 0, y_ = 0, xx_ = 0, yy_ = 0, xy_ = 0;
};

}  // namespace

EvenFactors even_factors(
    const CountFrames& measured, const Image* expected, std::size_t colours,
    const std::function<std::size_t(std::size_t pixel)>& colour_of,
    const std::function<std::pair<double, double>(std::size_t pixel)>& light_of) {
  const std::size_t pixels = measured.pixel_count();
  EvenFactors even{std::vector<float>(pixels, 0.0F), std::vector<float>(pixels, 0.0F)};
  double brightest = 0;
  if (expected != nullptr)
    for (const float value : expected->pixels)
      brightest = std::max(brightest, static_cast<double>(value));
  constexpr double kLeastLight = 0.05;  // of the brightest: below nothing is known of the factor
  std::vector<std::vector<float>> usual(colours);
  std::vector<Likeness> likeness(colours);
  for (std::size_t i = 0; i < pixels; ++i) {
    const double wanted = expected != nullptr ? static_cast<double>(expected->pixels[i]) : 1;
    if (measured.state[i] != 0) continue;
    const auto [light, variance] = light_of(i);
    likeness[colour_of(i)].add(light, wanted);
    if (wanted < kLeastLight * brightest) continue;
    // A pixel that saw almost no light where light was expected has no factor.
    if (!(light > 5 * std::sqrt(variance))) {
      even.factors[i] = -1;
      continue;
    }
    even.factors[i] = static_cast<float>(wanted / light);
    even.relative_variance[i] = static_cast<float>(variance / light / light);
    usual[colour_of(i)].push_back(even.factors[i]);
  }
  std::vector<double> middle;
  for (std::vector<float>& ratios : usual) middle.push_back(middle_ratio(std::move(ratios)));
  constexpr double kLargestFactor = 4;  // darker than it should be by far
  for (std::size_t i = 0; i < pixels; ++i) {
    if (!(even.factors[i] > 0)) continue;
    const double factor = static_cast<double>(even.factors[i]) / middle[colour_of(i)];
    even.factors[i] = factor > kLargestFactor ? -1.0F : static_cast<float>(factor);
  }
  check_dark_share(even, expected != nullptr);
  constexpr double kLeastLikeness = 0.3;
  if (expected != nullptr &&
      std::all_of(likeness.begin(), likeness.end(),
                  [](const Likeness& each) { return each.correlation() < kLeastLikeness; }))
    throw InputError(
        "the white picture shows no micro-images where the camera's are: a flat field is none, and "
        "neither is one of another camera or focus");
  return even;
}

double sensor_variance(const CountFrames& frames, double above_black,
                       const SensorResponse& sensor) {
  double variance = kRoundingVariance;
  if (sensor.gain > 0)
    variance += std::max(0.0, above_black) / sensor.gain +
                sensor.read_noise * sensor.read_noise / sensor.gain / sensor.gain;
  return variance / frames.frames;
}

void make_linear(double curvature, double& counts, double& variance) {
  const double slope = 1 + 2 * curvature * counts;
  counts *= 1 + curvature * counts;
  variance *= slope * slope;
}

}  // namespace plenoflame
