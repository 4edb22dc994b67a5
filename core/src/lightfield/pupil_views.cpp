#include "plenoflame/lightfield/pupil_views.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lightfield/micro_image_pixels.h"
#include "lightfield/view_grid.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr int kRim = 16;              ///< points around the place of a pixel on the stop
constexpr int kRings = 40;            ///< of aim points in a microlens
constexpr double kNeighbours = 1e-3;  ///< of a pixel's light may come through them
/// Factor on the blur for places away from the axis, where it is not traced.
constexpr double kRoom = 1.1;

double stop_radius_of(const Camera& camera) {
  if (camera.ideal_lens()) return camera.ideal().stop_radius;
  for (const SurfaceSpec& surface : camera.spec().lens.surfaces)
    if (surface.stop) return 0.5 * surface.diameter;
  return 1;
}

/// The part of the stop to which all that a pixel sees belongs; -1: there is none.
int part_of(const PupilFilters& filters, Vec2 at, double blur) {
  if (length(at) + blur > 1) return -1;
  const int part = filters.part_at(at);
  for (int k = 0; k < kRim; ++k) {
    const double angle = 2 * constants::pi * k / kRim;
    if (filters.part_at(at + blur * Vec2{std::cos(angle), std::sin(angle)}) != part) return -1;
  }
  return part;
}

/// The point where the ray from a sensor point through the middle of a microlens crosses the stop,
/// in its radii. It is affine about the middle of the micro-image and fitted to the outermost rays.
struct StopOfLens {
  Vec2 middle, along_x, along_y;  ///< of the sensor point's way from there, over its radius

  static std::optional<StopOfLens> of(const Camera& camera, const MicroImages::Place& place,
                                      double radius) {
    constexpr double kShare = 0.7;
    const auto at = [&](Vec2 way) { return camera.at_stop(place.centre + way, place.lens); };
    const double r = kShare * place.radius;
    const auto middle = at({0, 0}), right = at({r, 0}), left = at({-r, 0}), down = at({0, r}),
               up = at({0, -r});
    if (!middle || !right || !left || !down || !up) return std::nullopt;
    const double scale = 0.5 / (kShare * radius);
    return StopOfLens{(1 / radius) * *middle, scale * (*right - *left), scale * (*down - *up)};
  }
  Vec2 at(Vec2 way) const { return middle + way.x * along_x + way.y * along_y; }
};

/// The sums of one microlens and filter.
struct Sum {
  double flux = 0, variance = 0, white = 0, pixels = 0;
};

}  // namespace

double blur_of_stop(const MicroImages& micro_images, int type) {
  const Camera& camera = micro_images.camera();
  // A lens of the type near the axis.
  LensIndex lens = camera.lattice().nearest({0, 0});
  const double reach = 3 * longest_pitch(camera.spec().array);
  double nearest = kInfinity;
  for (const LensIndex other : camera.lattice().within({-reach, -reach}, {reach, reach}))
    if (const double away = length(camera.lattice().centre(other));
        camera.lattice().type(other) == type && away < nearest) {
      nearest = away;
      lens = other;
    }
  const MicroImages::Place place = micro_images.place(lens);
  const double stop = stop_radius_of(camera);
  const Vec3 middle = camera.lens_place(lens);
  double blur = 0;
  for (const Vec2 way : {Vec2{0, 0}, Vec2{0.8, 0}, Vec2{0, 0.8}, Vec2{-0.8, 0}, Vec2{0, -0.8}}) {
    const Vec2 s = place.centre + place.radius * way;
    const auto chief = camera.at_stop(s, lens);
    if (!chief) continue;
    // The light that a real lens lets through ends before its rim on one side, and may reach beyond
    // it on the other.
    for (int k = 0; k < kRim; ++k)
      for (int ring = kRings / 2; ring <= kRings * 11 / 10; ++ring) {
        const double angle = 2 * constants::pi * k / kRim;
        const double radius = camera.aperture().radius() * ring / kRings;
        const Vec2 aim{middle.x + radius * std::cos(angle), middle.y + radius * std::sin(angle)};
        if (const auto at = camera.at_stop(s, lens, aim))
          blur = std::max(blur, length(*at - *chief) / stop);
      }
  }
  return blur;
}

std::vector<int> parts_of_views(const MicroImages& micro_images, int grid, double spread) {
  const Camera& camera = micro_images.camera();
  const MicroImages::Place place = micro_images.place(camera.lattice().nearest({0, 0}));
  std::vector<int> parts(static_cast<std::size_t>(grid) * static_cast<std::size_t>(grid), -1);
  const auto map = StopOfLens::of(camera, place, stop_radius_of(camera));
  if (!map) return parts;
  const double blur = kRoom * blur_of_stop(micro_images, place.type) +
                      pixel_disc(camera.spec().sensor) / place.radius;
  for (int row = 0; row < grid; ++row)
    for (int column = 0; column < grid; ++column) {
      const auto place_of = [&](int i) { return spread * (2 * (i + 0.5) / grid - 1); };
      // The micro-image stands upside down.
      const Vec2 way{-place_of(column), -place_of(row)};
      parts[static_cast<std::size_t>(row * grid + column)] =
          part_of(camera.pupil_filters(), map->at(way), blur);
    }
  return parts;
}

std::vector<PupilView> extract_pupil_views(const LightField& light_field,
                                           const MicroImages& micro_images,
                                           const std::string& channel, const Execution& execution) {
  const Camera& camera = micro_images.camera();
  const PupilFilters& filters = camera.pupil_filters();
  if (filters.empty())
    throw InputError(
        "the camera has no camera.pupil_filters, through which light could be told "
        "apart");
  const LightFieldChannel& own = find_channel(light_field, channel);
  const bool errors = !own.standard_error.empty();
  const PixelWindow& window = light_field.window;
  const double stop = stop_radius_of(camera);
  const SensorSpec& sensor = camera.spec().sensor;
  const TypeLattice lattice(camera, -1);
  const OutputGrid grid = output_grid(micro_images, lattice.array, window);
  const std::vector<LensIndex> lenses = lattice.lenses(camera, grid);
  std::vector<double> blurs;
  for (int type = 0; type < static_cast<int>(camera.microlenses().size()); ++type)
    blurs.push_back(kRoom * blur_of_stop(micro_images, type));
  const auto parts = filters.filters().size();
  std::vector<std::vector<Sum>> sums(lenses.size(), std::vector<Sum>(parts));
  const bool done = parallel_for(execution, lenses.size(), [&](std::size_t k, int) {
    const MicroImages::Place place = micro_images.place(lenses[k]);
    if (place.dark) return;
    const auto map = StopOfLens::of(camera, place, stop);
    if (!map) return;
    // The corners of a pixel see so much more.
    const double blur =
        blurs[static_cast<std::size_t>(place.type)] + pixel_disc(sensor) / place.radius;
    const MicroImages::LocalWhite white(micro_images, lenses[k], place.radius);
    MicroImages::Pixels pixels;
    pixels.set(sensor, window, place.centre, place.radius);
    for (const MicroImages::Pixels::Row& row : pixels.rows)
      for (std::size_t i = 0; i < row.count; ++i) {
        const int column = row.column + static_cast<int>(i);
        const Vec2 s = camera.sensor_point(column + 0.5, row.row + 0.5);
        const int part = part_of(filters, map->at((1 / place.radius) * (s - place.centre)), blur);
        if (part < 0 || part >= static_cast<int>(parts)) continue;
        const MicroImages::White light = white(s);
        if (!(light.own > 0) || light.total > (1 + kNeighbours) * light.own) continue;
        const auto flux = static_cast<double>(own.flux.at(column - window.x, row.row - window.y));
        if (!std::isfinite(flux)) continue;
        Sum& sum = sums[k][static_cast<std::size_t>(part)];
        sum.flux += flux;
        sum.white += light.own;
        sum.pixels += 1;
        if (!errors) continue;
        const auto error =
            static_cast<double>(own.standard_error.at(column - window.x, row.row - window.y));
        sum.variance += error * error;
      }
  });
  if (!done) throw Cancelled();
  std::vector<LensIndex> indices;
  for (const LensIndex lens : lenses) indices.push_back(lattice.index(lens));
  std::vector<PupilView> views;
  for (std::size_t part = 0; part < parts; ++part) {
    PupilView view;
    view.filter = filters.name(static_cast<int>(part));
    LensSamples radiance(lattice.array, indices), error(lattice.array, indices);
    double lit = 0;
    for (std::size_t k = 0; k < lenses.size(); ++k) {
      const Sum& sum = sums[k][part];
      if (!(sum.white > 0)) continue;
      radiance.at(indices[k]) = static_cast<float>(sum.flux / sum.white);
      error.at(indices[k]) = static_cast<float>(std::sqrt(sum.variance) / sum.white);
      view.pixels += sum.pixels;
      lit += 1;
    }
    if (lit == 0)
      throw InputError("no pixel sees pupil filter \"" + view.filter +
                       "\" alone: its part of the stop is narrower than what one pixel sees, " +
                       "or the window holds no micro-image");
    view.pixels /= lit;
    view.light.name = view.filter;
    view.light.flux = resampled(radiance, grid, ViewResampling::nearest);
    if (errors) view.light.standard_error = resampled(error, grid, ViewResampling::nearest);
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace plenoflame
