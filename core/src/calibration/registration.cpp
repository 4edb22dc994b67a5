#include "plenoflame/calibration/registration.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr int kMostSteps = 30;
constexpr double kLastStep = 1e-6;  ///< [pixel]
constexpr double kMostShift = 5;    ///< [pixel] beyond which nothing is said
constexpr double kLitShare = 1e-3;  ///< of the brightest micro-image's mean square
constexpr std::size_t kLeastPixels = 12;

/// Keys' cubic between four neighbours, its value and derivative as weights.
void cubic_weights(double t, double (&w)[4], double (&d)[4]) {
  w[0] = t * (-0.5 + t * (1 - 0.5 * t));
  w[1] = 1 + t * t * (-2.5 + 1.5 * t);
  w[2] = t * (0.5 + t * (2 - 1.5 * t));
  w[3] = t * t * (-0.5 + 0.5 * t);
  d[0] = -0.5 + t * (2 - 1.5 * t);
  d[1] = t * (-5 + 4.5 * t);
  d[2] = 0.5 + t * (4 - 4.5 * t);
  d[3] = t * (-1 + 1.5 * t);
}

/// A picture moved by one shift.
class ShiftedPicture {
 public:
  ShiftedPicture(const Image& image, Vec2 shift) : image_(image) {
    // The point x - shift of pixel x: whole pixels, and what is left of one.
    const double fx = std::floor(-shift.x), fy = std::floor(-shift.y);
    column_ = static_cast<int>(fx);
    row_ = static_cast<int>(fy);
    cubic_weights(-shift.x - fx, wx_, dx_);
    cubic_weights(-shift.y - fy, wy_, dy_);
  }
  /// False at the edges, beyond which nothing is known.
  bool knows(int column, int row) const {
    return column + column_ >= 1 && row + row_ >= 1 && column + column_ + 2 < image_.width &&
           row + row_ + 2 < image_.height;
  }
  struct Value {
    double value = 0, by_x = 0, by_y = 0;
  };
  Value at(int column, int row) const {
    Value v;
    for (int j = 0; j < 4; ++j) {
      const int y = std::clamp(row + row_ - 1 + j, 0, image_.height - 1);
      double along = 0, slope = 0;
      for (int i = 0; i < 4; ++i) {
        const int x = std::clamp(column + column_ - 1 + i, 0, image_.width - 1);
        const auto light = static_cast<double>(image_.at(x, y));
        along += wx_[i] * light;
        slope += dx_[i] * light;
      }
      v.value += wy_[j] * along;
      v.by_x += wy_[j] * slope;
      v.by_y += dy_[j] * along;
    }
    return v;
  }

 private:
  const Image& image_;
  int column_ = 0, row_ = 0;
  double wx_[4], wy_[4], dx_[4], dy_[4];
};

struct PixelRun {
  int row, begin, end;
};

/// Gain and shift by Gauss-Newton steps.
PictureFit fit_runs(const Image& measured, const Image& simulated,
                    const std::vector<PixelRun>& runs) {
  PictureFit fit;
  fit.shift_error = {kInfinity, kInfinity};
  fit.gain_error = kInfinity;
  Eigen::Matrix3d square;
  double light = 0, rest = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    const ShiftedPicture picture(simulated, fit.shift);
    // The unknowns are the gain, and the gain times the shift.
    square.setZero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double all = 0;
    light = 0;
    fit.pixels = 0;
    for (const PixelRun& run : runs)
      for (int x = run.begin; x < run.end; ++x) {
        const auto m = static_cast<double>(measured.at(x, run.row));
        if (!std::isfinite(m) || !picture.knows(x, run.row)) continue;
        const ShiftedPicture::Value s = picture.at(x, run.row);
        const Eigen::Vector3d row(s.value, -s.by_x, -s.by_y);
        square += row * row.transpose();
        right += m * row;
        all += m * m;
        light += s.value * s.value;
        ++fit.pixels;
      }
    const Eigen::FullPivLU<Eigen::Matrix3d> solver(square);
    if (fit.pixels < kLeastPixels || !(square(0, 0) > 0)) return {};
    if (!solver.isInvertible()) {  // nothing in the picture moves: the gain alone
      fit.gain = right(0) / square(0, 0);
      fit.shift = {};
      rest = std::max(0.0, all - fit.gain * right(0));
      fit.gain_error = std::sqrt(rest / static_cast<double>(fit.pixels - 1) / square(0, 0));
      fit.residual = std::sqrt(rest / light);
      return fit;
    }
    const Eigen::Vector3d found = solver.solve(right);
    fit.gain = found(0);
    rest = std::max(0.0, all - found.dot(right));
    const Vec2 change{found(1) / fit.gain, found(2) / fit.gain};
    const double size = length(change);
    if (!std::isfinite(size)) return {};
    // Linear in the shift over about a pixel only.
    fit.shift = fit.shift + (size > 1 ? 1 / size : 1.0) * change;
    if (length(fit.shift) > kMostShift) return {};
    if (size < kLastStep) break;
  }
  const double variance = rest / static_cast<double>(fit.pixels - 3);
  const Eigen::Matrix3d covariance = variance * square.inverse();
  fit.gain_error = std::sqrt(covariance(0, 0));
  fit.shift_error = {std::sqrt(covariance(1, 1)) / std::fabs(fit.gain),
                     std::sqrt(covariance(2, 2)) / std::fabs(fit.gain)};
  fit.residual = std::sqrt(rest / light) / std::fabs(fit.gain);
  return fit;
}

/// The pixels of a disc that lie in the window.
std::vector<PixelRun> disc_runs(const PixelWindow& window, Vec2 centre, double rx, double ry) {
  std::vector<PixelRun> runs;
  const double x = centre.x - window.x, y = centre.y - window.y;
  const int first = std::max(0, static_cast<int>(std::ceil(y - ry - 0.5)));
  const int last = std::min(window.height - 1, static_cast<int>(std::floor(y + ry - 0.5)));
  for (int row = first; row <= last; ++row) {
    const double h = (row + 0.5 - y) / ry;
    const double half = rx * std::sqrt(std::max(0.0, 1 - h * h));
    const int begin = std::max(0, static_cast<int>(std::ceil(x - half - 0.5)));
    const int end = std::min(window.width, static_cast<int>(std::floor(x + half - 0.5)) + 1);
    if (begin < end) runs.push_back({row, begin, end});
  }
  return runs;
}

}  // namespace

Registration register_pictures(const Image& measured, const Image& simulated,
                               const PixelWindow& window, const MicroImages& micro_images,
                               const Execution& execution) {
  if (measured.width != simulated.width || measured.height != simulated.height ||
      measured.width != window.width || measured.height != window.height)
    throw InputError("the pictures have " + std::to_string(measured.width) + " x " +
                     std::to_string(measured.height) + " and " + std::to_string(simulated.width) +
                     " x " + std::to_string(simulated.height) +
                     " pixels: they are not of the same sensor or window");
  const Camera& camera = micro_images.camera();
  Registration result;
  std::vector<PixelRun> all;
  for (int row = 0; row < window.height; ++row) all.push_back({row, 0, window.width});
  result.whole = fit_runs(measured, simulated, all);
  if (result.whole.pixels == 0)
    throw InputError(
        "the pictures do not fit: the simulated one has no light, or they are more than 5 pixels "
        "apart");
  const Vec2 p = camera.spec().sensor.pixel();
  const Vec2 upper = camera.sensor_point(window.x, window.y);
  const Vec2 lower = camera.sensor_point(window.x + window.width, window.y + window.height);
  // Half the distance to the neighbours: what is beyond belongs to them.
  const double reach = 0.5 * micro_images.spacing();
  for (const LensIndex lens : camera.lattice().within(lower, upper)) {
    const MicroImages::Place place = micro_images.place(lens);
    if (!place.dark)
      result.lenses.push_back({lens, place.type, camera.image_point(place.centre), {}});
  }
  std::vector<double> light(result.lenses.size(), 0);
  constexpr std::size_t kPart = 64;
  const std::size_t parts = (result.lenses.size() + kPart - 1) / kPart;
  const bool done = parallel_for(execution, parts, [&](std::size_t part, int) {
    for (std::size_t k = part * kPart; k < std::min(result.lenses.size(), (part + 1) * kPart);
         ++k) {
      LensFit& lens = result.lenses[k];
      const auto runs = disc_runs(window, lens.centre, reach / p.x, reach / p.y);
      for (const PixelRun& run : runs)
        for (int x = run.begin; x < run.end; ++x) {
          const auto value = static_cast<double>(simulated.at(x, run.row));
          light[k] += value * value;
        }
      if (light[k] > 0) lens.fit = fit_runs(measured, simulated, runs);
    }
  });
  if (!done) throw Cancelled();
  const double most = light.empty() ? 0 : *std::max_element(light.begin(), light.end());
  std::vector<LensFit> lit;
  std::vector<double> shifts;
  for (std::size_t k = 0; k < light.size(); ++k) {
    if (!(light[k] > kLitShare * most) || result.lenses[k].fit.pixels == 0) continue;
    lit.push_back(result.lenses[k]);
    shifts.push_back(length(result.lenses[k].fit.shift));
  }
  result.lenses = std::move(lit);
  if (!shifts.empty()) {
    const auto middle = shifts.begin() + static_cast<std::ptrdiff_t>(shifts.size() / 2);
    std::nth_element(shifts.begin(), middle, shifts.end());
    result.median_shift = *middle;
  }
  return result;
}

Image registration_residual(const Image& measured, const Image& simulated, const PictureFit& fit) {
  Image rest(measured.width, measured.height);
  const ShiftedPicture picture(simulated, fit.shift);
  for (int row = 0; row < rest.height; ++row)
    for (int column = 0; column < rest.width; ++column)
      rest.at(column, row) = static_cast<float>(static_cast<double>(measured.at(column, row)) -
                                                fit.gain * picture.at(column, row).value);
  return rest;
}

}  // namespace plenoflame
