#include "media/field_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdlib>

#include "plenoflame/base/error.h"

namespace plenoflame::voxel {
namespace {

std::uint64_t key(Index b) {
  const auto part = [](int i) { return static_cast<std::uint64_t>(i + kFarthestBrick) & 0x1FFFFF; };
  return part(b[0]) << 42 | part(b[1]) << 21 | part(b[2]);
}

}  // namespace

Index index_of(const VoxelField& field, std::size_t value) {
  const auto& origin = field.brick_origins.at(value / 512);
  const int in = static_cast<int>(value % 512);
  return {origin[0] + in / 64, origin[1] + in / 8 % 8, origin[2] + in % 8};
}

AffineTransform inverse(const AffineTransform& map, const std::string& name) {
  const auto& r = map.linear.rows;
  const Vec3 c0 = cross(r[1], r[2]), c1 = cross(r[2], r[0]), c2 = cross(r[0], r[1]);
  const double determinant = dot(r[0], c0);
  const double size = length(r[0]) * length(r[1]) * length(r[2]);
  // Rotation and scale by row give |determinant| = size; what is below this is rounding.
  if (!(std::fabs(determinant) > 1e-12 * size) || !std::isfinite(determinant) ||
      !std::isfinite(1 / determinant))
    throw InputError("field '" + name +
                     "': its transform is singular; give it three independent axes");
  const double s = 1 / determinant;
  const Mat3 linear = transpose(Mat3{{{s * c0, s * c1, s * c2}}});
  return {linear, -(linear * map.translation)};
}

FieldReader::FieldReader(const VoxelField& field) : field_(&field) {
  const std::size_t count = field.brick_origins.size();
  if (field.values.size() != count * 512)
    throw InputError(fmt::format("field '{}': {} values for {} bricks; it needs 512 per brick",
                                 field.name, field.values.size(), count));
  if (!(field.background >= 0) || !std::isfinite(field.background))
    throw InputError(fmt::format("field '{}': background {} must be finite and not negative",
                                 field.name, field.background));
  inverse(field.index_to_world, field.name);
  bricks_.reserve(count);
  for (std::size_t b = 0; b < count; ++b) {
    const auto& o = field.brick_origins[b];
    Index brick;
    for (int a = 0; a < 3; ++a) {
      if (o[a] % 8 != 0 || std::abs(o[a] / 8) >= kFarthestBrick)
        throw InputError(fmt::format(
            "field '{}': brick origin ({}, {}, {}) must be a multiple of 8 and within +-{}",
            field.name, o[0], o[1], o[2], 8 * kFarthestBrick));
      brick[a] = o[a] / 8;
    }
    if (!bricks_.emplace(key(brick), b).second)
      throw InputError(fmt::format("field '{}': brick ({}, {}, {}) is given twice", field.name,
                                   o[0], o[1], o[2]));
    for (std::size_t v = 0; v < 512; ++v) {
      const float value = field.values[b * 512 + v];
      if (!(value >= 0) || !std::isfinite(value))
        throw InputError(fmt::format(
            "field '{}': value {} at index ({}); values must be finite and not negative",
            field.name, value, fmt::join(index_of(field, b * 512 + v), ", ")));
    }
  }
}

const float* FieldReader::brick(Index brick) const {
  const auto found = bricks_.find(key(brick));
  return found == bricks_.end() ? nullptr : field_->values.data() + found->second * 512;
}

float FieldReader::at(Index sample) const {
  const float* values =
      brick({floor_div(sample[0], 8), floor_div(sample[1], 8), floor_div(sample[2], 8)});
  if (!values) return field_->background;
  return values[((sample[0] & 7) * 8 + (sample[1] & 7)) * 8 + (sample[2] & 7)];
}

}  // namespace plenoflame::voxel
