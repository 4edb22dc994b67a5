#include "plenoflame/lightfield/geometry.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

std::complex<double> lattice_point(bool hexagonal, int i, int j) {
  return hexagonal ? std::complex<double>(i + 0.5 * j, j * std::sqrt(0.75))
                   : std::complex<double>(i, j);
}

/// All microlenses whose micro-images can reach the window.
std::vector<LensIndex> lenses_of(const MicroImages& micro, const PixelWindow& window) {
  const Camera& camera = micro.camera();
  const Vec2 upper = camera.sensor_point(window.x, window.y);
  const Vec2 lower = camera.sensor_point(window.x + window.width, window.y + window.height);
  const Vec2 margin{2 * micro.spacing(), 2 * micro.spacing()};
  return camera.lattice().within(lower - margin, upper + margin);
}

}  // namespace

Vec2 MicroImageGrid::point(int i, int j) const {
  const std::complex<double> p = std::polar(pitch, rotation) * lattice_point(hexagonal, i, j);
  return {origin.x + p.real(), origin.y + p.imag()};
}

MicroImageGrid fit_grid(const MicroImages& micro_images, const PixelWindow& window) {
  const Camera& camera = micro_images.camera();
  MicroImageGrid grid;
  grid.hexagonal = camera.spec().array.lattice == Lattice::hexagonal;
  using Complex = std::complex<double>;
  std::vector<Complex> from, to;
  for (const LensIndex lens : lenses_of(micro_images, window)) {
    const MicroImages::Place place = micro_images.place(lens);
    if (place.dark) continue;
    const Vec2 centre = camera.image_point(place.centre);
    const Complex at(centre.x, centre.y);
    if (at.real() < window.x || at.imag() < window.y || at.real() > window.x + window.width ||
        at.imag() > window.y + window.height)
      continue;
    from.push_back(lattice_point(grid.hexagonal, -lens.q, -lens.r));
    to.push_back(at);
  }
  if (from.size() < 3)
    throw InputError("the light field's window holds too few micro-images to fit a grid to them");
  Complex from_mean = 0, to_mean = 0, product = 0;
  double square = 0;
  const auto n = static_cast<double>(from.size());
  for (std::size_t k = 0; k < from.size(); ++k) {
    from_mean += from[k] / n;
    to_mean += to[k] / n;
  }
  for (std::size_t k = 0; k < from.size(); ++k) {
    product += std::conj(from[k] - from_mean) * (to[k] - to_mean);
    square += std::norm(from[k] - from_mean);
  }
  const Complex scale = product / square, origin = to_mean - scale * from_mean;
  for (std::size_t k = 0; k < from.size(); ++k)
    grid.worst = std::max(grid.worst, std::abs(origin + scale * from[k] - to[k]));
  grid.origin = {origin.real(), origin.imag()};
  grid.pitch = std::abs(scale);
  grid.rotation = std::arg(scale);
  grid.mean_radius = micro_images.place(camera.lattice().nearest({0, 0})).radius /
                     camera.spec().sensor.pixel_pitch;
  return grid;
}

Image white_image(const MicroImages& micro_images, const PixelWindow& window,
                  const Execution& execution) {
  const Camera& camera = micro_images.camera();
  const Vec2 p = camera.spec().sensor.pixel();
  Image image(window.width, window.height);
  const std::vector<LensIndex> lenses = lenses_of(micro_images, window);
  // Bands of rows: each pixel belongs to one, and sums its microlenses in their order.
  constexpr std::size_t kBands = 32;
  const bool done = parallel_for(execution, kBands, [&](std::size_t band, int) {
    const auto rows = static_cast<std::size_t>(window.height);
    const int first = static_cast<int>(band * rows / kBands);
    const int last = static_cast<int>((band + 1) * rows / kBands);
    for (const LensIndex lens : lenses) {
      const MicroImages::Place place = micro_images.place(lens);
      if (place.dark) continue;
      const MicroImages::WhiteTable white(micro_images, place);
      const Vec2 middle = camera.image_point(place.centre);
      const double x = middle.x - window.x, y = middle.y - window.y;
      const double reach_x = white.reach() / p.x, reach_y = white.reach() / p.y;
      const auto bound = [](double value, int low, int high) {
        return static_cast<int>(
            std::clamp(value, static_cast<double>(low), static_cast<double>(high)));
      };
      const int row_end = bound(std::ceil(y + reach_y), first, last);
      for (int row = bound(std::floor(y - reach_y), first, last); row < row_end; ++row) {
        const int column_end = bound(std::ceil(x + reach_x), 0, window.width);
        for (int column = bound(std::floor(x - reach_x), 0, window.width); column < column_end;
             ++column)
          image.at(column, row) += static_cast<float>(
              white(camera.sensor_point(window.x + column + 0.5, window.y + row + 0.5)));
      }
    }
  });
  if (!done) throw Cancelled();
  return image;
}

double ViewGeometry::disparity(double z, double offset) const {
  const double agreed = std::isfinite(focus) ? 1 / (focus - plane) : 0.0;
  return focal * centre_step * offset * (1 / (z - plane) - agreed);
}

ViewGeometry fit_view_geometry(const MicroImages& micro_images, double lens_step) {
  const Camera& camera = micro_images.camera();
  const double pixel = camera.spec().sensor.pixel_pitch;
  // Line = m * lens centre + o * offset, for position and slope alike. The four numbers are fitted
  // by least squares over microlenses and offsets within the paraxial half of the field.
  const double half_width = 0.25 * camera.spec().sensor.size().x;
  const double half_height = 0.25 * camera.spec().sensor.size().y;
  const auto lenses =
      camera.lattice().within({-half_width, -half_height}, {half_width, half_height});
  const std::size_t stride = std::max<std::size_t>(1, lenses.size() / 400);
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d right = Eigen::Matrix2d::Zero();
  for (std::size_t k = 0; k < lenses.size(); k += stride) {
    const MicroImages::Place place = micro_images.place(lenses[k]);
    if (place.dark) continue;
    const Vec2 lens = camera.lattice().centre(lenses[k]);
    for (const Vec2 u : {Vec2{0, 0}, Vec2{0.6, 0}, Vec2{-0.6, 0}, Vec2{0, 0.6}, Vec2{0, -0.6}}) {
      const Vec2 offset = place.radius * u;
      const MicroImages::Line line = micro_images.chief_ray(place, place.centre + offset);
      const auto add = [&](double m, double o, double position, double slope) {
        const Eigen::Vector2d row(m, o);
        square += row * row.transpose();
        right += row * Eigen::Vector2d(position, slope).transpose();
      };
      add(lens.x, offset.x, line.position.x, line.slope.x);
      add(lens.y, offset.y, line.position.y, line.slope.y);
    }
  }
  if (!(square.determinant() > 0))
    throw InputError("too little light gets through the camera to say where its views stand");
  const Eigen::Matrix2d fit = square.ldlt().solve(right);
  const double lens_position = fit(0, 0), lens_slope = fit(0, 1);
  const double offset_position = fit(1, 0), offset_slope = fit(1, 1);
  ViewGeometry geometry;
  geometry.plane = -lens_position / lens_slope;
  geometry.focus = -offset_position / offset_slope;
  if (!(geometry.focus > geometry.plane) || geometry.focus > 1e6) geometry.focus = kInfinity;
  // The image is upright: its offsets and pixels run against camera x, y on the sensor.
  geometry.focal = std::fabs(1 / (lens_slope * lens_step));
  geometry.centre_step = std::fabs((offset_position + geometry.plane * offset_slope) * pixel);
  return geometry;
}

bool is_unfocused(const Camera& camera) {
  return std::all_of(camera.microlenses().begin(), camera.microlenses().end(),
                     [](const Microlens& lens) {
                       const double f = lens.first_order.focal_length;
                       return std::fabs(lens.sensor_distance - f) <= 0.05 * f;
                     });
}

}  // namespace plenoflame
