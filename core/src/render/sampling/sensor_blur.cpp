#include "render/sampling/sensor_blur.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plenoflame/scene/sensor_spec.h"

namespace plenoflame {
namespace {

/// The part of the points that is spread evenly, so that cells far out stay narrow.
constexpr double kEven = 0.1;
constexpr int kHalvings = 60;  ///< of an interval, down to the precision of a double

double below(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// A Gaussian that ends at kBlurCut deviations, in pixels.
class CutGaussian {
 public:
  explicit CutGaussian(double deviation)
      : deviation_(deviation), tail_(below(-kCut)), inside_(1 - 2 * tail_) {}

  /// The share of the light at an offset that the pixel records.
  double recorded(double offset) const { return share(offset + 0.5) - share(offset - 0.5); }
  /// Its integral from the lower end.
  double integral(double offset) const { return sum(offset + 0.5) - sum(offset - 0.5); }

 private:
  static constexpr double kCut = SensorSpec::kBlurCut;

  /// The distribution function.
  double share(double x) const {
    return (below(std::clamp(x / deviation_, -kCut, kCut)) - tail_) / inside_;
  }
  /// The integral of share() by parts. The integral of the normal distribution function P is z P +
  /// p.
  double sum(double x) const {
    const double z = x / deviation_;
    if (z <= -kCut) return 0;
    const double end = std::min(z, kCut);
    const double whole = end * below(end) + density(end) + kCut * tail_ - density(kCut);
    return deviation_ * ((whole - (end + kCut) * tail_) / inside_ + (z - end));
  }
  static double density(double z) {
    return std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
  }

  double deviation_, tail_, inside_;
};

}  // namespace

SensorBlur::SensorBlur(double deviation) {
  constexpr int kCells = KernelBlur<double>::kCells;
  const CutGaussian gaussian(deviation);
  const double reach = 0.5 + SensorSpec::kBlurCut * deviation;
  const auto drawn_below = [&](double x) {
    return (1 - kEven) * gaussian.integral(x) + kEven * (x + reach) / (2 * reach);
  };
  at_.push_back(-reach);
  for (int i = 1; i < kCells; ++i) {
    double low = at_.back(), high = reach;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (low + high);
      (drawn_below(middle) < static_cast<double>(i) / kCells ? low : high) = middle;
    }
    at_.push_back(0.5 * (low + high));
  }
  at_.push_back(reach);
  double sum = 0;
  for (std::size_t i = 0; i < kCells; ++i) {
    const double width = kCells * (at_[i + 1] - at_[i]);
    low_.push_back(width * gaussian.recorded(at_[i]));
    high_.push_back(width * gaussian.recorded(at_[i + 1]));
    sum += 0.5 * (low_[i] + high_[i]) / kCells;
  }
  // This normalisation makes up for the straight lines between the cells' ends.
  for (double& value : low_) value /= sum;
  for (double& value : high_) value /= sum;
}

double SensorBlur::share(double offset) const {
  if (offset <= at_.front()) return 0;
  if (offset >= at_.back()) return 1;
  const auto next = std::upper_bound(at_.begin(), at_.end(), offset);
  const auto cell = static_cast<std::size_t>(next - at_.begin()) - 1;
  const double part = (offset - at_[cell]) / (at_[cell + 1] - at_[cell]);
  return (static_cast<double>(cell) + part) / static_cast<double>(low_.size());
}

template <class Real>
void SensorBlur::fill(KernelBlur<Real>& kernel) const {
  const auto copy = [](const std::vector<double>& from, Real* to) {
    std::transform(from.begin(), from.end(), to, [](double v) { return static_cast<Real>(v); });
  };
  copy(at_, kernel.at);
  copy(low_, kernel.low);
  copy(high_, kernel.high);
}

template void SensorBlur::fill(KernelBlur<float>&) const;
template void SensorBlur::fill(KernelBlur<double>&) const;

}  // namespace plenoflame
