#include "calibration/board_marks.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace plenoflame {
namespace {

/// [pixel] standard deviations of the Gaussian filter before the search for marks. Each dot should
/// become one hill.
constexpr double kSmoothing = 1.0, kDotSmoothing = 2.5;
constexpr double kRim = 1.5;             ///< [pixel] at the edge of a micro-image that say nothing
constexpr double kLeastContrast = 0.08;  ///< of a mark's step, in units of the light about it
constexpr double kWorstFit = 0.25;       ///< what a fit may leave, in units of that step
constexpr double kWorstDot = 0.15;       ///< [pixel] deviation of a dot's place
constexpr double kWindow = 4.5;          ///< [pixel] about a corner that are fitted
constexpr int kFitSteps = 15;

Image smoothed(const Image& light, double deviation) {
  const int reach = static_cast<int>(std::ceil(3 * deviation));
  std::vector<float> weight;
  for (int k = -reach; k <= reach; ++k)
    weight.push_back(static_cast<float>(std::exp(-0.5 * k * k / (deviation * deviation))));
  // Pixels that say nothing take no part: sums of light and of weights.
  Image along(light.width, light.height), seen(light.width, light.height);
  for (int y = 0; y < light.height; ++y)
    for (int x = reach; x < light.width - reach; ++x)
      for (int k = -reach; k <= reach; ++k) {
        const float value = light.at(x + k, y), w = weight[static_cast<std::size_t>(k + reach)];
        if (!std::isfinite(value)) continue;
        along.at(x, y) += w * value;
        seen.at(x, y) += w;
      }
  Image both(light.width, light.height);
  std::vector<float> sum(static_cast<std::size_t>(light.width));
  for (int y = reach; y < light.height - reach; ++y) {
    std::fill(sum.begin(), sum.end(), 0.0F);
    for (int k = -reach; k <= reach; ++k) {
      const float w = weight[static_cast<std::size_t>(k + reach)];
      for (int x = 0; x < light.width; ++x) {
        both.at(x, y) += w * along.at(x, y + k);
        sum[static_cast<std::size_t>(x)] += w * seen.at(x, y + k);
      }
    }
    for (int x = 0; x < light.width; ++x)
      both.at(x, y) = sum[static_cast<std::size_t>(x)] > 0
                          ? both.at(x, y) / sum[static_cast<std::size_t>(x)]
                          : 0.0F;
  }
  return both;
}

/// Derivatives of the smoothed picture at a pixel.
struct Curvature {
  double xx, xy, yy;
  Curvature(const Image& s, int x, int y) {
    const auto at = [&](int dx, int dy) { return static_cast<double>(s.at(x + dx, y + dy)); };
    xx = at(1, 0) - 2 * at(0, 0) + at(-1, 0);
    yy = at(0, 1) - 2 * at(0, 0) + at(0, -1);
    xy = 0.25 * (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1));
  }
  /// Large where the picture is a saddle.
  double saddle() const { return xy * xy - xx * yy; }
};

/// Least squares of a mark's model with slopes by differences. Values: 0, 1 the place, 2 the step
/// of brightness, 3 the level; others belong to the model.
template <int kCount>
struct MarkFit {
  using Vector = Eigen::Matrix<double, kCount, 1>;
  Vector values;
  double rms = 0, place_error = 0;

  /// @param model (values, x, y) -> light @return false: no end was found
  template <class Model>
  bool solve(const std::vector<Vec2>& places, const std::vector<double>& light,
             const Model& model) {
    const auto n = static_cast<Eigen::Index>(places.size());
    if (n < kCount + 6) return false;
    Eigen::Matrix<double, Eigen::Dynamic, kCount> rows(n, kCount);
    Eigen::VectorXd rest(n);
    const auto residuals = [&](const Vector& p, Eigen::VectorXd& r) {
      for (Eigen::Index i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        r(i) = light[k] - model(p, places[k]);
      }
      return r.squaredNorm();
    };
    double sum = residuals(values, rest), damping = 1e-3;
    Eigen::Matrix<double, kCount, kCount> square;
    for (int step = 0; step < kFitSteps; ++step) {
      constexpr double kStep = 1e-4;
      Eigen::VectorXd moved(n);
      for (int c = 0; c < kCount; ++c) {
        Vector p = values;
        const double h = kStep * std::max(1.0, std::fabs(p(c)));
        p(c) += h;
        residuals(p, moved);
        rows.col(c) = (rest - moved) / h;
      }
      square = rows.transpose() * rows;
      auto damped = square;
      damped.diagonal() *= 1 + damping;
      const Vector change = damped.ldlt().solve(rows.transpose() * rest);
      if (!change.allFinite()) return false;
      const Vector next = values + change;
      const double next_sum = residuals(next, moved);
      if (!(next_sum <= sum)) {
        damping *= 10;
        if (damping > 1e6) break;
        continue;
      }
      const double move = std::hypot(change(0), change(1));
      values = next;
      sum = next_sum;
      rest = moved;
      damping *= 0.1;
      if (move < 1e-4) break;
    }
    rms = std::sqrt(sum / static_cast<double>(n - kCount));
    const auto inverse =
        square.ldlt().solve(Eigen::Matrix<double, kCount, kCount>::Identity().eval());
    place_error = rms * std::sqrt(std::max(0.0, 0.5 * (inverse(0, 0) + inverse(1, 1))));
    return std::isfinite(place_error);
  }
};

double soft_edge(double distance, double width) {
  return std::erf(distance / (std::numbers::sqrt2 * width));
}

double bounded_width(double width) {
  return std::clamp(std::fabs(width), 0.3, 4.0);
}

}  // namespace

MarkFinder::MarkFinder(const Image& light, bool dots)
    : light_(light),
      dots_(dots),
      smooth_(smoothed(light, dots ? kDotSmoothing : kSmoothing)),
      strength_(light.width, light.height) {
  for (int y = 1; y < light.height - 1; ++y)
    for (int x = 1; x < light.width - 1; ++x) {
      const double saddle = Curvature(smooth_, x, y).saddle();
      strength_.at(x, y) = static_cast<float>(dots_ ? -saddle : saddle);
    }
}

/// Pixels within `reach` of a place, and well within the micro-image.
MarkFinder::Patch MarkFinder::patch(Vec2 about, double reach, Vec2 centre, double radius) const {
  Patch patch;
  double mean = 0;
  const auto x0 = static_cast<int>(std::floor(about.x - reach)),
             y0 = static_cast<int>(std::floor(about.y - reach));
  const int side = static_cast<int>(2 * reach) + 2;
  for (int y = std::max(y0, 0); y < std::min(y0 + side, light_.height); ++y)
    for (int x = std::max(x0, 0); x < std::min(x0 + side, light_.width); ++x) {
      const Vec2 p{x + 0.5, y + 0.5};
      const auto value = static_cast<double>(light_.at(x, y));
      if (length(p - about) > reach || length(p - centre) > radius - kRim || !std::isfinite(value))
        continue;
      patch.places.push_back(p - about);
      patch.light.push_back(value);
      mean += value;
    }
  mean /= static_cast<double>(std::max<std::size_t>(patch.light.size(), 1));
  if (!(mean > 0)) return {};
  for (double& value : patch.light) value /= mean;
  return patch;
}

/// Two edges that cross, each a blurred step: level + step f(u) f(v).
bool MarkFinder::fit_corner(Vec2 centre, double radius, BoardMark& mark) const {
  const auto [places, light] = patch(mark.pixel, kWindow, centre, radius);
  const double turn = 0.5 * std::atan2(mark.diagonal.y, mark.diagonal.x);
  // The edges lie half a right angle to both sides of the bright diagonal.
  MarkFit<9> fit;
  fit.values << 0, 0, 0.5, 1, turn - 0.25 * std::numbers::pi, turn + 0.25 * std::numbers::pi, 1, 0,
      0;
  const auto model = [](const MarkFit<9>::Vector& p, Vec2 at) {
    const double x = at.x - p(0), y = at.y - p(1), width = bounded_width(p(6));
    // Distances from the edges, which run along the angles p(4) and p(5).
    const double u = std::cos(p(4)) * y - std::sin(p(4)) * x;
    const double v = std::sin(p(5)) * x - std::cos(p(5)) * y;
    return p(3) + p(7) * x + p(8) * y + p(2) * soft_edge(u, width) * soft_edge(v, width);
  };
  if (!fit.solve(places, light, model)) return false;
  const Vec2 move{fit.values(0), fit.values(1)};
  const double step = std::fabs(fit.values(2));
  const double crossing = std::fabs(std::sin(fit.values(4) - fit.values(5)));
  if (!(length(move) < 2) || step < kLeastContrast || step > 3 || fit.rms > kWorstFit * step ||
      crossing < 0.4)
    return false;
  mark.pixel = mark.pixel + move;
  if (length(mark.pixel - centre) > radius - kRim - 1) return false;
  // u and v are positive between the two angles.
  const double bright =
      0.5 * (fit.values(4) + fit.values(5)) + (fit.values(2) > 0 ? 0 : 0.5 * std::numbers::pi);
  mark.diagonal = {std::cos(2 * bright), std::sin(2 * bright)};
  mark.error = fit.place_error;
  return true;
}

/// A disc with a soft edge: level + step f(radius - distance).
bool MarkFinder::fit_dot(Vec2 centre, double radius, double size, BoardMark& mark) const {
  const auto [places, light] = patch(mark.pixel, std::min(1.7 * size + 2, radius), centre, radius);
  const Curvature c(smooth_, static_cast<int>(mark.pixel.x), static_cast<int>(mark.pixel.y));
  MarkFit<8> fit;
  fit.values << 0, 0, c.xx + c.yy > 0 ? -0.4 : 0.4, 1, size, 1, 0, 0;
  const auto model = [](const MarkFit<8>::Vector& p, Vec2 at) {
    const double x = at.x - p(0), y = at.y - p(1);
    return p(3) + p(6) * x + p(7) * y +
           p(2) * soft_edge(std::fabs(p(4)) - std::hypot(x, y), bounded_width(p(5)));
  };
  if (!fit.solve(places, light, model)) return false;
  const Vec2 move{fit.values(0), fit.values(1)};
  const double step = std::fabs(fit.values(2)), found = std::fabs(fit.values(4));
  if (!(length(move) < 2) || step < kLeastContrast || step > 3 || fit.rms > kWorstFit * step ||
      !(found > 0.5))
    return false;
  mark.pixel = mark.pixel + move;
  // Most of the dot lies in the micro-image, or its middle is a guess.
  if (length(mark.pixel - centre) + 0.3 * found > radius - kRim || fit.place_error > kWorstDot)
    return false;
  mark.diagonal = {fit.values(2) > 0 ? 1.0 : -1.0, 0};
  mark.error = fit.place_error;
  return true;
}

std::vector<BoardMark> MarkFinder::marks_in(Vec2 centre, double radius) const {
  std::vector<BoardMark> marks;
  const double inner = radius - kRim - 1;
  if (!(inner > 2)) return marks;
  const int x0 = std::max(3, static_cast<int>(centre.x - inner)),
            x1 = std::min(light_.width - 4, static_cast<int>(centre.x + inner)),
            y0 = std::max(3, static_cast<int>(centre.y - inner)),
            y1 = std::min(light_.height - 4, static_cast<int>(centre.y + inner));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const Vec2 place{x + 0.5, y + 0.5};
      if (length(place - centre) > inner) continue;
      const double here = static_cast<double>(strength_.at(x, y)),
                   level = static_cast<double>(smooth_.at(x, y));
      // A step s that is blurred by about a pixel has second derivatives of some s / 4, the middle
      // of a dot some s / 25.
      const double least = (dots_ ? 0.008 : 0.02) * std::max(level, 0.0);
      if (!(here > least * least)) continue;
      bool highest = true;
      for (int dy = -2; dy <= 2 && highest; ++dy)
        for (int dx = -2; dx <= 2 && highest; ++dx)
          if (dx != 0 || dy != 0)
            highest = strength_.at(x + dx, y + dy) < strength_.at(x, y) ||
                      (dy * 5 + dx > 0 && strength_.at(x + dx, y + dy) <= strength_.at(x, y));
      if (!highest) continue;
      const Curvature c(smooth_, x, y);
      BoardMark mark;
      mark.pixel = place;
      // The bright diagonal is that along which the picture curves upwards.
      const double scale = std::hypot(c.xx - c.yy, 2 * c.xy);
      if (scale > 0) mark.diagonal = {(c.xx - c.yy) / scale, 2 * c.xy / scale};
      bool fits = false;
      if (dots_) {
        for (const double size : {2.0, 3.5, 5.5}) {
          BoardMark tried = mark;
          if (!fit_dot(centre, radius, size, tried)) continue;
          fits = true;
          mark = tried;
          break;
        }
      } else {
        fits = fit_corner(centre, radius, mark);
      }
      if (!fits) continue;
      // Two starts may end at one place.
      const bool known = std::any_of(marks.begin(), marks.end(), [&](const BoardMark& other) {
        return length(other.pixel - mark.pixel) < 1;
      });
      if (!known) marks.push_back(mark);
    }
  return marks;
}

}  // namespace plenoflame
