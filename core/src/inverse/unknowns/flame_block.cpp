#include "plenoflame/inverse/flame_block.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/camera/design.h"
#include "plenoflame/inverse/light_behind.h"

namespace plenoflame {
namespace {

constexpr const char* kNoLight =
    "no light of a picture is above its noise: there is no flame to be found";
/// Standard deviations above which light beside a block, and at the edge of the flame, is no noise.
constexpr double kAboveNoise = 5, kEdge = 4, kNearEdge = 2;
/// Share of the light beyond a side: four sides of several views are less than kLightCut.
constexpr double kCutAway = 0.15 * kLightCut;
/// Approximate number of rows of a view: blocks of pixels grow until there are no more.
constexpr double kRows = 250000;
/// Share of the light's block that is added on each side: emission ends within.
constexpr double kMargin = 0.1;
/// Cosine between lines of sight above which cameras look the same way.
constexpr double kSameWay = 0.94;

/// The points p with dot(normal, p) <= bound.
struct HalfSpace {
  Vec3 normal;
  double bound = 0;
};

Vec3 look_of(const CameraView& view) {
  return normalize(view.scene->scene.camera.look_direction);
}

bool look_the_same_way(const std::vector<CameraView>& views) {
  return std::ranges::all_of(views, [&](const CameraView& view) {
    return std::fabs(dot(look_of(view), look_of(views[0]))) > kSameWay;
  });
}

double object_distance(const CompiledScene& scene) {
  const double distance = first_order_design(scene.camera).object_distance;
  if (!(distance > 0) || !std::isfinite(distance))
    throw InputError(
        "the camera is focused on infinity, which does not tell where the flame is: give the "
        "block's middle");
  return distance;
}

/// The point nearest to all lines of sight.
Vec3 meeting_point(const std::vector<CameraView>& views) {
  const CameraSpec& first = views[0].scene->scene.camera;
  if (look_the_same_way(views))
    return first.position + object_distance(*views[0].scene) * look_of(views[0]);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const CameraView& view : views) {
    const Vec3 look = look_of(view), position = view.scene->scene.camera.position;
    const Eigen::Vector3d w(look.x, look.y, look.z);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - w * w.transpose();
    normal += across;
    right += across * Eigen::Vector3d(position.x, position.y, position.z);
  }
  const Eigen::Vector3d point = normal.ldlt().solve(right);
  return {point[0], point[1], point[2]};
}

/// The place that a row sees, in coordinates of the plane through the middle across the line of
/// sight.
struct LitRow {
  Vec2 at;
  double flux, variance;
};

/// Flux of a row [W] without any flame, of stray light: the mean along that edge of the picture
/// where it is least.
double background(const std::vector<LitRow>& rows) {
  constexpr double kStrip = 0.03;
  constexpr double kFar = std::numeric_limits<double>::max();
  Vec2 lower{kFar, kFar}, upper{-kFar, -kFar};
  for (const LitRow& row : rows) {
    lower = {std::min(lower.x, row.at.x), std::min(lower.y, row.at.y)};
    upper = {std::max(upper.x, row.at.x), std::max(upper.y, row.at.y)};
  }
  const Vec2 strip = kStrip * (upper - lower);
  std::array<double, 4> sums{}, counts{};
  for (const LitRow& row : rows) {
    const std::array<bool, 4> near{row.at.x - lower.x < strip.x, upper.x - row.at.x < strip.x,
                                   row.at.y - lower.y < strip.y, upper.y - row.at.y < strip.y};
    for (std::size_t k = 0; k < near.size(); ++k)
      if (near[k]) sums[k] += row.flux, ++counts[k];
  }
  double least = kFar;
  for (std::size_t k = 0; k < sums.size(); ++k)
    if (counts[k] > 0) least = std::min(least, sums[k] / counts[k]);
  return least;
}

/// The interval of a coordinate that holds the light but for kCutAway on either side.
/// @param above noise, in standard deviations, that the light beyond an edge may be
std::pair<double, double> lit_interval(std::vector<LitRow> rows, double Vec2::*coordinate,
                                       double above) {
  std::ranges::sort(rows, {}, [&](const LitRow& row) { return row.at.*coordinate; });
  double all = 0;
  for (const LitRow& row : rows) all += row.flux;
  const auto edge = [&](auto begin, auto end) {
    double flux = 0, variance = 0;
    for (auto row = begin; row != end; ++row) {
      flux += row->flux;
      variance += row->variance;
      if (flux > kCutAway * all && flux > above * std::sqrt(variance)) return row->at.*coordinate;
    }
    throw InputError(kNoLight);
  };
  return {edge(rows.begin(), rows.end()), edge(rows.rbegin(), rows.rend())};
}

/// The pyramid in which a camera sees its light, and how wide and high that is at the middle.
struct LitPyramid {
  std::array<HalfSpace, 4> sides;
  double width = 0, height = 0;
};

LitPyramid lit_pyramid(const CameraView& view, const Measurement& measurement, Vec3 middle,
                       double reach, int channel, const Execution& execution) {
  const Vec3 around{reach, reach, reach};
  CameraRaySettings how;
  how.samples = 4;
  how.channel = channel;
  how.bin = static_cast<int>(
      std::max(1.0, std::sqrt(static_cast<double>(measurement.flux.pixels.size()) / kRows)));
  CameraView of_window = view;
  of_window.window = measurement.window;
  const CameraRays rays = rays_of_form(OperatorForm::automatic, {of_window},
                                       {middle - around, middle + around}, how, execution);
  const MeasuredRows measured = measured_rows({measurement}, rays, how.bin);
  const CameraSpec& camera = view.scene->scene.camera;
  const Vec3 look = look_of(view), right = normalize(cross(look, camera.up)),
             up = cross(right, look);
  const double distance = dot(middle - camera.position, look);
  std::vector<LitRow> rows;
  RowRays of_rows(rays);
  const RowPieces pieces = pieces_of(rays);
  for (const std::size_t i : pieces.rows) {
    if (!(measured.deviation[i] > 0)) continue;
    Vec2 sum;
    double weight = 0;
    for (const CameraRay& ray : of_rows.of(i)) {
      const double towards = dot(ray.direction, look);
      if (!(towards > 0)) continue;
      const Vec3 at =
          ray.origin + (dot(middle - ray.origin, look) / towards) * ray.direction - camera.position;
      sum = sum + ray.weight * Vec2{dot(at, right), dot(at, up)};
      weight += ray.weight;
    }
    if (weight > 0)
      rows.push_back({(1 / weight) * sum, measured.flux[i], std::pow(measured.deviation[i], 2)});
  }
  const double stray = rows.empty() ? 0 : background(rows);
  for (LitRow& row : rows) row.flux -= stray;
  // Rows far from the flame have noise only, in which its edge would drown.
  const auto wide = [](std::pair<double, double> interval) {
    const double margin = 2 * kMargin * (interval.second - interval.first);
    return std::pair{interval.first - margin, interval.second + margin};
  };
  const auto [first_x, last_x] = wide(lit_interval(rows, &Vec2::x, kEdge));
  const auto [first_y, last_y] = wide(lit_interval(rows, &Vec2::y, kEdge));
  std::erase_if(rows, [&](const LitRow& row) {
    return row.at.x < first_x || row.at.x > last_x || row.at.y < first_y || row.at.y > last_y;
  });
  const auto [left, rightmost] = lit_interval(rows, &Vec2::x, kNearEdge);
  const auto [low, high] = lit_interval(rows, &Vec2::y, kNearEdge);
  if (left >= rightmost || low >= high) throw InputError(kNoLight);
  const auto side = [&](Vec3 across, double at, double sign) {
    const Vec3 normal = sign * (across - (at / distance) * look);
    return HalfSpace{normal, dot(normal, camera.position)};
  };
  return {{side(right, left, -1), side(right, rightmost, 1), side(up, low, -1), side(up, high, 1)},
          rightmost - left,
          high - low};
}

/// How far a box reaches along a direction, from its middle.
double half_extent(const Box& box, Vec3 direction) {
  const Vec3 half = 0.5 * (box.upper - box.lower);
  return std::fabs(direction.x) * half.x + std::fabs(direction.y) * half.y +
         std::fabs(direction.z) * half.z;
}

/// The box around the points that are in all half spaces, by the corners of the body that they are.
Box box_of(const std::vector<HalfSpace>& sides, double tolerance) {
  constexpr double kFar = std::numeric_limits<double>::max();
  Box box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  const auto is_inside = [&](Vec3 point) {
    return std::ranges::all_of(sides, [&](const HalfSpace& side) {
      return dot(side.normal, point) <= side.bound + tolerance * length(side.normal);
    });
  };
  for (std::size_t i = 0; i < sides.size(); ++i)
    for (std::size_t j = i + 1; j < sides.size(); ++j) {
      const Vec3 edge = cross(sides[i].normal, sides[j].normal);
      for (std::size_t k = j + 1; k < sides.size(); ++k) {
        const double volume = dot(edge, sides[k].normal);
        if (std::fabs(volume) < 1e-9) continue;  // normals are of about unit length
        const Vec3 corner =
            (1 / volume) *
            (sides[k].bound * edge + sides[i].bound * cross(sides[j].normal, sides[k].normal) +
             sides[j].bound * cross(sides[k].normal, sides[i].normal));
        if (!is_inside(corner)) continue;
        box.lower = {std::min(box.lower.x, corner.x), std::min(box.lower.y, corner.y),
                     std::min(box.lower.z, corner.z)};
        box.upper = {std::max(box.upper.x, corner.x), std::max(box.upper.y, corner.y),
                     std::max(box.upper.z, corner.z)};
      }
    }
  if (box.empty())
    throw InputError(
        "the cameras see no light in common: their places or the order of the pictures is wrong");
  return box;
}

}  // namespace

std::vector<double> light_outside(const std::vector<CameraView>& views,
                                  const std::vector<Measurement>& measurements,
                                  const CameraRays& rays, int bin) {
  for (const CameraView& view : views)
    if (shines_without_flames(*view.scene)) return {};
  std::vector<Image> outside;
  for (const Measurement& m : measurements) outside.push_back(m.flux);
  for (std::size_t r = 0; r < rays.rows.size(); ++r) {
    const auto v = static_cast<std::size_t>(rays.rows[r].view);
    rays.for_each_pixel(r, bin, [&](int column, int row) {
      outside[v].at(column - measurements[v].window.x, row - measurements[v].window.y) = 0;
    });
  }
  std::vector<double> shares;
  for (std::size_t v = 0; v < measurements.size(); ++v) {
    double all = 0, beside = 0, variance = 0, pixels = 0;
    for (std::size_t k = 0; k < outside[v].pixels.size(); ++k) {
      const double deviation = static_cast<double>(measurements[v].deviation.pixels[k]);
      if (!(deviation > 0)) continue;
      all += static_cast<double>(measurements[v].flux.pixels[k]);
      if (outside[v].pixels[k] == 0) continue;
      beside += static_cast<double>(outside[v].pixels[k]);
      variance += deviation * deviation;
      ++pixels;
    }
    const double error = std::hypot(std::sqrt(variance), pixels * measurements[v].model_error);
    shares.push_back(beside > kAboveNoise * error && all > 0 ? beside / all : 0);
  }
  return shares;
}

Box block_of_light(const std::vector<CameraView>& views,
                   const std::vector<Measurement>& measurements, const Box& known,
                   const Execution& execution, int channel) {
  const Vec3 middle = known.empty() ? meeting_point(views) : 0.5 * (known.lower + known.upper);
  // The corners of the searched cube stay in front of every camera.
  double reach = std::numeric_limits<double>::max();
  for (const CameraView& view : views)
    reach = std::min(reach, 0.5 * length(middle - view.scene->scene.camera.position));
  std::vector<HalfSpace> sides;
  double across = std::numeric_limits<double>::max();
  for (std::size_t v = 0; v < views.size(); ++v) {
    const LitPyramid pyramid =
        lit_pyramid(views[v], measurements[v], middle, reach, channel, execution);
    sides.insert(sides.end(), pyramid.sides.begin(), pyramid.sides.end());
    across = std::min({across, pyramid.width, pyramid.height});
  }
  if (look_the_same_way(views)) {
    const Vec3 look = look_of(views[0]);
    double half = 0.5 * across;
    if (!known.empty()) half = std::max(half, half_extent(known, look));
    sides.push_back({look, dot(look, middle) + half});
    sides.push_back({-look, half - dot(look, middle)});
  }
  // Far away from every side that is meant: the body has corners.
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    sides.push_back({axis, dot(axis, middle) + reach});
    sides.push_back({-axis, reach - dot(axis, middle)});
  }
  const Box tight = box_of(sides, 1e-9 * reach);
  const Vec3 margin = kMargin * (tight.upper - tight.lower);
  return {tight.lower - margin, tight.upper + margin};
}

}  // namespace plenoflame
