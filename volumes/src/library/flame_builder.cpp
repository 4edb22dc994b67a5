#include "library/flame_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "field.h"
#include "plenoflame/base/error.h"
#include "plenoflame/volumes/flame_library.h"
#include "plenoflame/volumes/grid_file.h"

namespace plenoflame::detail {
namespace {

constexpr int kTemperatureMargin = 2;  // [voxel] beyond the last sample that absorbs

using BrickIndex = std::array<int, 3>;

int floor_brick(double index) {
  return static_cast<int>(std::floor(index / kBrickSize));
}

/// Values of a function in one brick.
std::vector<float> sample_brick(const std::function<double(Vec3)>& function,
                                const BrickIndex& brick, double voxel) {
  std::vector<float> values(kBrickValues);
  std::size_t v = 0;
  for (int i = 0; i < kBrickSize; ++i)
    for (int j = 0; j < kBrickSize; ++j)
      for (int k = 0; k < kBrickSize; ++k)
        values[v++] = static_cast<float>(
            function({voxel * (brick[0] * kBrickSize + i), voxel * (brick[1] * kBrickSize + j),
                      voxel * (brick[2] * kBrickSize + k)}));
  return values;
}

/// Bricks that hold a sample within kTemperatureMargin of a non-zero sample of this one.
void add_neighbours(const BrickIndex& brick, const std::vector<float>& values,
                    std::set<BrickIndex>& bricks) {
  std::array<int, 3> low{kBrickSize, kBrickSize, kBrickSize}, high{-1, -1, -1};
  for (std::size_t v = 0; v < kBrickValues; ++v) {
    if (values[v] == 0) continue;
    const auto n = static_cast<int>(v);
    const std::array<int, 3> at{n / 64, n / 8 % 8, n % 8};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], at[axis]);
      high[axis] = std::max(high[axis], at[axis]);
    }
  }
  const auto first = [&](std::size_t a) { return low[a] < kTemperatureMargin ? -1 : 0; };
  const auto last = [&](std::size_t a) {
    return high[a] >= kBrickSize - kTemperatureMargin ? 1 : 0;
  };
  for (int i = first(0); i <= last(0); ++i)
    for (int j = first(1); j <= last(1); ++j)
      for (int k = first(2); k <= last(2); ++k)
        bricks.insert({brick[0] + i, brick[1] + j, brick[2] + k});
}

/// Appends those bricks that are kept, in the order of `bricks`.
VoxelField assemble(const std::vector<BrickIndex>& bricks,
                    const std::vector<std::vector<float>>& values, double voxel) {
  VoxelField field;
  field.index_to_world.linear.rows = {{{voxel, 0, 0}, {0, voxel, 0}, {0, 0, voxel}}};
  for (std::size_t b = 0; b < bricks.size(); ++b) {
    if (values[b].empty()) continue;
    field.brick_origins.push_back(
        {bricks[b][0] * kBrickSize, bricks[b][1] * kBrickSize, bricks[b][2] * kBrickSize});
    field.values.insert(field.values.end(), values[b].begin(), values[b].end());
  }
  return field;
}

}  // namespace

FlameFields sample_flame(const FlameFunctions& flame, const Box& bounds, double voxel_size,
                         const Execution& execution) {
  require_between("voxel size", voxel_size, 0, 1e3);
  const Vec3 size = bounds.upper - bounds.lower;
  const double least = std::min({size.x, size.y, size.z});
  if (voxel_size > 0.5 * least)
    throw InputError(
        fmt::format("a voxel size of {:g} mm is too coarse for a flame of {:.3g} x {:.3g} x {:.3g} "
                    "mm; choose at most {:.2g} mm, better a tenth of that",
                    voxel_size * 1e3, size.x * 1e3, size.y * 1e3, size.z * 1e3, 0.5e3 * least));
  // One voxel more on each side: a sample's voxel reaches half a voxel beyond it.
  const auto low = [&](double x) { return x / voxel_size - 1; };
  const auto high = [&](double x) { return x / voxel_size + 1; };
  const double corners[] = {low(bounds.lower.x),  low(bounds.lower.y),  low(bounds.lower.z),
                            high(bounds.upper.x), high(bounds.upper.y), high(bounds.upper.z)};
  double count = 1;
  for (int axis = 0; axis < 3; ++axis)
    count *= (corners[axis + 3] - corners[axis]) / kBrickSize + 1;
  if (!(count < 4.0 * static_cast<double>(kMaxBricks)))
    throw InputError(
        fmt::format("a voxel size of {:g} mm gives {:.3g} million voxels, which is too many; "
                    "choose a larger one",
                    voxel_size * 1e3, count * kBrickValues / 1e6));

  std::vector<BrickIndex> bricks;
  for (int i = floor_brick(corners[0]); i <= floor_brick(corners[3]); ++i)
    for (int j = floor_brick(corners[1]); j <= floor_brick(corners[4]); ++j)
      for (int k = floor_brick(corners[2]); k <= floor_brick(corners[5]); ++k)
        bricks.push_back({i, j, k});
  std::vector<std::vector<float>> values(bricks.size());
  const auto sample = [&](const std::function<double(Vec3)>& function, bool drop_empty) {
    const bool done = parallel_for(execution, bricks.size(), [&](std::size_t b, int) {
      std::vector<float> brick = sample_brick(function, bricks[b], voxel_size);
      const bool empty = std::all_of(brick.begin(), brick.end(), [](float v) { return v == 0; });
      if (!empty || !drop_empty) values[b] = std::move(brick);
    });
    if (!done) throw Cancelled();
  };

  FlameFields fields;
  sample(flame.absorption, true);
  std::set<BrickIndex> hot;
  for (std::size_t b = 0; b < bricks.size(); ++b)
    if (!values[b].empty()) add_neighbours(bricks[b], values[b], hot);
  fields.absorption = assemble(bricks, values, voxel_size);
  fields.absorption.name = "absorption";
  for (const auto& [name, emission] : flame.lines) {
    values.assign(bricks.size(), {});
    sample(emission, true);
    fields.lines.push_back(assemble(bricks, values, voxel_size));
    fields.lines.back().name = name;
  }

  bricks.assign(hot.begin(), hot.end());
  values.assign(bricks.size(), {});
  sample(flame.temperature, false);
  fields.temperature = assemble(bricks, values, voxel_size);
  fields.temperature.name = "temperature";
  fields.temperature.background = static_cast<float>(kAmbientTemperature);
  return fields;
}

void require_between(const char* name, double value, double low, double high) {
  if (!(value > low && value < high))
    throw InputError(fmt::format("{} must be between {:g} and {:g} (SI units), and is {:g}", name,
                                 low, high, value));
}

}  // namespace plenoflame::detail
