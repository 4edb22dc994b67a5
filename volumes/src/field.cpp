#include "field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace plenoflame::detail {

std::array<int, 3> voxel_index(const VoxelField& field, std::size_t brick, std::size_t value) {
  const auto& origin = field.brick_origins[brick];
  const auto v = static_cast<int>(value);
  return {origin[0] + v / 64, origin[1] + v / 8 % 8, origin[2] + v % 8};
}

double determinant(const Mat3& m) {
  return dot(m.rows[0], cross(m.rows[1], m.rows[2]));
}

bool is_regular(const AffineTransform& transform) {
  double scale = 1;  // product of the columns' lengths: the largest that the determinant can be
  const Mat3 columns = transpose(transform.linear);
  for (const Vec3& column : columns.rows) scale *= length(column);
  const Vec3& t = transform.translation;
  return std::isfinite(t.x) && std::isfinite(t.y) && std::isfinite(t.z) && std::isfinite(scale) &&
         std::fabs(determinant(transform.linear)) > 1e-12 * scale;
}

AffineTransform inverse(const AffineTransform& transform) {
  const auto& r = transform.linear.rows;
  const double d = 1.0 / determinant(transform.linear);
  const Mat3 m =
      transpose({{{d * cross(r[1], r[2]), d * cross(r[2], r[0]), d * cross(r[0], r[1])}}});
  return {m, -(m * transform.translation)};
}

std::optional<FieldRange> range(const VoxelField& field) {
  if (field.values.empty()) return std::nullopt;
  const auto [low, high] = std::minmax_element(field.values.begin(), field.values.end());
  return FieldRange{*low, *high};
}

std::uint64_t occupied_voxels(const VoxelField& field) {
  return static_cast<std::uint64_t>(
      std::count_if(field.values.begin(), field.values.end(),
                    [&](float value) { return !(value == field.background); }));
}

std::string to_string(const std::array<int, 3>& index) {
  return fmt::format("({}, {}, {})", index[0], index[1], index[2]);
}

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

}  // namespace plenoflame::detail
