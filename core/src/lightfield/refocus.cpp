#include "plenoflame/lightfield/refocus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/optics/first_order.h"

namespace plenoflame {
namespace {

constexpr std::size_t kParts =
    8;  ///< of the work, summed in order: any number of threads gives the same

/// Light and white light, in pixels of the picture.
struct Sums {
  int width = 0, height = 0;
  std::vector<double> light, white, square;  ///< square: of the radiance; empty: not wanted
  Sums(int w, int h, bool with_square = false)
      : width(w),
        height(h),
        light(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)),
        white(light),
        square(with_square ? light.size() : 0) {}
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(column);
  }
  /// Bilinear; x, y count from the middle of pixel (0, 0).
  void add(double x, double y, double light_, double white_) {
    const double x_floor = std::floor(x), y_floor = std::floor(y);
    if (!(x_floor >= -1 && y_floor >= -1 && x_floor < width && y_floor < height)) return;
    const int i = static_cast<int>(x_floor), j = static_cast<int>(y_floor);
    for (int b = 0; b <= 1; ++b)
      for (int a = 0; a <= 1; ++a) {
        if (i + a < 0 || j + b < 0 || i + a >= width || j + b >= height) continue;
        const double weight =
            (a == 1 ? x - x_floor : 1 - (x - x_floor)) * (b == 1 ? y - y_floor : 1 - (y - y_floor));
        light[index(i + a, j + b)] += weight * light_;
        white[index(i + a, j + b)] += weight * white_;
        if (!square.empty()) square[index(i + a, j + b)] += weight * light_ * light_ / white_;
      }
  }
};

/// Gives pixels that met nothing what their surroundings have: a level of half the size, filled in
/// the same way, counts with a weight that never shows where there are samples.
void fill_gaps(Sums& sums) {
  if (sums.width < 2 || sums.height < 2) return;
  double largest = 0;
  for (const double w : sums.white) largest = std::max(largest, w);
  const double least = 1e-3 * largest;
  if (std::none_of(sums.white.begin(), sums.white.end(), [&](double w) { return w < least; }))
    return;
  Sums coarse((sums.width + 1) / 2, (sums.height + 1) / 2);
  for (int row = 0; row < sums.height; ++row)
    for (int column = 0; column < sums.width; ++column) {
      const std::size_t from = sums.index(column, row), to = coarse.index(column / 2, row / 2);
      coarse.light[to] += sums.light[from];
      coarse.white[to] += sums.white[from];
    }
  fill_gaps(coarse);
  for (int row = 0; row < sums.height; ++row)
    for (int column = 0; column < sums.width; ++column) {
      const std::size_t to = sums.index(column, row), from = coarse.index(column / 2, row / 2);
      if (sums.white[to] >= least || coarse.white[from] <= 0) continue;
      const double missing = least - sums.white[to];
      sums.light[to] += missing * coarse.light[from] / coarse.white[from];
      sums.white[to] = least;
    }
}

struct Target {
  double pixel = 0;  ///< [m]
  Vec2 corner;       ///< [m]
  int width = 0, height = 0;
};

/// What the middles of the micro-images see of the plane.
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

/// Where the chief rays of a row of pixels meet the plane, one after the other. Along a row the map
/// is a polynomial of degree 5: six values say all, and forward differences give the rest, exactly.
class RowPoints {
 public:
  RowPoints(const MicroImages::ToPlane& to_plane, Vec2 first, Vec2 step) {
    for (std::size_t k = 0; k < kValues; ++k)
      differences_[k] = to_plane(first + static_cast<double>(k) * step);
    for (std::size_t order = 1; order < kValues; ++order)
      for (std::size_t k = kValues - 1; k >= order; --k)
        differences_[k] = differences_[k] - differences_[k - 1];
  }
  Vec2 next() {
    const Vec2 value = differences_[0];
    for (std::size_t k = 0; k + 1 < kValues; ++k)
      differences_[k] = differences_[k] + differences_[k + 1];
    return value;
  }

 private:
  static constexpr std::size_t kValues = 6;
  std::array<Vec2, kValues> differences_;
};

void add_micro_image(const LightField& field, const Image& flux, const MicroImages& micro,
                     const MicroImages::Place& place, const Target& target, double depth,
                     double radius, double weight, Sums& sums) {
  const SensorSpec& sensor = micro.camera().spec().sensor;
  const PixelWindow& window = field.window;
  const double p = sensor.pixel_pitch;
  const double x = 0.5 * sensor.columns - place.centre.x / p,
               y = 0.5 * sensor.rows - place.centre.y / p;
  const auto bound = [](double value, int low, int high) {
    return static_cast<int>(std::clamp(value, static_cast<double>(low), static_cast<double>(high)));
  };
  const double reach = radius / p;
  const int last_row = bound(std::floor(y + reach - 0.5) + 1, window.y, window.y + window.height);
  const MicroImages::ToPlane to_plane = micro.to_plane(place, depth);
  const MicroImages::LocalWhite local_white(micro, place.lens, radius);
  for (int row = bound(std::ceil(y - reach - 0.5), window.y, window.y + window.height);
       row < last_row; ++row) {
    // Pixels with their centres in the disc.
    const double above = row + 0.5 - y;
    const double half = std::sqrt(std::max(0.0, reach * reach - above * above));
    const int first = bound(std::ceil(x - half - 0.5), window.x, window.x + window.width);
    const int last = bound(std::floor(x + half - 0.5) + 1, window.x, window.x + window.width);
    if (first >= last) continue;
    RowPoints points(to_plane, micro.camera().sensor_point(first + 0.5, row + 0.5), {-p, 0});
    for (int column = first; column < last; ++column) {
      const Vec2 point = points.next();
      const MicroImages::White white =
          local_white(micro.camera().sensor_point(column + 0.5, row + 0.5));
      if (white.own <= 0) continue;
      const double light = static_cast<double>(flux.at(column - window.x, row - window.y));
      if (!std::isfinite(light))
        throw InputError("the light field holds a value that is not finite, in column " +
                         std::to_string(column) + ", row " + std::to_string(row));
      // Light that came through neighbours cannot be told apart: the pixel counts as much as its
      // own share of it, as though the scene were the same there.
      sums.add((point.x - target.corner.x) / target.pixel - 0.5,
               (point.y - target.corner.y) / target.pixel - 0.5,
               weight * light * white.own / white.total, weight * white.own);
    }
  }
}

/// The sums of one plane.
struct Plane {
  Target target;
  Sums sums;
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
  const double scale = array.pitch / micro_images.spacing();
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

  // Where micro-images overlap, each pixel belongs to the nearest; half the spacing is a safe
  // bound. The disc always holds the middle of a pixel, however small the micro-images are.
  const double most = 0.5 * micro_images.spacing(), least = 0.71 * camera.spec().sensor.pixel_pitch;
  std::vector<Sums> parts(kParts, Sums(target.width, target.height, square));
  const bool done = parallel_for(execution, kParts, [&](std::size_t part, int) {
    for (std::size_t k = part * places.size() / kParts; k < (part + 1) * places.size() / kParts;
         ++k)
      if (!places[k].dark)
        add_micro_image(light_field, flux, micro_images, places[k], target, settings.depth,
                        std::max(std::min(settings.aperture * places[k].radius, most), least),
                        weights[static_cast<std::size_t>(places[k].type)], parts[part]);
  });
  if (!done) throw Cancelled();
  Sums& sums = parts.front();
  for (std::size_t part = 1; part < kParts; ++part)
    for (std::size_t k = 0; k < sums.white.size(); ++k) {
      sums.light[k] += parts[part].light[k];
      sums.white[k] += parts[part].white[k];
      if (square) sums.square[k] += parts[part].square[k];
    }
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
  std::vector<std::vector<double>> costs;
  for (const double depth : depths) {
    RefocusSettings how = settings;
    how.depth = depth;
    Plane plane = accumulate(light_field, micro_images, how, true, execution);
    const Sums& sums = plane.sums;
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
    // Over the square of the mean: light that is spread thin out of focus must not count as even.
    std::vector<double> cost = box_mean(variance, sums.width, sums.height);
    const std::vector<double> means = box_mean(power, sums.width, sums.height);
    for (std::size_t k = 0; k < cost.size(); ++k) cost[k] = means[k] > 0 ? cost[k] / means[k] : 0;
    costs.push_back(std::move(cost));
    stack.planes.push_back(picture_of(plane, depth));
  }
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
