#include "plenoflame/lightfield/views.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lightfield/view_resampling.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"

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
    const SensorSpec& sensor = micro_.camera().spec().sensor;
    const Vec2 s = place.centre + offset;
    const double x = 0.5 * sensor.columns - s.x / sensor.pixel_pitch - 0.5;
    const double y = 0.5 * sensor.rows - s.y / sensor.pixel_pitch - 0.5;
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

struct OutputGrid {
  int width = 0, height = 0;
  Vec2 first;       ///< [m] array point of pixel (0, 0)
  double step = 0;  ///< [m]
};

/// Square pixels that cover the window, one of them centred on the array's offset: a square array
/// that is not turned then needs no interpolation.
OutputGrid output_grid(const MicroImages& micro, const ArraySpec& array,
                       const PixelWindow& window) {
  OutputGrid grid;
  grid.step = array.pitch * (array.lattice == Lattice::hexagonal ? std::pow(0.75, 0.25) : 1.0);
  // The sensor's picture of the array is larger than the array by the micro-images' spacing.
  const double scale = micro.camera().spec().array.pitch / micro.spacing();
  const Vec2 upper = micro.camera().sensor_point(window.x, window.y);
  const Vec2 lower = micro.camera().sensor_point(window.x + window.width, window.y + window.height);
  const double right = std::floor((scale * upper.x - array.offset.x) / grid.step + 1e-9);
  const double top = std::floor((scale * upper.y - array.offset.y) / grid.step + 1e-9);
  const double left = std::ceil((scale * lower.x - array.offset.x) / grid.step - 1e-9);
  const double bottom = std::ceil((scale * lower.y - array.offset.y) / grid.step - 1e-9);
  grid.width = static_cast<int>(right - left) + 1;
  grid.height = static_cast<int>(top - bottom) + 1;
  if (grid.width < 1 || grid.height < 1)
    throw InputError(
        "the light field's window is smaller than a micro-image: nothing to make views of");
  grid.first = array.offset + Vec2{right * grid.step, top * grid.step};
  return grid;
}

/// The lattice of the lenses of one type. Of three types in a hexagonal array (type (q - r) mod 3)
/// it is hexagonal again, turned by 30 degrees; otherwise lenses of other types are left out.
struct TypeLattice {
  ArraySpec array;
  bool coarse = false;
  int type = -1;
  TypeLattice(const Camera& camera, int of_type) : array(camera.spec().array), type(of_type) {
    coarse = type >= 0 && array.lattice == Lattice::hexagonal && array.types.size() == 3;
    if (!coarse) return;
    array.offset = camera.lattice().centre({type, 0});
    array.pitch *= std::sqrt(3.0);
    array.rotation += constants::pi / 6;
  }
  /// Its index there; only for lenses of the type.
  LensIndex index(LensIndex lens) const {
    if (!coarse) return lens;
    const int b = (lens.r - lens.q + type) / 3;
    return {lens.r - 2 * b, b};
  }
};

}  // namespace

Views extract_views(const LightField& light_field, const MicroImages& micro_images,
                    const ViewSettings& settings, const Execution& execution) {
  const Camera& camera = micro_images.camera();
  check(settings, camera);
  const Image& flux = find_channel(light_field, settings.channel).flux;
  const double p = camera.spec().sensor.pixel_pitch;
  const MicroImages::Place axis = micro_images.place(camera.lattice().nearest({0, 0}));
  if (axis.dark) throw InputError("no light reaches the middle of the sensor: there are no views");
  const double least = kLeastWhite * micro_images.white(axis, axis.centre);
  const Sampler sampler(light_field, flux, micro_images, least);
  const TypeLattice lattice(camera, settings.type);
  const OutputGrid grid = output_grid(micro_images, lattice.array, light_field.window);
  const double pitch = lattice.array.pitch;
  const Vec2 last = grid.first - grid.step * Vec2{grid.width - 1.0, grid.height - 1.0};
  std::vector<LensIndex> indices;
  auto lenses = camera.lattice().within({last.x - 2 * pitch, last.y - 2 * pitch},
                                        {grid.first.x + 2 * pitch, grid.first.y + 2 * pitch});
  if (settings.type >= 0)
    std::erase_if(lenses,
                  [&](LensIndex lens) { return camera.lattice().type(lens) != settings.type; });
  for (const LensIndex lens : lenses) indices.push_back(lattice.index(lens));
  std::vector<MicroImages::Place> places;
  places.reserve(lenses.size());
  std::vector<MicroImages::LocalWhite> whites;
  const double farthest = std::sqrt(2.0) * (settings.spread * axis.radius + p);
  for (const LensIndex lens : lenses) {
    places.push_back(micro_images.place(lens));
    if (settings.white_correction) whites.emplace_back(micro_images, lens, farthest);
  }

  Views views;
  views.lens_step = grid.step;
  views.unit = settings.white_correction ? "W/(m^2 sr)" : "W";
  views.views.resize(static_cast<std::size_t>(settings.grid) *
                     static_cast<std::size_t>(settings.grid));
  const bool done = parallel_for(execution, views.views.size(), [&](std::size_t index, int) {
    View& view = views.views[index];
    view.column = static_cast<int>(index) % settings.grid;
    view.row = static_cast<int>(index) / settings.grid;
    const double scale = settings.spread * axis.radius;
    const auto place_of = [&](int i) { return scale * (2 * (i + 0.5) / settings.grid - 1); };
    const Vec2 upright{place_of(view.column), place_of(view.row)};
    view.offset = (1 / p) * upright;
    LensSamples samples(lattice.array, indices);
    for (std::size_t k = 0; k < lenses.size(); ++k)
      samples.at(indices[k]) =
          sampler.sample(places[k], whites.empty() ? nullptr : &whites[k], -1.0 * upright);
    view.image = Image(grid.width, grid.height);
    for (int row = 0; row < grid.height; ++row)
      for (int column = 0; column < grid.width; ++column) {
        const Vec2 point =
            grid.first - grid.step * Vec2{static_cast<double>(column), static_cast<double>(row)};
        const double value = samples.value(point, settings.resampling);
        if (std::isinf(value)) throw InputError("the light field holds a value that is not finite");
        view.image.at(column, row) = std::isnan(value) ? 0.0F : static_cast<float>(value);
      }
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
