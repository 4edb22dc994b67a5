#include "calibration/lattice_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr double kSine60 = 0.86602540378443864676;

Vec2 plane_point(const LatticeModel& model, double i, double j) {
  const double s = 1 / model.scale;
  return model.hexagonal ? Vec2{s * (i + 0.5 * j), s * kSine60 * j} : Vec2{s * i, s * j};
}

struct Numbers {
  Eigen::VectorXd values;  ///< eight of the homography, then k1, k2 where distorted
};

Numbers numbers_of(const LatticeModel& model, bool distorted) {
  Numbers numbers{Eigen::VectorXd(distorted ? 10 : 8)};
  for (int k = 0; k < 8; ++k) numbers.values[k] = model.homography[static_cast<std::size_t>(k)];
  if (distorted) {
    numbers.values[8] = model.k1;
    numbers.values[9] = model.k2;
  }
  return numbers;
}

void set_numbers(LatticeModel& model, const Numbers& numbers) {
  for (int k = 0; k < 8; ++k) model.homography[static_cast<std::size_t>(k)] = numbers.values[k];
  if (numbers.values.size() > 8) {
    model.k1 = numbers.values[8];
    model.k2 = numbers.values[9];
  }
}

/// Rows of the derivatives of x and y.
void add_equations(const LatticeModel& model, const MicroImageFit& image, bool distorted,
                   Eigen::MatrixXd& matrix, Eigen::VectorXd& right) {
  const Vec2 uv = plane_point(model, image.i, image.j);
  const auto& h = model.homography;
  const double below = 1 / (1 + h[6] * uv.x + h[7] * uv.y);
  const Vec2 straight{(h[0] * uv.x + h[1] * uv.y + h[2]) * below,
                      (h[3] * uv.x + h[4] * uv.y + h[5]) * below};
  const Vec2 d = straight - model.middle;
  const double reach2 = model.reach * model.reach;
  const double s2 = dot(d, d) / reach2;
  const double grow = 1 + model.k1 * s2 + model.k2 * s2 * s2;
  const double steeper = 2 * (model.k1 + 2 * model.k2 * s2) / reach2;
  // Derivatives of the distorted point by the straight one.
  const double xx = grow + steeper * d.x * d.x, xy = steeper * d.x * d.y,
               yy = grow + steeper * d.y * d.y;
  Eigen::Matrix<double, 2, 10> slope;
  slope.setZero();
  const double u = uv.x * below, v = uv.y * below;
  const double column_x[8] = {u, v, below, 0, 0, 0, -straight.x * u, -straight.x * v};
  const double column_y[8] = {0, 0, 0, u, v, below, -straight.y * u, -straight.y * v};
  for (int k = 0; k < 8; ++k) {
    slope(0, k) = xx * column_x[k] + xy * column_y[k];
    slope(1, k) = xy * column_x[k] + yy * column_y[k];
  }
  slope(0, 8) = d.x * s2;
  slope(1, 8) = d.y * s2;
  slope(0, 9) = d.x * s2 * s2;
  slope(1, 9) = d.y * s2 * s2;
  const Vec2 off = image.centre - (model.middle + grow * d);
  const int count = distorted ? 10 : 8;
  for (int a = 0; a < count; ++a) {
    right[a] += slope(0, a) * off.x + slope(1, a) * off.y;
    for (int b = 0; b < count; ++b)
      matrix(a, b) += slope(0, a) * slope(0, b) + slope(1, a) * slope(1, b);
  }
}

}  // namespace

Vec2 LatticeModel::point(double i, double j) const {
  const Vec2 uv = plane_point(*this, i, j);
  const auto& h = homography;
  const double below = 1 / (1 + h[6] * uv.x + h[7] * uv.y);
  const Vec2 d =
      Vec2{(h[0] * uv.x + h[1] * uv.y + h[2]) * below, (h[3] * uv.x + h[4] * uv.y + h[5]) * below} -
      middle;
  const double s2 = dot(d, d) / (reach * reach);
  return middle + (1 + k1 * s2 + k2 * s2 * s2) * d;
}

LatticeModel plain_model(const LatticeGuess& guess, int width, int height) {
  LatticeModel model;
  model.hexagonal = guess.hexagonal;
  model.middle = {0.5 * width, 0.5 * height};
  model.reach = 0.5 * std::hypot(width, height);
  model.scale = model.reach / guess.pitch();
  const Vec2 along_u = model.scale * guess.step_i;
  const Vec2 along_v = guess.hexagonal
                           ? (model.scale / kSine60) * (guess.step_j - 0.5 * guess.step_i)
                           : model.scale * guess.step_j;
  model.homography = {along_u.x, along_v.x, guess.origin.x, along_u.y, along_v.y, guess.origin.y,
                      0,         0};
  return model;
}

void fit_lattice_model(std::vector<MicroImageFit>& images, bool distorted, LatticeModel& model) {
  for (int round = 0; round < 6; ++round) {
    const int count = distorted ? 10 : 8;
    for (int step = 0; step < 4; ++step) {
      Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);
      Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
      for (const MicroImageFit& image : images)
        if (image.good) add_equations(model, image, distorted, matrix, right);
      // Few micro-images do not determine a perspective: it stays unchanged.
      for (int a = 0; a < count; ++a) matrix(a, a) *= 1 + 1e-12;
      Numbers numbers = numbers_of(model, distorted);
      const Eigen::VectorXd change = matrix.ldlt().solve(right);
      if (!change.allFinite()) return;
      numbers.values += change;
      set_numbers(model, numbers);
    }
    std::vector<double> off;
    for (const MicroImageFit& image : images)
      if (image.good) off.push_back(length(image.centre - model.point(image.i, image.j)));
    if (off.size() < 12) return;
    std::vector<double> sorted = off;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double limit = 5 * *middle;
    bool changed = false;
    std::size_t k = 0;
    for (MicroImageFit& image : images) {
      if (!image.good) continue;
      if (off[k++] > limit) {
        image.good = false;
        changed = true;
      }
    }
    if (!changed) return;
  }
}

}  // namespace plenoflame
