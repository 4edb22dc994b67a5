#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>

#include "field.h"
#include "openvdb_support.h"
#include "plenoflame/base/available_memory.h"
#include "plenoflame/base/error.h"
#include "plenoflame/volumes/grid_file.h"
#include "plenoflame/volumes/interop.h"

namespace plenoflame {
namespace detail {

AffineTransform affine_of(const openvdb::math::Transform& transform) {
  // OpenVDB multiplies row vectors from the left: its rows are our columns.
  const openvdb::Mat4d m = transform.baseMap()->getAffineMap()->getMat4();
  AffineTransform result;
  for (std::size_t i = 0; i < 3; ++i) {
    const int row = static_cast<int>(i);
    result.linear.rows[i] = {m(0, row), m(1, row), m(2, row)};
  }
  result.translation = {m(3, 0), m(3, 1), m(3, 2)};
  return result;
}

openvdb::math::Transform::Ptr transform_of(const AffineTransform& affine) {
  if (!is_regular(affine)) throw InputError("a grid's transform is singular or not finite");
  openvdb::Mat4d m = openvdb::Mat4d::identity();
  for (int i = 0; i < 3; ++i) {
    const Vec3& row = affine.linear.rows[static_cast<std::size_t>(i)];
    m(0, i) = row.x;
    m(1, i) = row.y;
    m(2, i) = row.z;
  }
  m(3, 0) = affine.translation.x;
  m(3, 1) = affine.translation.y;
  m(3, 2) = affine.translation.z;
  return openvdb::math::Transform::createLinearTransform(m);
}

namespace {

/// Beyond this, index arithmetic in 32 bits is no longer safe.
constexpr int kLargestIndex = 1 << 30;

template <class Value>
float to_float(Value value) {
  return static_cast<float>(value);
}

void check_origin(const openvdb::Coord& origin) {
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(static_cast<std::int64_t>(origin[axis])) > kLargestIndex)
      throw InputError("it has voxels at indices beyond 2^30");
}

/// Number of bricks that a box of whole bricks (edges multiples of 8) holds.
std::uint64_t brick_count(const openvdb::CoordBBox& box) {
  const openvdb::Coord d = box.dim();
  return static_cast<std::uint64_t>(d.x() / kBrickSize) *
         static_cast<std::uint64_t>(d.y() / kBrickSize) *
         static_cast<std::uint64_t>(d.z() / kBrickSize);
}

template <class Tree>
void fill(const Tree& tree, VoxelField& field) {
  field.background = to_float(tree.background());
  // Tiles first: they can be huge, so that their number of bricks is known before any are made.
  std::vector<std::pair<openvdb::CoordBBox, float>> tiles;
  std::uint64_t bricks = tree.leafCount();
  auto tile = tree.cbeginValueAll();
  tile.setMaxDepth(Tree::ValueAllCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    const float value = to_float(*tile);
    if (value == field.background) continue;
    openvdb::CoordBBox box;
    tile.getBoundingBox(box);
    check_origin(box.min());
    check_origin(box.max());
    if (!std::isfinite(value))
      throw InputError(fmt::format("its voxels from {} to {} are {}, which is not a finite number",
                                   to_string({box.min().x(), box.min().y(), box.min().z()}),
                                   to_string({box.max().x(), box.max().y(), box.max().z()}),
                                   value));
    tiles.emplace_back(box, value);
    bricks += brick_count(box);
  }
  if (bricks > kMaxBricks)
    throw InputError(
        fmt::format("it would take {:.3g} million voxels (at most {:.3g} million are possible): "
                    "clip or resample it",
                    static_cast<double>(bricks) * kBrickValues / 1e6,
                    static_cast<double>(kMaxBricks) * kBrickValues / 1e6));

  // Its values, those of a second grid, and what is made of them.
  const double needed = 3.0 * static_cast<double>(bricks) * kBrickValues * sizeof(float);
  require_memory(
      needed,
      fmt::format("its {:.3g} million voxels", static_cast<double>(bricks) * kBrickValues / 1e6),
      "clip or resample it");
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) check_origin(leaf->origin());
  // All is known that could be wrong with it: now it may take memory.
  field.brick_origins.reserve(bricks);
  field.values.reserve(bricks * kBrickValues);
  const auto add_origin = [&](const openvdb::Coord& origin) {
    field.brick_origins.push_back({origin.x(), origin.y(), origin.z()});
  };
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    const auto* data = leaf->buffer().data();
    const bool empty = std::all_of(data, data + kBrickValues,
                                   [&](auto v) { return to_float(v) == field.background; });
    if (empty) continue;
    add_origin(leaf->origin());
    const std::size_t start = field.values.size();
    field.values.resize(start + kBrickValues);
    std::transform(data, data + kBrickValues,
                   field.values.begin() + static_cast<std::ptrdiff_t>(start),
                   [](auto v) { return to_float(v); });
  }
  for (const auto& [box, value] : tiles)
    for (int x = box.min().x(); x <= box.max().x(); x += kBrickSize)
      for (int y = box.min().y(); y <= box.max().y(); y += kBrickSize)
        for (int z = box.min().z(); z <= box.max().z(); z += kBrickSize) {
          add_origin({x, y, z});
          field.values.insert(field.values.end(), kBrickValues, value);
        }
}

template <class Grid>
VoxelField convert(const Grid& grid) {
  VoxelField field;
  field.name = grid.getName();
  if (!grid.transform().isLinear())
    throw InputError("it has a frustum (perspective) transform; resample it to a box of voxels");
  field.index_to_world = affine_of(grid.transform());
  if (!is_regular(field.index_to_world))
    throw InputError("its transform is singular or not finite");
  fill(grid.constTree(), field);
  return field;
}

}  // namespace
}  // namespace detail

openvdb::FloatGrid::Ptr to_openvdb(const VoxelField& field) {
  using Leaf = openvdb::FloatTree::LeafNodeType;
  const auto grid = openvdb::FloatGrid::create(field.background);
  grid->setTransform(detail::transform_of(field.index_to_world));
  grid->setName(field.name);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  for (std::size_t b = 0; b < field.brick_origins.size(); ++b) {
    const auto& origin = field.brick_origins[b];
    auto* leaf = new Leaf(openvdb::Coord(origin[0], origin[1], origin[2]), field.background, false);
    grid->tree().addLeaf(leaf);  // takes ownership
    for (std::size_t v = 0; v < detail::kBrickValues; ++v) {
      const float value = field.values[b * detail::kBrickValues + v];
      if (!(value == field.background)) leaf->setValueOn(static_cast<openvdb::Index>(v), value);
    }
  }
  return grid;
}

VoxelField from_openvdb(const openvdb::FloatGrid& grid) {
  return detail::convert(grid);
}
VoxelField from_openvdb(const openvdb::DoubleGrid& grid) {
  return detail::convert(grid);
}

}  // namespace plenoflame
