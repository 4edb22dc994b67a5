#include "plenoflame/calibration/lattice_guess.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

using Complex = std::complex<float>;

/// Fourier transform of a square picture in place, along rows and then along columns.
void transform(std::vector<Complex>& picture, int side, bool back) {
  Eigen::FFT<float> fft;
  std::vector<Complex> line(static_cast<std::size_t>(side)), result;
  for (int pass = 0; pass < 2; ++pass)
    for (int k = 0; k < side; ++k) {
      const auto at = [&](int i) -> Complex& {
        return picture[static_cast<std::size_t>(pass == 0 ? k : i) *
                           static_cast<std::size_t>(side) +
                       static_cast<std::size_t>(pass == 0 ? i : k)];
      };
      for (int i = 0; i < side; ++i) line[static_cast<std::size_t>(i)] = at(i);
      if (back)
        fft.inv(result, line);
      else
        fft.fwd(result, line);
      for (int i = 0; i < side; ++i) at(i) = result[static_cast<std::size_t>(i)];
    }
}

/// The correlation of the picture's middle with itself, moved by up to `reach` pixels; 1 unmoved.
class Autocorrelation {
 public:
  explicit Autocorrelation(const Image& white) {
    side_ = 64;
    while (2 * side_ <= std::min({white.width, white.height, 1024})) side_ *= 2;
    if (white.width < side_ || white.height < side_)
      throw InputError("a white picture needs 64 x 64 pixels or more");
    x_ = (white.width - side_) / 2;
    y_ = (white.height - side_) / 2;
    const auto pixels = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
    std::vector<Complex> picture(pixels), window(pixels);
    double mean = 0;
    for (int y = 0; y < side_; ++y)
      for (int x = 0; x < side_; ++x) mean += static_cast<double>(white.at(x_ + x, y_ + y));
    mean /= static_cast<double>(pixels);
    const auto bell = [&](int i) {
      return std::pow(std::sin(std::numbers::pi * (i + 0.5) / side_), 2);
    };
    for (int y = 0; y < side_; ++y)
      for (int x = 0; x < side_; ++x) {
        const std::size_t at = index(x, y);
        const double weight = bell(x) * bell(y);
        window[at] = static_cast<float>(weight);
        picture[at] =
            static_cast<float>(weight * (static_cast<double>(white.at(x_ + x, y_ + y)) - mean));
      }
    correlate(picture, true);
    correlate(window, false);
    values_.resize(pixels);
    for (std::size_t i = 0; i < pixels; ++i)
      values_[i] = picture[i].real() / std::max(window[i].real(), 1e-3F * window[0].real());
    const float whole = values_[0];
    if (!(whole > 0)) throw InputError("the white picture is evenly grey: no micro-image is seen");
    for (float& value : values_) value /= whole;
  }

  int side() const { return side_; }
  int left() const { return x_; }
  int top() const { return y_; }
  double reach() const { return side_ / 3.0; }
  double at(int dx, int dy) const {
    return static_cast<double>(
        values_[index((dx % side_ + side_) % side_, (dy % side_ + side_) % side_)]);
  }
  bool is_peak(int dx, int dy) const {
    const double here = at(dx, dy);
    for (int v = -1; v <= 1; ++v)
      for (int u = -1; u <= 1; ++u)
        if ((u != 0 || v != 0) && !(here > at(dx + u, dy + v))) return false;
    return true;
  }
  /// The peak at a pixel by parabolas through its neighbours.
  Vec2 refined(int dx, int dy) const {
    const auto vertex = [](double low, double middle, double high) {
      const double curve = low - 2 * middle + high;
      return curve < 0 ? std::clamp(0.5 * (low - high) / curve, -0.5, 0.5) : 0.0;
    };
    return {dx + vertex(at(dx - 1, dy), at(dx, dy), at(dx + 1, dy)),
            dy + vertex(at(dx, dy - 1), at(dx, dy), at(dx, dy + 1))};
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) +
           static_cast<std::size_t>(x);
  }
  /// @param slow leaves out what changes slowly: vignetting and the window itself
  void correlate(std::vector<Complex>& picture, bool slow) const {
    transform(picture, side_, false);
    for (int y = 0; y < side_; ++y)
      for (int x = 0; x < side_; ++x) {
        const int u = std::min(x, side_ - x), v = std::min(y, side_ - y);
        const bool left_out = slow && u * u + v * v < 16;
        Complex& value = picture[index(x, y)];
        value = left_out ? Complex(0) : Complex(std::norm(value));
      }
    transform(picture, side_, true);
  }

  int side_ = 0, x_ = 0, y_ = 0;
  std::vector<float> values_;
};

struct Peak {
  Vec2 at;
  double height = 0;
};

std::vector<Peak> peaks_of(const Autocorrelation& correlation) {
  std::vector<Peak> peaks;
  const int reach = static_cast<int>(correlation.reach());
  for (int dy = 0; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      if (dy == 0 && dx <= 0) continue;
      if (dx * dx + dy * dy < 9 || dx * dx + dy * dy > reach * reach) continue;
      if (correlation.is_peak(dx, dy))
        peaks.push_back({correlation.refined(dx, dy), correlation.at(dx, dy)});
    }
  return peaks;
}

double angle_between(Vec2 a, Vec2 b) {
  return std::acos(std::clamp(dot(a, b) / (length(a) * length(b)), -1.0, 1.0)) * 180 /
         std::numbers::pi;
}

/// Steps that fit all peaks of the lattice best, from the neighbours outwards.
void refine_steps(const Autocorrelation& correlation, Vec2& a, Vec2& b) {
  for (double radius = 2.5 * std::max(length(a), length(b));; radius *= 2) {
    const double far = std::min(radius, correlation.reach() - 1);
    double aa = 0, ab = 0, bb = 0;
    Vec2 ra, rb;
    const int most = static_cast<int>(far / std::min(length(a), length(b))) + 1;
    for (int i = -most; i <= most; ++i)
      for (int j = -most; j <= most; ++j) {
        const Vec2 expected = static_cast<double>(i) * a + static_cast<double>(j) * b;
        if ((i == 0 && j == 0) || length(expected) > far) continue;
        const int x = static_cast<int>(std::lround(expected.x)),
                  y = static_cast<int>(std::lround(expected.y));
        for (int v = -1; v <= 1; ++v)
          for (int u = -1; u <= 1; ++u) {
            if (!correlation.is_peak(x + u, y + v)) continue;
            const Vec2 seen = correlation.refined(x + u, y + v);
            aa += i * i;
            ab += i * j;
            bb += j * j;
            ra = ra + static_cast<double>(i) * seen;
            rb = rb + static_cast<double>(j) * seen;
          }
      }
    const double determinant = aa * bb - ab * ab;
    if (determinant > 0) {
      a = (1 / determinant) * (bb * ra - ab * rb);
      b = (1 / determinant) * (aa * rb - ab * ra);
    }
    if (far < radius) return;
  }
}

/// The mean of the picture's middle over all cells of the lattice, and where in it the light is.
void find_origin(const Image& white, const Autocorrelation& correlation, LatticeGuess& guess) {
  constexpr int kCells = 48;
  std::vector<double> sum(kCells * kCells), count(kCells * kCells);
  const double determinant = guess.step_i.x * guess.step_j.y - guess.step_i.y * guess.step_j.x;
  const Vec2 middle{correlation.left() + 0.5 * correlation.side(),
                    correlation.top() + 0.5 * correlation.side()};
  // The steps are known to a hundredth of a pixel. Only a part of the picture is folded, in which
  // this error adds up to less than a tenth of a step.
  const int half = static_cast<int>(std::min(0.5 * correlation.side(), 10 * guess.pitch()));
  for (int y = static_cast<int>(middle.y) - half; y < static_cast<int>(middle.y) + half; ++y)
    for (int x = static_cast<int>(middle.x) - half; x < static_cast<int>(middle.x) + half; ++x) {
      const Vec2 d{x + 0.5 - middle.x, y + 0.5 - middle.y};
      double i = (d.x * guess.step_j.y - d.y * guess.step_j.x) / determinant;
      double j = (d.y * guess.step_i.x - d.x * guess.step_i.y) / determinant;
      i -= std::floor(i);
      j -= std::floor(j);
      const auto cell =
          static_cast<std::size_t>(std::min(kCells - 1, static_cast<int>(i * kCells)) * kCells +
                                   std::min(kCells - 1, static_cast<int>(j * kCells)));
      sum[cell] += static_cast<double>(white.at(x, y));
      count[cell] += 1;
    }
  double low = 1e300, high = -1e300;
  for (std::size_t k = 0; k < sum.size(); ++k) {
    if (count[k] > 0) sum[k] /= count[k];
    low = std::min(low, sum[k]);
    high = std::max(high, sum[k]);
  }
  // The place where a disc of 0.3 of the pitch holds the most light.
  double best = -1e300;
  const double reach = 0.3 * std::min(length(guess.step_i), length(guess.step_j));
  std::vector<std::pair<int, int>> disc;
  for (int i = -kCells / 2; i < kCells / 2; ++i)
    for (int j = -kCells / 2; j < kCells / 2; ++j)
      if (length((1.0 * i / kCells) * guess.step_i + (1.0 * j / kCells) * guess.step_j) <= reach)
        disc.emplace_back(i, j);
  Vec2 where;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      double light = 0;
      for (const auto& [u, v] : disc)
        light += sum[static_cast<std::size_t>((i + u + kCells) % kCells * kCells +
                                              (j + v + kCells) % kCells)];
      if (light <= best) continue;
      best = light;
      where = {(i + 0.5) / kCells, (j + 0.5) / kCells};
    }
  guess.origin = middle + where.x * guess.step_i + where.y * guess.step_j;
  // The area above half of the light is a disc.
  const auto lit = std::count_if(sum.begin(), sum.end(),
                                 [&](double value) { return value > 0.5 * (low + high); });
  guess.radius = std::sqrt(std::fabs(determinant) * static_cast<double>(lit) /
                           (kCells * kCells * std::numbers::pi));
}

}  // namespace

LatticeGuess find_lattice(const Image& white) {
  const Autocorrelation correlation(white);
  std::vector<Peak> peaks = peaks_of(correlation);
  double highest = 0;
  for (const Peak& peak : peaks) highest = std::max(highest, peak.height);
  // With noise alone the largest of all correlations is some 15 / side.
  const double least = std::max(0.05, 20.0 / correlation.side());
  if (highest < least)
    throw InputError(fmt::format(
        "no lattice is seen: the middle of the picture repeats at no distance from 3 to {:.0f} "
        "pixels (correlation {:.3f} at best, {:.2f} is needed); is it a white picture, sharp and "
        "not "
        "overexposed?",
        correlation.reach(), highest, least));
  // Types of microlenses look alike enough for neighbours to correlate; the lattice of one type
  // alone does so more, and is wider.
  std::erase_if(peaks, [&](const Peak& peak) { return peak.height < 0.4 * highest; });
  std::sort(peaks.begin(), peaks.end(),
            [](const Peak& a, const Peak& b) { return length(a.at) < length(b.at); });
  const Vec2 first = peaks.front().at;
  Vec2 second;
  for (const Peak& peak : peaks) {
    const double angle = angle_between(first, peak.at);
    if (angle < 35 || angle > 145) continue;
    second = peak.at;
    break;
  }
  if (length(second) == 0)
    throw InputError(fmt::format(
        "the picture repeats in one direction only, every {:.2f} pixels: stripes, no lattice",
        length(first)));
  Vec2 a = first, b = second;
  if (dot(a, b) < 0) b = -1.0 * b;
  if (length(b - a) < length(b)) b = b - a;  // the shorter of the two that span the lattice
  refine_steps(correlation, a, b);
  if (dot(a, b) < 0) b = -1.0 * b;
  const double angle = angle_between(a, b), ratio = length(b) / length(a);
  LatticeGuess guess;
  guess.contrast = highest;
  guess.hexagonal = std::fabs(angle - 60) < 5 && std::fabs(ratio - 1) < 0.06;
  const bool square = std::fabs(angle - 90) < 4 && ratio < 2 && ratio > 0.5;
  if (!guess.hexagonal && !square)
    throw InputError(
        fmt::format("a lattice is seen that is neither square nor hexagonal: steps of {:.2f} and "
                    "{:.2f} pixels, "
                    "{:.1f} degrees apart",
                    length(a), length(b), angle));
  // All steps to neighbours; the first is the one nearest to +x, the second follows clockwise as
  // one sees it (towards y).
  std::vector<Vec2> steps{a, b, -1.0 * a, -1.0 * b};
  if (guess.hexagonal) {
    steps.push_back(a - b);
    steps.push_back(b - a);
  }
  const auto direction = [](Vec2 v) { return std::atan2(v.y, v.x); };
  guess.step_i = *std::min_element(steps.begin(), steps.end(), [&](Vec2 s, Vec2 t) {
    return std::fabs(direction(s) - 1e-9) < std::fabs(direction(t) - 1e-9);
  });
  const double turn = (guess.hexagonal ? 60 : 90) * std::numbers::pi / 180;
  guess.step_j = *std::min_element(steps.begin(), steps.end(), [&](Vec2 s, Vec2 t) {
    const auto off = [&](Vec2 v) {
      return std::fabs(
          std::remainder(direction(v) - direction(guess.step_i) - turn, 2 * std::numbers::pi));
    };
    return off(s) < off(t);
  });
  find_origin(white, correlation, guess);
  return guess;
}

}  // namespace plenoflame
