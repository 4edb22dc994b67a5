#include "plenoflame/lightfield/views.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lightfield/view_grid.h"
#include "lightfield/view_resampling.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"

namespace plenoflame {
namespace {

void check(const ViewSettings& settings, const Camera& camera) {
  if (settings.grid < 1 || settings.grid > 99)
    throw InputError("views: the grid has 1 to 99 views along a side");
  if (!(settings.spread >= 0 && settings.spread <= 1))
    throw InputError("views: the spread lies between 0 and 1 diameters of a micro-image");
  const auto types = static_cast<int>(camera.spec().array.types.size());
  if (settings.type < -1 || settings.type >= types)
    throw InputError("views: the camera has no such type of microlens");
  const bool paper = settings.resampling == ViewResampling::paper9 ||
                     settings.resampling == ViewResampling::paper10;
  if (paper && camera.spec().array.lattice != Lattice::hexagonal)
    throw InputError(
        "views: the paper's kernels are for hexagonal arrays; use barycentric or nearest");
}

/// The samples of all micro-images at one offset.
class Sampler {
 public:
  Sampler(const LightField& field, const Image& flux, const MicroImages& micro, double least)
      : flux_(flux), micro_(micro), window_(field.window), least_(least) {}

  /// @param white of this micro-image; unused without white correction
  /// @param offset [m] from the centre, camera x, y
  float sample(const MicroImages::Place& place, const MicroImages::LocalWhite* white_at,
               Vec2 offset) const {
    constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
    if (place.dark) return unknown;
    const Vec2 at = micro_.camera().image_point(place.centre + offset);
    const double x = at.x - 0.5, y = at.y - 0.5;
    const double x_floor = std::floor(x), y_floor = std::floor(y);
    const int column = static_cast<int>(x_floor) - window_.x,
              row = static_cast<int>(y_floor) - window_.y;
    if (column < 0 || row < 0 || column + 1 >= window_.width || row + 1 >= window_.height)
      return unknown;
    const double a = x - x_floor, b = y - y_floor;
    double light = 0, own = 0, total = 0;
    for (int j = 0; j <= 1; ++j)
      for (int i = 0; i <= 1; ++i) {
        const double weight = (i == 1 ? a : 1 - a) * (j == 1 ? b : 1 - b);
        light += weight * static_cast<double>(flux_.at(column + i, row + j));
        if (white_at == nullptr) continue;
        const MicroImages::White white = (*white_at)(
            micro_.camera().sensor_point(window_.x + column + i + 0.5, window_.y + row + j + 0.5));
        own += weight * white.own;
        total += weight * white.total;
      }
    if (white_at == nullptr) return static_cast<float>(light);
    return own > least_ ? static_cast<float>(light / total) : unknown;
  }

 private:
  const Image& flux_;
  const MicroImages& micro_;
  PixelWindow window_;
  double least_;
};

}  // namespace

Views extract_views(const LightField& light_field, const MicroImages& micro_images,
                    const ViewSettings& settings, const Execution& execution) {
  const Camera& camera = micro_images.camera();
  check(settings, camera);
  const Image& flux = find_channel(light_field, settings.channel).flux;
  const Vec2 p = camera.spec().sensor.pixel();
  const MicroImages::Place axis = micro_images.place(camera.lattice().nearest({0, 0}));
  if (axis.dark) throw InputError("no light reaches the middle of the sensor: there are no views");
  const double least = kLeastWhite * micro_images.white(axis, axis.centre);
  const Sampler sampler(light_field, flux, micro_images, least);
  const TypeLattice lattice(camera, settings.type);
  const OutputGrid grid = output_grid(micro_images, lattice.array, light_field.window);
  const std::vector<LensIndex> lenses = lattice.lenses(camera, grid);
  std::vector<LensIndex> indices;
  for (const LensIndex lens : lenses) indices.push_back(lattice.index(lens));
  std::vector<MicroImages::Place> places;
  places.reserve(lenses.size());
  std::vector<MicroImages::LocalWhite> whites;
  const double farthest = std::sqrt(2.0) * (settings.spread * axis.radius + std::max(p.x, p.y));
  for (const LensIndex lens : lenses) {
    places.push_back(micro_images.place(lens));
    if (settings.white_correction) whites.emplace_back(micro_images, lens, farthest);
  }

  Views views;
  views.lens_step = grid.step;
  views.unit = light_field.unit + (settings.white_correction ? "/(m^2 sr)" : "");
  views.views.resize(static_cast<std::size_t>(settings.grid) *
                     static_cast<std::size_t>(settings.grid));
  const bool done =
      reported_parallel_for(execution, views.views.size(), [&](std::size_t index, int) {
        View& view = views.views[index];
        view.column = static_cast<int>(index) % settings.grid;
        view.row = static_cast<int>(index) / settings.grid;
        const double scale = settings.spread * axis.radius;
        const auto place_of = [&](int i) { return scale * (2 * (i + 0.5) / settings.grid - 1); };
        const Vec2 upright{place_of(view.column), place_of(view.row)};
        view.offset = {(1 / p.x) * upright.x, (1 / p.y) * upright.y};
        LensSamples samples(lattice.array, indices);
        for (std::size_t k = 0; k < lenses.size(); ++k)
          samples.at(indices[k]) =
              sampler.sample(places[k], whites.empty() ? nullptr : &whites[k], -1.0 * upright);
        view.image = resampled(samples, grid, settings.resampling);
      });
  if (!done) throw Cancelled();
  return views;
}

Image epipolar_slice(const Views& views, int line, bool vertical) {
  if (views.views.empty()) return {};
  const View& last = views.views.back();
  const Image& first = views.views.front().image;
  if (line < 0 || line >= (vertical ? first.width : first.height))
    throw InputError("epipolar slice: the views have " + std::to_string(first.width) + " x " +
                     std::to_string(first.height) + " pixels; there is no " +
                     (vertical ? "column " : "row ") + std::to_string(line));
  const int count = (vertical ? last.row : last.column) + 1;
  const int length = vertical ? first.height : first.width;
  Image slice(length, count);
  for (const View& view : views.views) {
    if (vertical ? view.column != last.column / 2 : view.row != last.row / 2) continue;
    for (int k = 0; k < length; ++k)
      slice.at(k, vertical ? view.row : view.column) =
          vertical ? view.image.at(line, k) : view.image.at(k, line);
  }
  return slice;
}

Image contact_sheet(const Views& views) {
  if (views.views.empty()) return {};
  const Image& first = views.views.front().image;
  const View& last = views.views.back();
  const int step_x = first.width + 1, step_y = first.height + 1;
  Image sheet((last.column + 1) * step_x - 1, (last.row + 1) * step_y - 1);
  for (const View& view : views.views)
    for (int row = 0; row < view.image.height; ++row)
      for (int column = 0; column < view.image.width; ++column)
        sheet.at(view.column * step_x + column, view.row * step_y + row) =
            view.image.at(column, row);
  return sheet;
}

}  // namespace plenoflame
