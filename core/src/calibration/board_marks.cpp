#include "calibration/board_marks.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "math/levenberg_marquardt.h"

namespace plenoflame {
namespace {

/// [pixel] standard deviations of the Gaussian filter before the search for marks. Each dot should
/// become one hill.
constexpr double kSmoothing = 1.0, kDotSmoothing = 2.5;
constexpr int kValues = 7;  ///< x, y, level, step of brightness, two of the shape, blur
using MarkValues = Eigen::Matrix<double, kValues, 1>;
using MarkEquations = NormalEquations<kValues>;

constexpr double kLeastContrast = 0.08;  ///< of a mark's step, in units of the light about it
constexpr double kWorstFit = 0.25;       ///< what a fit may leave, in units of that step
constexpr double kWorstMark = 0.3;       ///< [pixel] deviation of a mark's place
constexpr double kMostMove = 2;          ///< [pixel] of a mark from where it was expected
constexpr double kStartBlur = 1, kMostBlur = 6;  ///< [pixel] radius of a sharp point's image
constexpr double kLeastCell = 0.3;   ///< of the distance of marks, that sees no other one
constexpr int kAperturePoints = 30;  ///< half of their number
constexpr double kWindow = 4.5;      ///< [pixel] about a corner that are fitted
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

/// The share of a square pixel on the bright side of an edge, twice, less one.
struct Step {
  double value, slope;
  /// @param cosine, sine of the direction across the edge
  Step(double distance, double cosine, double sine) {
    const double a = std::max(std::fabs(cosine), std::fabs(sine)),
                 b = std::max(std::min(std::fabs(cosine), std::fabs(sine)), 1e-6);
    const double t = std::fabs(distance), rest = 0.5 * (a + b) - t;
    const bool within = t <= 0.5 * (a - b);
    value = within ? 2 * t / a : rest > 0 ? 1 - rest * rest / (a * b) : 1;
    slope = within ? 2 / a : rest > 0 ? 2 * rest / (a * b) : 0;
    if (distance < 0) value = -value;
  }
};

/// Brightness of the sharp pattern between -1 and 1 at a distance from the mark, and its
/// derivatives by that distance and by the shape.
struct Pattern {
  double value = 0;
  Vec2 slope;
  std::array<double, 2> by_shape{};
};

struct CornerPattern {
  double c0, s0, c1, s1;
  explicit CornerPattern(const MarkValues& p)
      : c0(std::cos(p[4])), s0(std::sin(p[4])), c1(std::cos(p[5])), s1(std::sin(p[5])) {}
  Pattern operator()(Vec2 d) const {
    // Distances from the edges. Both are positive between the two angles.
    const Step u(c0 * d.y - s0 * d.x, c0, s0), v(s1 * d.x - c1 * d.y, c1, s1);
    const double a = u.slope * v.value, b = u.value * v.slope;
    return {u.value * v.value,
            {-a * s0 + b * s1, a * c0 - b * c1},
            {-a * (s0 * d.y + c0 * d.x), b * (c1 * d.x + s1 * d.y)}};
  }
};

struct DotPattern {
  double radius;
  explicit DotPattern(const MarkValues& p) : radius(std::fabs(p[4])) {}
  Pattern operator()(Vec2 d) const {
    const double r = length(d);
    const double n = std::max(r, 1e-12);
    const Step u(radius - r, d.x / n, d.y / n);
    return {u.value, (r > 0 ? -u.slope / r : 0.0) * d, {u.slope, 0}};
  }
};

/// Points of equal area, alike on both sides of the middle: a spiral of equal angles (Vogel 1979,
/// Math. Biosci. 44, 179).
std::vector<Vec2> points_of(const MicrolensAperture& aperture, Vec2 pixel) {
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<Vec2> points;
  for (int k = 0; k < kAperturePoints; ++k) {
    const double r = aperture.radius() * std::sqrt((k + 0.5) / kAperturePoints);
    const Vec2 at{r * std::cos(k * turn), r * std::sin(k * turn)};
    if (!aperture.holds(at)) continue;
    points.push_back({at.x / pixel.x, at.y / pixel.y});
    points.push_back(-1.0 * points.back());
  }
  return points;
}

/// The light of a pixel through a point of the microlens, and its derivative by the pixel's place.
struct Passed {
  double light = 1;
  Vec2 slope;
  Passed(const MicroView& view, Vec2 pixel, Vec2 q) {
    if (view.radius > 0) {
      const Vec2 d = pixel - view.centre - view.stop * q;
      const double r = std::max(std::hypot(d.x, d.y), 1e-12);
      const Step step(view.radius - r, d.x / r, d.y / r);
      light = 0.5 + 0.5 * step.value;
      slope = (-0.5 * step.slope / r) * d;
    }
    // cos^4 of the angle with the axis.
    const Vec2 tangent = (1 / view.distance) * (pixel - view.lens - q);
    light /= std::pow(1 + dot(tangent, tangent), 2);
  }
};

}  // namespace

MarkFinder::MarkFinder(const Image& light, bool dots, const MicrolensAperture& aperture, Vec2 pixel)
    : light_(light),
      dots_(dots),
      aperture_(points_of(aperture, pixel)),
      lens_radius_(aperture.radius() / pixel.x),
      smooth_(smoothed(light, dots ? kDotSmoothing : kSmoothing)),
      strength_(light.width, light.height) {
  for (int y = 1; y < light.height - 1; ++y)
    for (int x = 1; x < light.width - 1; ++x) {
      const double saddle = Curvature(smooth_, x, y).saddle();
      strength_.at(x, y) = static_cast<float>(dots_ ? -saddle : saddle);
    }
}

/// Pixels about a mark.
struct MarkFinder::Patch {
  std::vector<Vec2> places;    ///< [pixel] from the mark
  std::vector<double> light;   ///< over its mean
  std::vector<double> weight;  ///< share of the microlens that they see through
  std::vector<float> shares;   ///< of each point of the microlens, for each pixel; their sum is 1
};

struct MarkFinder::Fit {
  MarkValues values = MarkValues::Zero();
  MarkEquations equations;
  double rms = 0, variance = 0, place_error = 0, step = 0;
};

/// @param takes (place from `about`) -> whether a pixel is used
template <class Takes>
MarkFinder::Patch MarkFinder::patch(Vec2 about, double reach, const MicroView& view,
                                    const Takes& takes) const {
  Patch patch;
  double mean = 0;
  const auto x0 = static_cast<int>(std::floor(about.x - reach)),
             y0 = static_cast<int>(std::floor(about.y - reach));
  const int side = static_cast<int>(2 * reach) + 2;
  for (int y = std::max(y0, 0); y < std::min(y0 + side, light_.height); ++y)
    for (int x = std::max(x0, 0); x < std::min(x0 + side, light_.width); ++x) {
      const Vec2 p{x + 0.5, y + 0.5}, from_centre = p - view.centre;
      const auto value = static_cast<double>(light_.at(x, y));
      if (length(from_centre) > view.visible || !std::isfinite(value) || !takes(p - about))
        continue;
      const std::size_t first = patch.shares.size();
      double sum = 0;
      Vec2 slope;
      for (const Vec2 q : aperture_) {
        const Passed passed(view, p, q);
        sum += passed.light;
        slope = slope + passed.slope;
        patch.shares.push_back(static_cast<float>(passed.light));
      }
      if (!(sum > 0)) {
        patch.shares.resize(first);
        continue;
      }
      for (std::size_t k = first; k < patch.shares.size(); ++k)
        patch.shares[k] /= static_cast<float>(sum);
      // The middle of a pixel's light, at the edge of the stop's image.
      constexpr double kPixel = 1.0 / 12;  // second moment of a pixel
      patch.places.push_back(p - about + (kPixel / sum) * slope);
      patch.light.push_back(value);
      patch.weight.push_back(sum / static_cast<double>(aperture_.size()));
      mean += value;
    }
  mean /= static_cast<double>(std::max<std::size_t>(patch.light.size(), 1));
  if (!(mean > 0)) return {};
  for (double& value : patch.light) value /= mean;
  return patch;
}

/// Least squares from fit.values on. @return false: no end was found
bool MarkFinder::solve(const Patch& patch, bool free_blur, Fit& fit) const {
  const std::size_t n = patch.places.size(), points = aperture_.size();
  if (n < static_cast<std::size_t>(kValues) + 4) return false;
  // The mean pattern at each pixel, and its derivatives by place, shape and blur.
  const auto means_of = [&](const MarkValues& p, const auto& use) {
    const auto with = [&](const auto& pattern) {
      for (std::size_t i = 0; i < n; ++i) {
        double value = 0;
        MarkValues slope = MarkValues::Zero();
        for (std::size_t k = 0; k < points; ++k) {
          const auto share = static_cast<double>(patch.shares[i * points + k]);
          if (share == 0) continue;
          const Vec2 q = aperture_[k];
          const Pattern at = pattern(patch.places[i] - Vec2{p[0], p[1]} - p[6] * q);
          value += share * at.value;
          slope[0] -= share * at.slope.x;
          slope[1] -= share * at.slope.y;
          slope[4] += share * at.by_shape[0];
          slope[5] += share * at.by_shape[1];
          slope[6] -= share * dot(at.slope, q);
        }
        use(i, value, slope);
      }
    };
    if (dots_)
      with(DotPattern(p));
    else
      with(CornerPattern(p));
  };
  // Level and step of the start.
  double w = 0, wv = 0, wvv = 0, wl = 0, wvl = 0;
  means_of(fit.values, [&](std::size_t i, double value, const MarkValues&) {
    const double weight = patch.weight[i], light = patch.light[i];
    w += weight;
    wv += weight * value;
    wvv += weight * value * value;
    wl += weight * light;
    wvl += weight * value * light;
  });
  const double spread = w * wvv - wv * wv;
  if (!(spread > 1e-6 * w * w)) return false;
  fit.values[3] = (w * wvl - wv * wl) / spread;
  fit.values[2] = (wl - fit.values[3] * wv) / w;
  const auto evaluate = [&](const MarkValues& p) -> std::optional<MarkEquations> {
    MarkEquations equations;
    equations.square.setZero();
    equations.right.setZero();
    means_of(p, [&](std::size_t i, double value, MarkValues& slope) {
      slope *= p[3];
      slope[2] = 1;
      slope[3] = value;
      const double off = patch.light[i] - p[2] - p[3] * value, weight = patch.weight[i];
      equations.square += weight * slope * slope.transpose();
      equations.right += weight * off * slope;
      equations.sum += weight * off * off;
    });
    return equations;
  };
  const auto held = [&](MarkEquations& equations) {
    for (const int k : {5, 6}) {
      if (k == 5 ? !dots_ : free_blur) continue;
      equations.square.row(k).setZero();
      equations.square.col(k).setZero();
      equations.square(k, k) = 1;
      equations.right[k] = 0;
    }
  };
  const double most_blur = kMostBlur / lens_radius_;
  MarkEquations here;
  minimise(
      fit.values, here,
      [&](const MarkValues& p) {
        std::optional<MarkEquations> equations = evaluate(p);
        held(*equations);
        return equations;
      },
      [&](const MarkValues& p, const MarkValues& change) {
        MarkValues next = p + change;
        next[6] = std::clamp(next[6], -most_blur, most_blur);
        return next;
      },
      {kFitSteps, 1e-3, 1e4, 1e-6});
  fit.equations = *evaluate(fit.values);
  const Eigen::Matrix<double, kValues, kValues> inverse =
      here.square.ldlt().solve(Eigen::Matrix<double, kValues, kValues>::Identity());
  fit.step = std::fabs(fit.values[3]);
  double weights = 0;
  for (const double weight : patch.weight) weights += weight;
  const double freedom = static_cast<double>(n) - kValues;
  fit.variance = here.sum / freedom;
  fit.rms = std::sqrt(here.sum / weights);
  fit.place_error = std::sqrt(std::max(0.0, 0.5 * fit.variance * (inverse(0, 0) + inverse(1, 1))));
  return std::isfinite(fit.place_error) && fit.place_error > 0;
}

bool MarkFinder::accept(const Fit& fit, const MicroView& view, BoardMark& mark) const {
  const Vec2 move{fit.values[0], fit.values[1]};
  if (!(length(move) < kMostMove) || fit.step < kLeastContrast || fit.step > 3 ||
      fit.rms > kWorstFit * fit.step || fit.place_error > kWorstMark)
    return false;
  mark.pixel = mark.pixel + move;
  if (length(mark.pixel - view.centre) > view.visible - 1) return false;
  mark.error = fit.place_error;
  mark.shape = {fit.values[4], fit.values[5]};
  if (dots_) {
    mark.diagonal = {fit.values[3] > 0 ? 1.0 : -1.0, 0};
    return std::fabs(mark.shape[0]) > 0.5;
  }
  if (std::fabs(std::sin(mark.shape[0] - mark.shape[1])) < 0.4) return false;
  const double bright =
      0.5 * (mark.shape[0] + mark.shape[1]) + (fit.values[3] > 0 ? 0 : 0.5 * std::numbers::pi);
  mark.diagonal = {std::cos(2 * bright), std::sin(2 * bright)};
  return true;
}

bool MarkFinder::fit_corner(const MicroView& view, BoardMark& mark) const {
  const double turn = 0.5 * std::atan2(mark.diagonal.y, mark.diagonal.x);
  Fit fit;
  // The edges lie half a right angle to both sides of the bright diagonal.
  fit.values << 0, 0, 0, 0, turn - 0.25 * std::numbers::pi, turn + 0.25 * std::numbers::pi,
      kStartBlur / lens_radius_;
  MicroView whole = view;
  whole.radius = 0;
  return solve(patch(mark.pixel, kWindow, whole, [](Vec2 d) { return length(d) < kWindow; }), true,
               fit) &&
         accept(fit, view, mark);
}

bool MarkFinder::fit_dot(const MicroView& view, double size, BoardMark& mark) const {
  Fit fit;
  fit.values << 0, 0, 0, 0, size, 0, kStartBlur / lens_radius_;
  MicroView whole = view;
  whole.radius = 0;
  const double reach = 1.7 * size + 2;
  return solve(patch(mark.pixel, reach, whole, [&](Vec2 d) { return length(d) < reach; }), true,
               fit) &&
         accept(fit, view, mark) &&
         // Most of the dot lies in the micro-image, or its middle is a guess.
         length(mark.pixel - view.centre) + 0.3 * std::fabs(mark.shape[0]) < view.visible;
}

bool MarkFinder::fit_expected(const MicroView& view, const Grid& grid, BoardMark& mark,
                              BlurInformation& blur) const {
  const double area = std::fabs(grid.column.x * grid.row.y - grid.column.y * grid.row.x);
  const double soft = std::fabs(view.plane) * lens_radius_ + 1;
  // Pixels that see the next mark are left out.
  const double columns = 1 - soft * length(grid.row) / area,
               rows = 1 - soft * length(grid.column) / area;
  if (!(columns > kLeastCell && rows > kLeastCell)) return false;
  Fit fit;
  fit.values << 0, 0, 0, 0, mark.shape[0], mark.shape[1], view.plane;
  const auto takes = [&](Vec2 d) {
    if (dots_)
      return length(d) < std::min(length(grid.column), length(grid.row)) - soft - mark.shape[0];
    return std::fabs(d.x * grid.row.y - d.y * grid.row.x) < columns * area &&
           std::fabs(d.x * grid.column.y - d.y * grid.column.x) < rows * area;
  };
  const double reach = length(view.centre - mark.pixel) + view.visible;
  if (!solve(patch(mark.pixel, reach, view, takes), false, fit) || !accept(fit, view, mark))
    return false;
  // The curvature over the blur while all other values follow.
  const Eigen::Matrix<double, 6, 6> others =
      fit.equations.square.topLeftCorner<6, 6>() + 1e-9 * Eigen::Matrix<double, 6, 6>::Identity();
  const Eigen::Matrix<double, 6, 1> mixed = fit.equations.square.topRightCorner<6, 1>();
  blur.gradient = fit.equations.right[6] / fit.variance;
  blur.curvature =
      (fit.equations.square(6, 6) - mixed.dot(others.ldlt().solve(mixed))) / fit.variance;
  if (blur.curvature > 0 && std::isfinite(blur.curvature)) {
    mark.blur = view.plane + blur.gradient / blur.curvature;
    mark.blur_error = 1 / std::sqrt(blur.curvature);
  }
  return true;
}

double MarkFinder::white(const MicroView& view, Vec2 pixel) const {
  double sum = 0;
  for (const Vec2 q : aperture_) sum += Passed(view, pixel, q).light;
  return sum / static_cast<double>(aperture_.size());
}

std::vector<BoardMark> MarkFinder::marks_in(const MicroView& view) const {
  std::vector<BoardMark> marks;
  const Vec2 centre = view.centre;
  const double inner = view.visible - 1;
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
          if (!fit_dot(view, size, tried)) continue;
          fits = true;
          mark = tried;
          break;
        }
      } else {
        fits = fit_corner(view, mark);
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
