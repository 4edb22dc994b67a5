#include "render/visibility/occupied_region.h"

#include <algorithm>
#include <cmath>

#include "math/box_corners.h"

namespace plenoflame {
namespace {

constexpr double kRounding = 1e-9;  ///< share of a beam's radius
constexpr int kMostParts = 8;       ///< largest number of parts of an oblique beam
constexpr double kSingle = 1e-6;    ///< relative margin for rounding

void include(Vec3 p, Box& box) {
  box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y), std::min(box.lower.z, p.z)};
  box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y), std::max(box.upper.z, p.z)};
}

Box nothing() {
  return {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
}

/// A box that undistorted rays cross if distorted rays cross the given one. Bounds and footprints
/// of beams ignore distortion.
Box undistorted(const Camera& camera, Box box) {
  constexpr double kPupilRoom = 1.5;  // pupils of real lenses move and grow off axis
  const LensDistortion& distortion = camera.distortion();
  const double near = box.lower.z - distortion.pupil(), far = box.upper.z - distortion.pupil();
  if (!(near > 0 && std::isfinite(far))) return {{-kInfinity, -kInfinity, 0}, {0, 0, kInfinity}};
  const double radius = kPupilRoom * 0.5 * camera.lens_first_order().entrance_pupil_diameter;
  const double aside = std::hypot(std::max(std::fabs(box.lower.x), std::fabs(box.upper.x)),
                                  std::max(std::fabs(box.lower.y), std::fabs(box.upper.y)));
  const double slanted = radius * std::max(std::fabs(distortion.per_distance() - 1 / near),
                                           std::fabs(distortion.per_distance() - 1 / far));
  const double room = far * distortion.largest_bend(aside / near + slanted);
  box.lower = box.lower - Vec3{room, room, 0};
  box.upper = box.upper + Vec3{room, room, 0};
  return box;
}

/// Distances from the middle of every cell of a raster to the middle of the nearest marked cell
/// [m]; infinite without marked cells. The algorithm runs along columns, then along rows as the
/// lower envelope of parabolas (P. Felzenszwalb, D. Huttenlocher, "Distance Transforms of Sampled
/// Functions", 2012).
std::vector<double> distances(const std::vector<bool>& marked, int side, Vec2 size) {
  const auto n = static_cast<std::size_t>(side);
  std::vector<double> squares(n * n, kInfinity);
  for (std::size_t column = 0; column < n; ++column) {
    const auto pass = [&](std::size_t first, int step) {
      double rows = kInfinity;
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t i = (step > 0 ? first + k : first - k) * n + column;
        rows = marked[i] ? 0 : rows + 1;
        squares[i] = std::min(squares[i], rows * rows * size.y * size.y);
      }
    };
    pass(0, 1);
    pass(n - 1, -1);
  }
  std::vector<double> from(n), result(n * n);
  std::vector<std::size_t> apex(n);
  for (std::size_t row = 0; row < n; ++row) {
    const double* f = squares.data() + row * n;
    std::size_t count = 0;
    // The place where the parabola of a column falls below the parabola of an earlier one.
    const auto crossing = [&](std::size_t before, std::size_t column) {
      const double a = static_cast<double>(before) * size.x,
                   b = static_cast<double>(column) * size.x;
      return ((f[column] + b * b) - (f[before] + a * a)) / (2 * (b - a));
    };
    for (std::size_t column = 0; column < n; ++column) {
      if (!(f[column] < kInfinity)) continue;
      while (count > 0 && crossing(apex[count - 1], column) <= from[count - 1]) --count;
      from[count] = count > 0 ? crossing(apex[count - 1], column) : -kInfinity;
      apex[count++] = column;
    }
    for (std::size_t column = 0, k = 0; column < n; ++column) {
      const double x = static_cast<double>(column) * size.x;
      while (k + 1 < count && from[k + 1] < x) ++k;
      const double away = count > 0 ? x - static_cast<double>(apex[k]) * size.x : 0;
      result[row * n + column] = count > 0 ? std::sqrt(f[apex[k]] + away * away) : kInfinity;
    }
  }
  return result;
}

}  // namespace

std::optional<std::vector<Box>> occupied_boxes(const CompiledScene& scene) {
  if (!scene.lights.environment.empty()) return std::nullopt;
  if (scene.surfaces && scene.surfaces->has_endless_plane()) return std::nullopt;
  std::vector<Box> boxes;
  if (scene.medium) boxes = scene.medium->occupied();
  if (scene.surfaces) boxes.push_back(scene.surfaces->bounds());
  std::erase_if(boxes, [](const Box& box) { return box.empty(); });
  return boxes;
}

OccupiedRegion::OccupiedRegion(const Camera& camera, const std::vector<Box>& world) {
  // Along the axis of the main lens, which may differ from the camera's axis.
  const RigidTransform to_camera = camera.to_world().inverse(),
                       to_lens = camera.lens_pose().inverse();
  const bool moved = camera.lens_moved();
  std::vector<Box> boxes;
  Box whole = nothing();
  const LensDistortion& distortion = camera.distortion();
  for (const Box& box : world) {
    Box ahead = nothing();
    for (const Vec3 corner : corners(box)) {
      const Vec3 p = to_camera.point(corner);
      include(moved ? to_lens.point(p) : p, ahead);
    }
    if (distortion.present()) ahead = undistorted(camera, ahead);
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
  std::vector<bool> lit(static_cast<std::size_t>(kSide) * kSide, false);
  const auto place = [](double at) { return std::clamp(static_cast<int>(at), 0, kSide - 1); };
  for (const Box& box : boxes) {
    const int column0 = place((box.lower.x - room - lower_.x) * scale_.x);
    const int column1 = place((box.upper.x + room - lower_.x) * scale_.x);
    const int row0 = place((box.lower.y - room - lower_.y) * scale_.y);
    const int row1 = place((box.upper.y + room - lower_.y) * scale_.y);
    for (int row = row0; row <= row1; ++row)
      std::fill_n(lit.begin() + row * kSide + column0, column1 - column0 + 1, true);
  }
  const Vec2 size{1 / scale_.x, 1 / scale_.y};
  // From any point of one cell to any point of another: half a diagonal less at each end.
  const double diagonal = std::hypot(size.x, size.y);
  for (const double d : distances(lit, kSide, size))
    to_lit_.push_back(std::max(0.0, (1 - kSingle) * d - diagonal));
}

bool OccupiedRegion::holds(Vec2 p) const {
  return p.x > lower_.x && p.x < upper_.x && p.y > lower_.y && p.y < upper_.y &&
         !(to_lit_[place_of(p)] > 0);
}

std::size_t OccupiedRegion::place_of(Vec2 p) const {
  const auto place = [](double at) {
    return static_cast<std::size_t>(std::min(std::max(at, 0.0), kSide - 1.0));
  };
  return place((p.y - lower_.y) * scale_.y) * kSide + place((p.x - lower_.x) * scale_.x);
}

/// Tells whether a disc contains nothing.
bool OccupiedRegion::is_beyond(Vec2 centre, double radius) const {
  // For a centre outside of the raster, all lit cells are behind the nearest point of the border.
  const Vec2 nearest{std::clamp(centre.x, lower_.x, upper_.x),
                     std::clamp(centre.y, lower_.y, upper_.y)};
  const Vec2 out = centre - nearest;
  const double in = to_lit_[place_of(nearest)];
  return dot(out, out) + in * in > radius * radius * (1 + kRounding);
}

bool OccupiedRegion::meets(const Vec2 centre[2], double radius) const {
  if (!bounded_ || !(radius < kInfinity)) return true;
  const Vec2 axis = centre[1] - centre[0];
  const double along = std::sqrt(dot(axis, axis));
  int parts = 1;
  if (along > 0.5 * radius)
    parts = 0.5 * radius * kMostParts > along ? static_cast<int>(std::ceil(2 * along / radius))
                                              : kMostParts;
  for (int part = 0; part < parts; ++part)
    if (!is_beyond(centre[0] + ((part + 0.5) / parts) * axis, radius + 0.5 * along / parts))
      return true;
  return false;
}

}  // namespace plenoflame
