/// White light: what the pixels of a micro-image get from a scene that is bright everywhere.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "lightfield/micro_image_pixels.h"
#include "lightfield/outward_frame.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame {
namespace {

/// Points along the side of a square where white light is traced. Micro-images of few pixels need
/// more, because each pixel on the rim counts.
constexpr int kTraced = 41, kTracedFine = 65;
constexpr double kFewPixels = 20;  ///< along the side of that square
/// Number of pixel angles for which there are tables. They cover the 90 degrees after which a
/// square repeats, or the 180 degrees of a rectangle.
constexpr int kSquareAngles = 5, kRectangleAngles = 9;
double angle_step(int angles) {
  return angles == kSquareAngles ? 0.5 * constants::pi / kSquareAngles
                                 : constants::pi / kRectangleAngles;
}

constexpr double kGoldenAngle = 2.399963229728653;  ///< pi (3 - sqrt 5)

/// Light of a sensor point through one microlens from a scene of radiance 1. It is the integral of
/// gap^2 / d^4 over the part of the aperture whose rays get through the camera.
///
/// This part is convex, because it is the intersection of discs (the microlens' own, the stop's
/// image, rims of the main lens). Its boundary in polar coordinates about a point within it is a
/// function of the angle, found by bisection. The integral over the angle has a periodic integrand
/// and converges fast. Only the boundary needs rays.
class ApertureLight {
 public:
  explicit ApertureLight(const Camera& camera)
      : camera_(camera),
        gap_(camera.aim_plane(0) - camera.sensor()),
        // An oblique ray may cross the aim plane a little beside the lens that it meets.
        reach_(1.03 * camera.aperture().radius()) {}

  /// @param lens centre of the microlens; @param v sensor point relative to it; @param turn angle
  /// at which the directions begin
  double operator()(Vec2 lens, Vec2 v, double turn) const {
    const auto lit = [&](Vec2 u) {
      return camera_.trace(lens + v, LensIndex{0, 0}, lens + u).status.status == RayStatus::reached;
    };
    // A sunflower over the aperture: the middle of its points that are lit is within the lit part.
    // A few points first; more where none of them is lit.
    Vec2 middle;
    int count = 0;
    for (const int points : {kSearch, 4 * kSearch}) {
      for (int k = 0; k < points; ++k) {
        const double radius = reach_ * std::sqrt((k + 0.5) / points);
        const double angle = kGoldenAngle * k + turn;
        const Vec2 u{radius * std::cos(angle), radius * std::sin(angle)};
        if (!lit(u)) continue;
        middle = middle + u;
        ++count;
      }
      if (count > 0) break;
    }
    if (count == 0) return 0;
    middle = (1.0 / count) * middle;
    // Half of the directions do where only the microlens' own rim cuts, the rest comes in between.
    bool own_rim = true;
    const double half = sum_of_directions(lit, middle, v, turn, own_rim);
    const double step = 2 * constants::pi / kDirections;
    if (own_rim) return half * step;
    return 0.5 * step * (half + sum_of_directions(lit, middle, v, turn + 0.5 * step, own_rim));
  }

 private:
  static constexpr int kSearch = 24, kDirections = 12, kBisections = 7, kRimBisections = 5;

  /// @param own_rim set to false when something else than the microlens' rim cuts a direction off
  template <class Lit>
  double sum_of_directions(const Lit& lit, Vec2 middle, Vec2 v, double turn, bool& own_rim) const {
    double total = 0;
    for (int k = 0; k < kDirections; ++k) {
      const double angle = 2 * constants::pi * k / kDirections + turn;
      const Vec2 along{std::cos(angle), std::sin(angle)};
      const double b = dot(middle, along), c = dot(middle, middle);
      const auto to_circle = [&](double radius) {
        return -b + std::sqrt(std::max(0.0, b * b + radius * radius - c));
      };
      // Nothing is lit beyond the outer circle; the rim lies between the two.
      double inside = 0, outside = to_circle(reach_);
      const double before_rim = to_circle(kInner * reach_);
      const bool rim = before_rim > 0 && lit(middle + before_rim * along);
      if (rim) inside = before_rim;
      if (!rim) {
        outside = std::max(before_rim, 0.0);
        own_rim = false;
      }
      for (int i = 0; i < (rim ? kRimBisections : kBisections); ++i) {
        const double half = 0.5 * (inside + outside);
        (lit(middle + half * along) ? inside : outside) = half;
      }
      const double rho = 0.5 * (inside + outside);
      // The integral of r gap^2 / d^4 dr from 0 to rho by Gauss' rule of three points.
      constexpr double kNode = 0.7745966692414834;
      for (int g = -1; g <= 1; ++g) {
        const double r = 0.5 * rho * (1 + g * kNode);
        const Vec2 u = middle + r * along;
        const double d2 = dot(u - v, u - v) + gap_ * gap_;
        total += (g == 0 ? 8.0 : 5.0) / 18 * rho * r * gap_ * gap_ / (d2 * d2);
      }
    }
    return total;
  }

  static constexpr double kInner = 0.94;  ///< of the outer circle: still within the rim
  const Camera& camera_;
  double gap_, reach_;
};

/// Means of a square table, interpolated by Catmull and Rom's cubic and 0 outside, over rectangles
/// around the points of a finer one.
///
/// A mean is a sum over the table with weights that depend on the point's position between the
/// table's points. The points of the finer table have few different positions.
class BoxMeans {
 public:
  /// @param table as seen through a mirror the same (last row first)
  /// @param width points along the side of the finer one
  /// @param side of the rectangles, in steps of the table, and @param samples along it; of both
  /// sides
  BoxMeans(const std::vector<double>& table, int width, Vec2 side, std::array<int, 2> samples)
      : width_(width), side_(side), samples_(samples) {
    const int points = static_cast<int>(std::lround(std::sqrt(table.size())));
    const int common = std::gcd(points - 1, width - 1);
    steps_ = (points - 1) / common;
    period_ = (width - 1) / common;
    // Half the diagonal; of squares 0.71.
    const double reach = side.x == side.y ? 0.71 * side.x : 0.51 * std::hypot(side.x, side.y);
    reach_ = static_cast<int>(std::ceil(reach)) + 3;
    padded_side_ = points + 2 * reach_;
    padded_.assign(static_cast<std::size_t>(padded_side_) * static_cast<std::size_t>(padded_side_),
                   0.0);
    for (int row = 0; row < points; ++row)
      std::copy_n(
          table.begin() + static_cast<std::ptrdiff_t>(row) * points, points,
          padded_.begin() + static_cast<std::ptrdiff_t>(row + reach_) * padded_side_ + reach_);
  }

  /// @param angle of the rectangles' sides [rad]
  std::vector<float> operator()(double angle) const {
    std::vector<float> means(static_cast<std::size_t>(width_) * static_cast<std::size_t>(width_));
    for (int y = 0; y < period_; ++y)
      for (int x = 0; x < period_; ++x) {
        const std::vector<double> weights = weights_at(x, y, angle);
        for (int j = y; j < width_; j += period_)
          for (int i = x; i < width_; i += period_)
            means[static_cast<std::size_t>(j * width_ + i)] =
                static_cast<float>(std::max(0.0, mean(i, j, weights)));
      }
    return means;
  }

  /// The value of operator() for rectangles turned the other way.
  std::vector<float> mirrored(const std::vector<float>& means) const {
    std::vector<float> result(means.size());
    for (std::size_t row = 0; row < means.size(); row += static_cast<std::size_t>(width_))
      std::copy_n(means.begin() + static_cast<std::ptrdiff_t>(row), width_,
                  result.end() - static_cast<std::ptrdiff_t>(row) - width_);
    return result;
  }

 private:
  int stencil() const { return 2 * reach_ + 1; }

  /// Weights of the points around that of the table below the point (x, y) of the finer one.
  std::vector<double> weights_at(int x, int y, double angle) const {
    std::vector<double> weights(
        static_cast<std::size_t>(stencil()) * static_cast<std::size_t>(stencil()), 0.0);
    const auto beyond = [this](int k) {
      return static_cast<double>(k * steps_ % period_) / period_;
    };
    const auto cubic = [](double t) {
      return std::array<double, 4>{0.5 * t * (-1 + t * (2 - t)), 0.5 * (2 + t * t * (-5 + 3 * t)),
                                   0.5 * t * (1 + t * (4 - 3 * t)), 0.5 * t * t * (t - 1)};
    };
    const Vec2 axis{std::cos(angle), std::sin(angle)};
    const auto [across, down] = samples_;
    for (int b = 0; b < down; ++b)
      for (int a = 0; a < across; ++a) {
        const Vec2 o = to_camera(
            {((a + 0.5) / across - 0.5) * side_.x, ((b + 0.5) / down - 0.5) * side_.y}, axis);
        const double at_x = beyond(x) + o.x, at_y = beyond(y) + o.y;
        const double left = std::floor(at_x), above = std::floor(at_y);
        const auto wx = cubic(at_x - left), wy = cubic(at_y - above);
        const int first = (static_cast<int>(above) - 1 + reach_) * stencil() +
                          static_cast<int>(left) - 1 + reach_;
        for (int r = 0; r < 4; ++r)
          for (int c = 0; c < 4; ++c)
            weights[static_cast<std::size_t>(first + r * stencil() + c)] +=
                wx[static_cast<std::size_t>(c)] * wy[static_cast<std::size_t>(r)] / (across * down);
      }
    return weights;
  }

  double mean(int i, int j, const std::vector<double>& weights) const {
    const double* row = padded_.data() +
                        static_cast<std::ptrdiff_t>(j * steps_ / period_) * padded_side_ +
                        i * steps_ / period_;
    const double* weight = weights.data();
    double total = 0;
    for (int r = 0; r < stencil(); ++r, row += padded_side_, weight += stencil())
      for (int c = 0; c < stencil(); ++c) total += weight[c] * row[c];
    return total;
  }

  int width_ = 0;
  Vec2 side_;
  std::array<int, 2> samples_;
  int steps_ = 0, period_ = 0;  ///< a finer step is steps / period of the table's
  int reach_ = 0;               ///< of the weights, in steps of the table
  int padded_side_ = 0;
  std::vector<double> padded_;  ///< the table with that many zeros around it
};

}  // namespace

void MicroImages::fill_white(const Camera& own, Node& node, double outer_radius) const {
  const SensorSpec& sensor = own.spec().sensor;
  const auto [width, height] = sensor.pixel();
  const double p = std::max(width, height);
  const ApertureLight light(own);
  const Vec2 lens = own.lattice().centre({0, 0});
  node.white_half = outer_radius + p;
  node.reach = outer_radius + pixel_disc(sensor);  // the pixel's corner
  const int side = 2 * node.white_half < kFewPixels * p ? kTracedFine : kTraced;
  const double step = 2 * node.white_half / (side - 1);
  std::vector<double> traced(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 0.0);
  for (int j = side / 2; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const Vec2 v{node.centre - node.white_half + i * step, -node.white_half + j * step};
      if (length(v - Vec2{node.centre, 0}) > outer_radius) continue;
      // Turned by another angle at each point of the table, so that what is left of the error
      // averages out over a pixel.
      const double value = width * height * light(lens, v, (j * side + i) * kGoldenAngle);
      traced[static_cast<std::size_t>(j * side + i)] = value;
      traced[static_cast<std::size_t>((side - 1 - j) * side + i)] = value;  // mirror symmetry
    }
  // A pixel is the mean over its rectangle, whose sides run along the sensor's: in the table's axes
  // it is turned. With large pixels before a sharp rim that matters, and there are tables for
  // several angles; otherwise one does.
  const auto boxes = [&](double extent) {
    return static_cast<int>(std::clamp(static_cast<double>(std::lround(extent / step)), 5.0, 12.0));
  };
  const BoxMeans means(traced, kWhiteSide, {width / step, height / step},
                       {boxes(width), boxes(height)});
  const int angles = sensor.square_pixels() ? kSquareAngles : kRectangleAngles;
  const double turn = angle_step(angles);
  for (int angle = 0; angle < angles; ++angle)
    node.white.push_back(
        2 * angle < angles ? means(-angle * turn)
                           : means.mirrored(node.white[static_cast<std::size_t>(angles - angle)]));
  const float largest = *std::max_element(node.white[0].begin(), node.white[0].end());
  float difference = 0;
  for (std::size_t k = 0; k < node.white[0].size(); ++k)
    for (int angle = 1; angle < angles; ++angle)
      difference = std::max(
          difference, std::fabs(node.white[static_cast<std::size_t>(angle)][k] - node.white[0][k]));
  if (difference < 1e-3F * largest) node.white.resize(1);
}

double MicroImages::white(const Place& place, Vec2 sensor_point) const {
  return place.dark ? 0 : WhiteTable(*this, place)(sensor_point);
}

MicroImages::WhiteTable::WhiteTable(const MicroImages& micro_images, const Place& place)
    : centre_(place.centre), outwards_(place.outwards) {
  if (place.dark) return;
  const std::vector<Node>& nodes = micro_images.nodes_[static_cast<std::size_t>(place.type)];
  const auto first = static_cast<std::size_t>(place.node);
  const double t = place.node - static_cast<double>(first);
  const double angle = std::atan2(outwards_.y, outwards_.x);
  for (std::size_t n = 0; n < 2; ++n) {
    const Node& node = nodes[first + n];
    if (node.white.empty()) continue;
    const double weight = n == 0 ? 1 - t : t;
    const auto add = [&](const std::vector<float>& table, double share) {
      parts_[count_++] = {table.data(), weight * share, node.white_half,
                          (kWhiteSide - 1) / (2 * node.white_half)};
    };
    const auto angles = static_cast<int>(node.white.size());
    if (angles == 1) {
      add(node.white[0], 1);
    } else {  // the longest waves of the pixels' period through the values at all angles
      const double turn = angle_step(angles), waves = 2 * constants::pi / (angles * turn);
      for (int k = 0; k < angles; ++k) {
        const double wave = waves * (angle - k * turn);
        double share = 1;
        for (int m = 1; m <= angles / 2; ++m) share += 2 * std::cos(m * wave);
        add(node.white[static_cast<std::size_t>(k)], share / angles);
      }
    }
    reach_ = std::max(reach_, node.reach);
  }
}

double MicroImages::WhiteTable::operator()(Vec2 sensor_point) const {
  const Vec2 v = to_local(sensor_point - centre_, outwards_);
  double total = 0;
  for (std::size_t n = 0; n < count_; ++n) {
    const Part& part = parts_[n];
    const double x = (v.x + part.half) * part.scale, y = (v.y + part.half) * part.scale;
    if (!(x >= 0 && y >= 0 && x < kWhiteSide - 1 && y < kWhiteSide - 1)) continue;
    const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
    const double s = x - static_cast<double>(i), r = y - static_cast<double>(j);
    const float* w = part.table + j * kWhiteSide + i;
    const auto at = [w](std::size_t k) { return static_cast<double>(w[k]); };
    total += part.weight * ((1 - r) * ((1 - s) * at(0) + s * at(1)) +
                            r * ((1 - s) * at(kWhiteSide) + s * at(kWhiteSide + 1)));
  }
  return std::max(total, 0.0);
}

MicroImages::LocalWhite::LocalWhite(const MicroImages& micro_images, LensIndex lens, double radius)
    : own_(micro_images, micro_images.place(lens)), clear_(kInfinity) {
  const MicrolensLattice& lattice = micro_images.camera().lattice();
  const Vec2 middle = lattice.centre(lens);
  const double most = radius + micro_images.reach_ + micro_images.spacing();
  const Vec2 box{most, most};
  for (const LensIndex other : lattice.within(middle - box, middle + box)) {
    if (other == lens) continue;
    const Place place = micro_images.place(other);
    if (place.dark) continue;
    const WhiteTable table(micro_images, place);
    const double clear = length(place.centre - own_.centre()) - table.reach();
    if (clear >= radius) continue;
    clear_ = std::min(clear_, clear);
    others_.push_back(table);
  }
}

MicroImages::White MicroImages::LocalWhite::operator()(Vec2 sensor_point) const {
  White white;
  white.own = white.total = own_(sensor_point);
  const Vec2 v = sensor_point - own_.centre();
  if (clear_ > 0 && dot(v, v) < clear_ * clear_) return white;
  for (const WhiteTable& other : others_) {
    const Vec2 o = sensor_point - other.centre();
    if (dot(o, o) < other.reach() * other.reach()) white.total += other(sensor_point);
  }
  return white;
}

}  // namespace plenoflame
