#include "calibration/micro_image_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "math/levenberg_marquardt.h"

namespace plenoflame {
namespace {

constexpr int kParameters = 8;  ///< centre x, y, radius, blur, light, slope x, y, background
using Vector = Eigen::Matrix<double, kParameters, 1>;
using DiscEquations = NormalEquations<kParameters>;

/// A pixel is as wide as the edge of a sharper disc would seem.
constexpr double kLeastBlur = 0.6;

struct CellPixel {
  double x = 0, y = 0, value = 0;
};

/// Adds the disc of parameters p, moved by `step`, at a pixel. The edge of a large disc is blurred
/// by a small one of radius b. The value is the share of a disc on one side of a chord. With the
/// chord at t b from the middle it is 1/2 + (t sqrt(1 - t^2) + asin t) / pi.
double add_disc(const Vector& p, Vec2 step, const CellPixel& pixel, Vector& slope) {
  const double x = pixel.x - p[0], y = pixel.y - p[1];
  const double dx = x - step.x, dy = y - step.y;
  const double outer = p[2] + p[3], r2 = dx * dx + dy * dy;
  if (r2 >= outer * outer) return 0;
  const double r = std::sqrt(r2);
  const double t = (p[2] - r) / p[3];
  const double light = p[4] + p[5] * x + p[6] * y;
  double share = 1;
  if (t < 1) {
    const double root = std::sqrt(std::max(0.0, 1 - t * t));
    share = 0.5 + (t * root + std::asin(std::max(t, -1.0))) / std::numbers::pi;
    const double steep = light * 2 * root / std::numbers::pi / p[3];
    if (r > 0) {
      slope[0] += steep * dx / r;
      slope[1] += steep * dy / r;
    }
    slope[2] += steep;
    slope[3] -= steep * t;
  }
  slope[0] -= p[5] * share;
  slope[1] -= p[6] * share;
  slope[4] += share;
  slope[5] += x * share;
  slope[6] += y * share;
  return light * share;
}

/// The pixel's own disc and those of its neighbours, which are taken to look alike: where discs
/// overlap a pixel gets the light of both.
double disc_model(const Vector& p, const std::vector<Vec2>& steps, const CellPixel& pixel,
                  Vector& slope) {
  slope.setZero();
  slope[7] = 1;
  double value = p[7] + add_disc(p, {}, pixel, slope);
  for (const Vec2 step : steps) value += add_disc(p, step, pixel, slope);
  return value;
}

DiscEquations normal_equations(const std::vector<CellPixel>& pixels, const std::vector<Vec2>& steps,
                               const Vector& p) {
  DiscEquations equations;
  Vector slope;
  // Whole rows of a local array: the compiler adds several columns at once.
  double rows[kParameters][kParameters] = {}, right[kParameters] = {};
  for (const CellPixel& pixel : pixels) {
    const double off = pixel.value - disc_model(p, steps, pixel, slope);
    equations.sum += off * off;
    double s[kParameters];
    for (int a = 0; a < kParameters; ++a) s[a] = slope[a];
    for (int a = 0; a < kParameters; ++a) {
      if (s[a] == 0) continue;
      right[a] += off * s[a];
      for (int b = 0; b < kParameters; ++b) rows[a][b] += s[a] * s[b];
    }
  }
  for (int a = 0; a < kParameters; ++a) {
    equations.right[a] = right[a];
    for (int b = 0; b < kParameters; ++b) equations.square(a, b) = rows[a][b];
  }
  return equations;
}

/// Radius of the uniform disc with the second moment of the light, without the pixels' own moment.
/// The background is the picture's. A disc that is blurred by half of its radius differs from the
/// model, so the fitted background would be wrong.
double even_radius(const std::vector<CellPixel>& pixels, double background) {
  double light = 0, x = 0, y = 0, square = 0;
  for (const CellPixel& pixel : pixels) {
    const double value = pixel.value - background;
    light += value;
    x += value * pixel.x;
    y += value * pixel.y;
    square += value * (pixel.x * pixel.x + pixel.y * pixel.y);
  }
  constexpr double kPixel = 1.0 / 6;  // the second moment of a pixel
  const double moment = (square - (x * x + y * y) / light) / light - kPixel;
  return std::sqrt(std::max(0.0, 2 * moment));
}

}  // namespace

LatticeCell::LatticeCell(const LatticeGuess& guess, const Image& white)
    : neighbours{guess.step_i, guess.step_j} {
  if (guess.hexagonal) neighbours.push_back(guess.step_j - guess.step_i);
  reach = guess.hexagonal ? guess.pitch() / std::sqrt(3.0)
                          : 0.5 * std::hypot(length(guess.step_i), length(guess.step_j));
  // Between round micro-images that touch lie 9 % of the pixels.
  constexpr double kDark = 0.02;
  std::vector<float> values(white.pixels.begin(), white.pixels.end());
  const auto dark =
      values.begin() + static_cast<std::ptrdiff_t>(kDark * static_cast<double>(values.size()));
  std::nth_element(values.begin(), dark, values.end());
  background = static_cast<double>(*dark);
}

bool LatticeCell::holds(Vec2 d) const {
  return std::all_of(neighbours.begin(), neighbours.end(),
                     [&](Vec2 n) { return std::fabs(dot(d, n)) <= 0.5 * dot(n, n); });
}

MicroImageFit fit_micro_image(const Image& white, const LatticeCell& cell,
                              const MicroImageFit& start) {
  MicroImageFit fit = start;
  fit.good = false;
  const int x0 = static_cast<int>(std::floor(start.centre.x - cell.reach)),
            x1 = static_cast<int>(std::ceil(start.centre.x + cell.reach)),
            y0 = static_cast<int>(std::floor(start.centre.y - cell.reach)),
            y1 = static_cast<int>(std::ceil(start.centre.y + cell.reach));
  std::vector<CellPixel> pixels;
  pixels.reserve(static_cast<std::size_t>((x1 - x0) * (y1 - y0)));
  double brightest = 0, darkest = std::numeric_limits<double>::infinity();
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const Vec2 d{x + 0.5 - start.centre.x, y + 0.5 - start.centre.y};
      if (!cell.holds(d)) continue;
      if (x < 0 || y < 0 || x >= white.width || y >= white.height) return fit;  // not all of it
      // From the start on: small numbers keep their digits.
      pixels.push_back({d.x, d.y, static_cast<double>(white.at(x, y))});
      brightest = std::max(brightest, pixels.back().value);
      darkest = std::min(darkest, pixels.back().value);
    }
  if (pixels.size() < 12 || !(brightest > 0)) return fit;
  Vector p;
  double middle = 0;
  int inner = 0;
  for (const CellPixel& pixel : pixels)
    if (pixel.x * pixel.x + pixel.y * pixel.y < 0.25 * start.radius * start.radius + 1) {
      middle += pixel.value;
      ++inner;
    }
  middle /= std::max(inner, 1);
  if (!(middle > 0)) return fit;
  p << 0, 0, start.radius, std::max(start.blur, kLeastBlur), middle, 0, 0, 0;
  const double largest_radius = 1.2 * cell.reach;
  std::vector<Vec2> steps;
  for (const Vec2 n : cell.neighbours) {
    steps.push_back(n);
    steps.push_back(-1.0 * n);
  }
  // If micro-images touch, few pixels determine the background: it is pulled to 0.
  const double pull = 0.01 * static_cast<double>(pixels.size());
  const auto misfit = [&](const Vector& at) -> std::optional<DiscEquations> {
    DiscEquations equations = normal_equations(pixels, steps, at);
    equations.square(7, 7) += pull;
    equations.right[7] -= pull * at[7];
    equations.sum += pull * at[7] * at[7];
    return equations;
  };
  const auto moved = [&](const Vector& at, const Vector& change) {
    Vector next = at + change;
    next[2] = std::clamp(next[2], 1.0, largest_radius);
    next[3] = std::clamp(next[3], kLeastBlur, std::max(kLeastBlur, 0.95 * next[2]));
    return next;
  };
  DiscEquations found;
  minimise(p, found, misfit, moved, {12, 1e-4, 1e4, 1e-5});
  const double sum = found.sum - pull * p[7] * p[7];
  fit.centre = start.centre + Vec2{p[0], p[1]};
  fit.radius = p[2];
  fit.blur = p[3];
  fit.even_radius = even_radius(pixels, cell.background);
  fit.light = p[4];
  fit.rms = std::sqrt(sum / static_cast<double>(pixels.size())) / std::max(p[4], 1e-300);
  // A blob that ran out of its cell, has little contrast, or does not look like a disc is no
  // micro-image.
  fit.good = std::hypot(p[0], p[1]) < 0.4 * cell.reach && p[4] > 0 &&
             brightest - darkest > 0.2 * p[4] && fit.rms < 0.25 && std::isfinite(sum);
  return fit;
}

}  // namespace plenoflame
