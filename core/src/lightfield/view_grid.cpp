#include "lightfield/view_grid.h"

#include <cmath>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"

namespace plenoflame {

OutputGrid output_grid(const MicroImages& micro, const ArraySpec& array,
                       const PixelWindow& window) {
  OutputGrid grid;
  grid.step = array.pitch * (array.lattice == Lattice::hexagonal ? std::pow(0.75, 0.25) : 1.0);
  // The sensor's picture of the array is larger than the array by the micro-images' spacing.
  const double scale = shortest_pitch(micro.camera().spec().array) / micro.spacing();
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

TypeLattice::TypeLattice(const Camera& camera, int of_type)
    : array(camera.spec().array), type(of_type) {
  coarse = type >= 0 && array.lattice == Lattice::hexagonal && array.types.size() == 3;
  if (!coarse) return;
  array.offset = camera.lattice().centre({type, 0});
  array.pitch *= std::sqrt(3.0);
  array.rotation += constants::pi / 6;
  array.columns = array.rows = 0;  // those that are left out are not among the samples
}

LensIndex TypeLattice::index(LensIndex lens) const {
  if (!coarse) return lens;
  const int b = (lens.r - lens.q + type) / 3;
  return {lens.r - 2 * b, b};
}

std::vector<LensIndex> TypeLattice::lenses(const Camera& camera, const OutputGrid& grid) const {
  const double pitch = longest_pitch(array);
  const Vec2 last = grid.first - grid.step * Vec2{grid.width - 1.0, grid.height - 1.0};
  std::vector<LensIndex> lenses =
      camera.lattice().within({last.x - 2 * pitch, last.y - 2 * pitch},
                              {grid.first.x + 2 * pitch, grid.first.y + 2 * pitch});
  if (type >= 0)
    std::erase_if(lenses, [&](LensIndex lens) { return camera.lattice().type(lens) != type; });
  return lenses;
}

Image resampled(const LensSamples& samples, const OutputGrid& grid, ViewResampling resampling) {
  Image image(grid.width, grid.height);
  for (int row = 0; row < grid.height; ++row)
    for (int column = 0; column < grid.width; ++column) {
      const Vec2 point =
          grid.first - grid.step * Vec2{static_cast<double>(column), static_cast<double>(row)};
      const double value = samples.value(point, resampling);
      if (std::isinf(value)) throw InputError("the light field holds a value that is not finite");
      image.at(column, row) = std::isnan(value) ? 0.0F : static_cast<float>(value);
    }
  return image;
}

}  // namespace plenoflame
