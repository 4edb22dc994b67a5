#include "plenoflame/lightfield/refocus.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "lightfield/micro_image_pixels.h"
#include "lightfield/refocus_sums.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/base/units.h"
#include "plenoflame/optics/first_order.h"

namespace plenoflame {
namespace {

constexpr std::size_t kParts =
    8;  ///< of the work, summed in order: any number of threads gives the same
constexpr double kDark = 0.03;  ///< of a stack's brightest place: light of neighbours' blur

struct Target {
  double pixel = 0;  ///< [m]
  Vec2 corner;       ///< [m]
  int width = 0, height = 0;
};

/// The part of the plane that the middles of the micro-images see.
Target target_of(const MicroImages& micro, const std::vector<MicroImages::Place>& places,
                 double depth, int width) {
  Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
  for (const MicroImages::Place& place : places) {
    if (place.dark) continue;
    const Vec2 point = micro.to_plane(place, depth)(place.centre);
    lower = {std::min(lower.x, point.x), std::min(lower.y, point.y)};
    upper = {std::max(upper.x, point.x), std::max(upper.y, point.y)};
  }
  if (!(upper.x > lower.x && upper.y > lower.y))
    throw InputError("the light field's window holds too few micro-images to refocus");
  Target target;
  target.width = width;
  target.pixel = (upper.x - lower.x) / width;
  target.height = std::max(1, static_cast<int>(std::lround((upper.y - lower.y) / target.pixel)));
  target.corner = {lower.x, 0.5 * (lower.y + upper.y) - 0.5 * target.height * target.pixel};
  return target;
}

/// A micro-image's map from sensor to plane as polynomials of degree 5 of the place in it. Places
/// are in radii from its middle along the sensor's columns and rows. The result is exact for the
/// tables' polynomials of the same degree, rotated.
class PlanePolynomials {
 public:
  static constexpr int kDegree = 5;
  static constexpr std::size_t kTerms = 21;

  PlanePolynomials() {
    // Lines of 6, 5, ... 1 points determine the 21 coefficients; Chebyshev's, so that they do well.
    Eigen::Matrix<double, kTerms, kTerms> values;
    const auto node = [](int k, int count) { return std::cos(constants::pi * (k + 0.5) / count); };
    constexpr std::array<int, 6> kLine = {2, 3, 1, 4, 0, 5};  // the longest near the middle
    Eigen::Index n = 0;
    for (std::size_t line = 0; line < kLine.size(); ++line)
      for (int k = 0, count = kDegree + 1 - static_cast<int>(line); k < count; ++k) {
        const double y = node(kLine[line], kDegree + 1);
        nodes_[static_cast<std::size_t>(n)] = {std::sqrt(1 - y * y) * node(k, count), y};
        const Vec2 at = nodes_[static_cast<std::size_t>(n)];
        Eigen::Index term = 0;
        for (int j = 0; j <= kDegree; ++j)
          for (int i = 0; i + j <= kDegree; ++i)
            values(n, term++) = std::pow(at.x, i) * std::pow(at.y, j);
        ++n;
      }
    inverse_ = values.inverse();
  }

  using Terms = Eigen::Matrix<double, kTerms, 2>;  ///< of the places along and across

  /// @param to_picture from the plane [m] to the picture's pixels, relative to one of them
  template <class ToPicture>
  Terms of(const MicroImages::ToPlane& to_plane, const MicroImages::Place& place, double radius,
           const ToPicture& to_picture) const {
    Terms points;
    for (std::size_t n = 0; n < kTerms; ++n) {
      const Vec2 at =
          to_picture(to_plane(place.centre + radius * Vec2{-nodes_[n].x, -nodes_[n].y}));
      points(static_cast<Eigen::Index>(n), 0) = at.x;
      points(static_cast<Eigen::Index>(n), 1) = at.y;
    }
    return inverse_ * points;
  }

 private:
  std::array<Vec2, kTerms> nodes_;
  Eigen::Matrix<double, kTerms, kTerms> inverse_;
};

/// Quantities that are the same for all micro-images of a plane.
struct PlaneJob {
  const LightField& field;
  const Image& flux;
  const MicroImages& micro;
  const Target& target;
  const PlanePolynomials& polynomials;
  MicroImageKernels kernels;
  Isa isa;
  double depth = 0;
};

/// Memory for the pixels of a micro-image.
struct Scratch {
  MicroImages::Pixels pixels;
  std::vector<float> flux, right, down, light, white;
  std::vector<int> column, row;
};

[[noreturn]] void report_not_finite(const Scratch& scratch) {
  for (const MicroImages::Pixels::Row& row : scratch.pixels.rows)
    for (std::size_t k = 0; k < row.count; ++k)
      if (scratch.pixels.own[row.begin + k] > 0 && !std::isfinite(scratch.flux[row.begin + k]))
        throw InputError("the light field holds a value that is not finite, in column " +
                         std::to_string(row.column + static_cast<int>(k)) + ", row " +
                         std::to_string(row.row));
  throw InputError("the light field holds values too large to add up");
}

void add_micro_image(const PlaneJob& job, const MicroImages::Place& place, double radius,
                     double weight, Scratch& scratch, RefocusBand& band) {
  const SensorSpec& sensor = job.micro.camera().spec().sensor;
  const PixelWindow& window = job.field.window;
  MicroImages::Pixels& pixels = scratch.pixels;
  pixels.set(sensor, window, place.centre, radius);
  if (pixels.x.empty()) return;
  const std::size_t count = pixels.x.size();
  for (std::vector<float>* values :
       {&scratch.flux, &scratch.right, &scratch.down, &scratch.light, &scratch.white})
    values->resize(count);
  scratch.column.resize(count);
  scratch.row.resize(count);
  for (const MicroImages::Pixels::Row& row : pixels.rows) {
    const std::size_t from =
        static_cast<std::size_t>(row.row - window.y) * static_cast<std::size_t>(window.width) +
        static_cast<std::size_t>(row.column - window.x);
    std::copy_n(job.flux.pixels.data() + from, row.count, scratch.flux.data() + row.begin);
  }
  MicroImages::LocalWhite(job.micro, place.lens, radius).fill(pixels, job.isa);

  const MicroImages::ToPlane to_plane = job.micro.to_plane(place, job.depth);
  const auto to_picture = [&](Vec2 point) {
    return Vec2{(point.x - job.target.corner.x) / job.target.pixel - 0.5,
                (point.y - job.target.corner.y) / job.target.pixel - 0.5};
  };
  // Places relative to the pixel of the middle, so that single precision does.
  const Vec2 middle = to_picture(to_plane(place.centre));
  if (!(std::fabs(middle.x) < 1e8 && std::fabs(middle.y) < 1e8)) return;
  const Vec2 base{std::floor(middle.x), std::floor(middle.y)};
  const PlanePolynomials::Terms terms = job.polynomials.of(
      to_plane, place, radius, [&](Vec2 point) { return to_picture(point) - base; });
  KernelProjection task{};
  for (std::size_t k = 0; k < PlanePolynomials::kTerms; ++k) {
    task.along[k] = static_cast<float>(terms(static_cast<Eigen::Index>(k), 0));
    task.across[k] = static_cast<float>(terms(static_cast<Eigen::Index>(k), 1));
  }
  task.count = static_cast<int>(count);
  task.x = pixels.x.data();
  task.y = pixels.y.data();
  task.scale_x = static_cast<float>(sensor.pixel().x / radius);
  task.scale_y = static_cast<float>(sensor.pixel().y / radius);
  // Light that came through neighbours cannot be separated. The pixel counts with the share of its
  // own light, as if the scene were the same there.
  task.weight = static_cast<float>(weight);
  task.flux = scratch.flux.data();
  task.own = pixels.own.data();
  task.total = pixels.total.data();
  const KernelSamples samples{scratch.column.data(), scratch.row.data(),   scratch.right.data(),
                              scratch.down.data(),   scratch.light.data(), scratch.white.data()};
  if (!job.kernels.project(task, samples)) report_not_finite(scratch);
  band.add(static_cast<int>(base.x), static_cast<int>(base.y), count, samples);
}

/// The sums of one plane.
struct Plane {
  Target target;
  RefocusSums sums;
};

Plane accumulate(const LightField& light_field, const MicroImages& micro_images,
                 const RefocusSettings& settings, bool square, const Execution& execution) {
  const Camera& camera = micro_images.camera();
  check_refocus_depth(camera, settings.depth);
  if (settings.width < 0 || settings.width > 20000)
    throw InputError("refocus: the picture has 1 to 20000 pixels across");
  if (!(settings.aperture > 0 && settings.aperture <= 1))
    throw InputError("refocus: the synthetic aperture lies above 0 and up to 1");
  const Image& flux = find_channel(light_field, settings.channel).flux;
  const PixelWindow& window = light_field.window;
  const ArraySpec& array = camera.spec().array;
  // Lenses whose micro-images begin inside the window.
  const double scale = shortest_pitch(array) / micro_images.spacing();
  const Vec2 upper = scale * camera.sensor_point(window.x, window.y);
  const Vec2 lower = scale * camera.sensor_point(window.x + window.width, window.y + window.height);
  std::vector<MicroImages::Place> places;
  for (const LensIndex lens : camera.lattice().within(lower, upper))
    places.push_back(micro_images.place(lens));
  const int across = std::max(1, static_cast<int>(std::lround((upper.x - lower.x) / array.pitch)));
  const Target target =
      target_of(micro_images, places, settings.depth, settings.width > 0 ? settings.width : across);
  std::vector<double> weights(camera.microlenses().size(), 1.0);
  if (settings.sharp_types) weights = type_weights(camera, settings.depth, target.pixel);

  // If micro-images overlap, each pixel belongs to the nearest; half the spacing is a safe
  // bound. The disc always holds the middle of a pixel, however small the micro-images are.
  const double most = 0.5 * micro_images.spacing(), least = pixel_disc(camera.spec().sensor);
  const PlanePolynomials polynomials;
  const PlaneJob job{light_field,  flux,          micro_images,
                     target,       polynomials,   micro_image_kernels(settings.isa),
                     settings.isa, settings.depth};
  std::vector<RefocusBand> parts(kParts, RefocusBand(target.width, target.height, square));
  const bool done = reported_parallel_for(execution, kParts, [&](std::size_t part, int) {
    Scratch scratch;
    for (std::size_t k = part * places.size() / kParts; k < (part + 1) * places.size() / kParts;
         ++k)
      if (!places[k].dark)
        add_micro_image(job, places[k],
                        std::max(std::min(settings.aperture * places[k].radius, most), least),
                        weights[static_cast<std::size_t>(places[k].type)], scratch, parts[part]);
  });
  if (!done) throw Cancelled();
  RefocusSums sums(target.width, target.height, square);
  for (const RefocusBand& part : parts) part.add_to(sums);
  return {target, std::move(sums)};
}

/// The picture of a plane. Fills the gaps of its sums.
RefocusedImage picture_of(Plane& plane, double depth) {
  fill_gaps(plane.sums);
  RefocusedImage result;
  result.image = Image(plane.target.width, plane.target.height);
  for (std::size_t k = 0; k < plane.sums.white.size(); ++k)
    if (plane.sums.white[k] > 0)
      result.image.pixels[k] = static_cast<float>(plane.sums.light[k] / plane.sums.white[k]);
  result.depth = depth;
  result.pixel = plane.target.pixel;
  result.corner = plane.target.corner;
  return result;
}

/// Mean over the square of kBox x kBox pixels around each pixel, cut at the rim.
std::vector<double> box_mean(const std::vector<double>& values, int width, int height) {
  constexpr int kHalf = 2;
  const auto at = [width](int column, int row) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(column);
  };
  std::vector<double> rows(values.size()), result(values.size());
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const int first = std::max(0, column - kHalf), last = std::min(width - 1, column + kHalf);
      double total = 0;
      for (int c = first; c <= last; ++c) total += values[at(c, row)];
      rows[at(column, row)] = total / (last - first + 1);
    }
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const int first = std::max(0, row - kHalf), last = std::min(height - 1, row + kHalf);
      double total = 0;
      for (int r = first; r <= last; ++r) total += rows[at(column, r)];
      result[at(column, row)] = total / (last - first + 1);
    }
  return result;
}

}  // namespace

void check_refocus_depth(const Camera& camera, double depth) {
  const double focal = std::max(0.0, -camera.lens_first_order().front_focal_distance);
  if (depth > focal && std::isfinite(depth)) return;
  const std::string given =
      "cannot refocus at " + readable_quantity(depth, Dimension::length) + ": ";
  if (!(depth > 0))
    throw InputError(given +
                     "the plane lies behind the front of the camera; give a depth above 0 m");
  throw InputError(given + "the depth must be finite and beyond the front focal plane, " +
                   readable_quantity(focal, Dimension::length) + " in front of the lens");
}

std::vector<double> type_weights(const Camera& camera, double depth, double pixel) {
  const FirstOrder& main = camera.lens_first_order();
  const double image = camera.rear_vertex() - paraxial_image_distance(main, depth);
  const double on_image = std::fabs(paraxial_magnification(main, depth)) * pixel;
  std::vector<double> blur, tolerated;
  double best = kInfinity;
  for (const Microlens& lens : camera.microlenses()) {
    const double object = image - lens.front_principal;  // a > 0: in front of the array
    const double f = lens.first_order.focal_length, gap = lens.sensor_distance;
    blur.push_back(camera.spec().array.diameter * std::fabs(gap * (1 / f - 1 / object) - 1));
    tolerated.push_back(
        std::max(camera.spec().sensor.pixel_pitch, on_image * gap / std::fabs(object)));
    best = std::min(best, blur.back());
  }
  std::vector<double> weights;
  for (std::size_t type = 0; type < blur.size(); ++type) {
    const double ratio = blur[type] / std::max(best, tolerated[type]);
    weights.push_back(ratio > 1 ? 1 / (ratio * ratio * ratio * ratio) : 1.0);
  }
  return weights;
}

RefocusedImage refocus(const LightField& light_field, const MicroImages& micro_images,
                       const RefocusSettings& settings, const Execution& execution) {
  Plane plane = accumulate(light_field, micro_images, settings, false, execution);
  return picture_of(plane, settings.depth);
}

FocusStack focus_stack(const LightField& light_field, const MicroImages& micro_images,
                       const std::vector<double>& depths, const RefocusSettings& settings,
                       const Execution& execution) {
  if (depths.size() < 3) throw InputError("a focus stack needs at least 3 depths to choose among");
  for (std::size_t k = 1; k < depths.size(); ++k)
    if (!(depths[k] > depths[k - 1]))
      throw InputError("the depths of a focus stack must ascend, each once");
  FocusStack stack;
  std::vector<std::vector<double>> costs, powers;  // variances at first, and squares of means
  for (const double depth : depths) {
    RefocusSettings how = settings;
    how.depth = depth;
    const double share = 1.0 / static_cast<double>(depths.size());
    const double from = share * static_cast<double>(stack.planes.size());
    Plane plane =
        accumulate(light_field, micro_images, how, true, part_of_progress(execution, from, share));
    const RefocusSums& sums = plane.sums;
    if (!stack.planes.empty()) {
      const Image& first = stack.planes.front().image;
      // The same microlenses are the outermost at all depths, but for rounding.
      if (first.width != sums.width || std::abs(first.height - sums.height) > 1)
        throw InputError("the planes of the stack do not show the same field");
    }
    std::vector<double> variance(sums.white.size()), power(variance);
    for (std::size_t k = 0; k < variance.size(); ++k) {
      if (!(sums.white[k] > 0)) continue;
      const double mean = sums.light[k] / sums.white[k];
      variance[k] = std::max(0.0, sums.square[k] / sums.white[k] - mean * mean);
      power[k] = mean * mean;
    }
    costs.push_back(box_mean(variance, sums.width, sums.height));
    powers.push_back(box_mean(power, sums.width, sums.height));
    stack.planes.push_back(picture_of(plane, depth));
  }
  // Division by the square of the mean: light that is spread thinly out of focus must not count as
  // equal. A place that is dark in some plane counts as equal there, for any variance of its little
  // light.
  double brightest = 0;
  for (const std::vector<double>& power : powers)
    brightest = std::max(brightest, *std::max_element(power.begin(), power.end()));
  const double dark = kDark * kDark * brightest;
  for (std::size_t d = 0; d < costs.size(); ++d)
    for (std::size_t k = 0; k < costs[d].size(); ++k)
      costs[d][k] = brightest > 0 ? costs[d][k] / (powers[d][k] + dark) : 0;
  int height = stack.planes.front().image.height;
  for (const RefocusedImage& plane : stack.planes) height = std::min(height, plane.image.height);
  const int width = stack.planes.front().image.width;
  stack.all_in_focus = stack.depth = stack.confidence = Image(width, height);
  for (RefocusedImage& plane : stack.planes) {
    plane.image.height = height;
    plane.image.pixels.resize(stack.depth.pixels.size());
  }
  for (std::size_t k = 0; k < stack.depth.pixels.size(); ++k) {
    std::size_t best = 0;
    double sum = 0;
    for (std::size_t d = 0; d < costs.size(); ++d) {
      sum += costs[d][k];
      if (costs[d][k] < costs[best][k]) best = d;
    }
    if (!(sum > 0)) continue;
    stack.all_in_focus.pixels[k] = stack.planes[best].image.pixels[k];
    const double least = costs[best][k];
    stack.confidence.pixels[k] =
        static_cast<float>(1 - least * static_cast<double>(costs.size()) / sum);
    // A parabola over the planes' numbers; depth between planes goes as its inverse does.
    double shift = 0;
    if (best > 0 && best + 1 < costs.size()) {
      const double before = costs[best - 1][k], after = costs[best + 1][k];
      const double bend = before - 2 * least + after;
      if (bend > 0) shift = std::clamp(0.5 * (before - after) / bend, -0.5, 0.5);
    }
    const std::size_t other = shift > 0 ? best + 1 : shift < 0 ? best - 1 : best;
    stack.depth.pixels[k] = static_cast<float>(
        1 / ((1 - std::fabs(shift)) / depths[best] + std::fabs(shift) / depths[other]));
  }
  return stack;
}

}  // namespace plenoflame
