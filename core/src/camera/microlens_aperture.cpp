#include "plenoflame/camera/microlens_aperture.h"

#include <cmath>

#include "plenoflame/base/constants.h"

namespace plenoflame {

MicrolensAperture::MicrolensAperture(const ArraySpec& array) {
  const double half = 0.5 * array.diameter;
  if (array.aperture == ApertureShape::circular) {
    radius_ = half;
    area_ = constants::pi * half * half;
    return;
  }
  const bool square = array.aperture == ApertureShape::square;
  pairs_ = square ? 2 : 3;
  for (int k = 0; k < pairs_; ++k) {
    const double angle = array.rotation + k * constants::pi / pairs_;
    normals_[static_cast<std::size_t>(k)] = {std::cos(angle), std::sin(angle)};
    half_widths_[static_cast<std::size_t>(k)] = half;
  }
  if (square) {
    if (array.diameter_y > 0) half_widths_[1] = 0.5 * array.diameter_y;
    radius_ = std::hypot(half_widths_[0], half_widths_[1]);
    area_ = 4 * half_widths_[0] * half_widths_[1];
  } else {
    radius_ = half / std::sqrt(0.75);
    area_ = 2 * std::sqrt(3.0) * half * half;
  }
}

bool MicrolensAperture::holds(Vec2 point) const {
  if (pairs_ == 0) return !(length(point) > radius_);
  for (int k = 0; k < pairs_; ++k)
    if (std::fabs(dot(normal(k), point)) > half_width(k)) return false;
  return true;
}

ArraySpec with_circumscribed_circles(ArraySpec array) {
  array.diameter = 2 * MicrolensAperture(array).radius();
  array.diameter_y = 0;
  array.aperture = ApertureShape::circular;
  return array;
}

}  // namespace plenoflame
