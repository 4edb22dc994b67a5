#include "render/lit_region.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace plenoflame {
namespace {

constexpr double kRounding = 1e-9;  ///< of the raster's extent: rays are moved to world axes
constexpr int kMostParts = 8;       ///< that an oblique beam is looked at in

std::array<Vec3, 8> corners(const Box& box) {
  std::array<Vec3, 8> points;
  for (std::size_t i = 0; i < 8; ++i)
    points[i] = {(i & 1) ? box.upper.x : box.lower.x, (i & 2) ? box.upper.y : box.lower.y,
                 (i & 4) ? box.upper.z : box.lower.z};
  return points;
}

void include(Vec3 p, Box& box) {
  box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y), std::min(box.lower.z, p.z)};
  box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y), std::max(box.upper.z, p.z)};
}

Box nothing() {
  return {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
}

}  // namespace

std::optional<std::vector<Box>> lit_boxes(const CompiledScene& scene) {
  if (!scene.lights.environment.empty()) return std::nullopt;
  if (scene.surfaces && scene.surfaces->has_endless_plane()) return std::nullopt;
  std::vector<Box> boxes;
  if (scene.medium) boxes = scene.medium->occupied();
  if (scene.surfaces) boxes.push_back(scene.surfaces->bounds());
  std::erase_if(boxes, [](const Box& box) { return box.empty(); });
  return boxes;
}

LitRegion::LitRegion(const Camera& camera, const std::vector<Box>& world) {
  // Along the axis of the main lens, where that is not the camera's.
  const RigidTransform to_camera = camera.to_world().inverse(),
                       to_lens = camera.lens_pose().inverse();
  const bool moved = camera.lens_moved();
  std::vector<Box> boxes;
  Box whole = nothing();
  for (const Box& box : world) {
    Box ahead = nothing();
    for (const Vec3 corner : corners(box)) {
      const Vec3 p = to_camera.point(corner);
      include(moved ? to_lens.point(p) : p, ahead);
    }
    include(ahead.lower, whole);
    include(ahead.upper, whole);
    boxes.push_back(ahead);
  }
  bounded_ = !boxes.empty() && whole.lower.z > 0 && std::isfinite(whole.upper.z) &&
             std::isfinite(whole.upper.x - whole.lower.x) &&
             std::isfinite(whole.upper.y - whole.lower.y);
  if (!bounded_) return;
  planes_[0] = whole.lower.z;
  planes_[1] = whole.upper.z;
  const double room =
      kRounding * (length(whole.upper) + length(whole.lower)) + 1e-300;  // a box may be flat
  lower_ = {whole.lower.x - room, whole.lower.y - room};
  upper_ = {whole.upper.x + room, whole.upper.y + room};
  scale_ = {kSide / (upper_.x - lower_.x), kSide / (upper_.y - lower_.y)};
  std::vector<char> lit(static_cast<std::size_t>(kSide) * kSide, 0);
  const auto place = [](double at) { return std::clamp(static_cast<int>(at), 0, kSide - 1); };
  for (const Box& box : boxes) {
    const int column0 = place((box.lower.x - room - lower_.x) * scale_.x);
    const int column1 = place((box.upper.x + room - lower_.x) * scale_.x);
    const int row0 = place((box.lower.y - room - lower_.y) * scale_.y);
    const int row1 = place((box.upper.y + room - lower_.y) * scale_.y);
    for (int row = row0; row <= row1; ++row)
      std::fill_n(lit.begin() + row * kSide + column0, column1 - column0 + 1, 1);
  }
  constexpr int kStride = kSide + 1;
  sums_.assign(static_cast<std::size_t>(kStride) * kStride, 0);
  const auto at = [&](int column, int row) -> int& {
    return sums_[static_cast<std::size_t>(row * kStride + column)];
  };
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column)
      at(column + 1, row + 1) = at(column, row + 1) + at(column + 1, row) - at(column, row) +
                                lit[static_cast<std::size_t>(row * kSide + column)];
}

int LitRegion::count(int column0, int row0, int column1, int row1) const {
  constexpr int kStride = kSide + 1;
  const auto at = [&](int column, int row) {
    return sums_[static_cast<std::size_t>(row * kStride + column)];
  };
  return at(column1 + 1, row1 + 1) - at(column0, row1 + 1) - at(column1 + 1, row0) +
         at(column0, row0);
}

bool LitRegion::meets(const Vec2 centre[2], double radius) const {
  if (!bounded_ || !(radius < kInfinity)) return true;
  const Vec2 axis = centre[1] - centre[0];
  const double along = std::max(std::fabs(axis.x), std::fabs(axis.y));
  int parts = 1;
  if (along > 2 * radius)
    parts = radius * kMostParts > along ? static_cast<int>(std::ceil(along / radius)) : kMostParts;
  for (int part = 0; part < parts; ++part) {
    const Vec2 a = centre[0] + (static_cast<double>(part) / parts) * axis;
    const Vec2 b = centre[0] + (static_cast<double>(part + 1) / parts) * axis;
    const double x0 = (std::min(a.x, b.x) - radius - lower_.x) * scale_.x;
    const double x1 = (std::max(a.x, b.x) + radius - lower_.x) * scale_.x;
    const double y0 = (std::min(a.y, b.y) - radius - lower_.y) * scale_.y;
    const double y1 = (std::max(a.y, b.y) + radius - lower_.y) * scale_.y;
    if (x1 < 0 || y1 < 0 || x0 >= kSide || y0 >= kSide) continue;
    const auto place = [](double at) {
      return static_cast<int>(std::min(std::max(at, 0.0), kSide - 1.0));
    };
    if (count(place(x0), place(y0), place(x1), place(y1)) > 0) return true;
  }
  return false;
}

}  // namespace plenoflame
