#include "camera/pupil/stop_landing.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "camera/pupil/pupil_tracer.h"
#include "camera/pupil/spread_points.h"
#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

constexpr std::size_t kCrossingRays = 2048;  ///< for the fit of a crossing
constexpr int kMapRays = 160;                ///< for the fit of a map
constexpr int kFewestRays = 60;              ///< that must reach the stop, to fit its 10 numbers
constexpr double kPupilRoom = 1.15;          ///< factor on its radius for the rays of the fit
constexpr double kStopRoom = 1.3, kFarFaceRoom = 1.2;
/// The nearest plane, in focal lengths of the main lens. Nearer planes hardly separate directions.
constexpr double kNearest = 0.2, kFarthest = 20;
constexpr int kInversionSteps = 6;

/// A point of the unit disc from two numbers of the unit interval.
Vec2 of_disc(double share, double turn) {
  const double angle = 2 * constants::pi * turn, radius = std::sqrt(share);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

double dot_terms(const std::array<double, RayCrossing::kTerms>& a,
                 const std::array<double, RayCrossing::kTerms>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

/// The sensor point from which a ray through the aim point crosses the plane at `target`.
Vec2 sensor_point_of(const RayCrossing& crossing, Vec2 aim, Vec2 target) {
  Vec2 s{0, 0};
  for (int i = 0; i < kInversionSteps; ++i) {
    const auto terms = RayCrossing::terms((1 / crossing.unit) * s, (1 / crossing.unit) * aim);
    const double p = dot_terms(crossing.of_sensor, terms), q = dot_terms(crossing.of_aim, terms);
    s = (1 / p) * (crossing.unit * target - q * aim);
  }
  return s;
}

/// Least squares over rays; x and y of each ray are a row each.
class CrossingFit {
 public:
  /// @param unit of sensor and aim points [m] @param limit rays that cross farther out are ignored
  CrossingFit(double unit, double limit) : limit2_(limit * limit) { crossing_.unit = unit; }

  void add(Vec2 sensor, Vec2 aim, Vec2 at) {
    if (!(dot(at, at) < limit2_)) return;
    const Vec2 s = (1 / crossing_.unit) * sensor, u = (1 / crossing_.unit) * aim;
    const auto terms = RayCrossing::terms(s, u);
    for (std::size_t k = 0; k < kTerms; ++k) {
      const auto of_s = static_cast<Eigen::Index>(k), of_u = static_cast<Eigen::Index>(k + kTerms);
      rows_(count_, of_s) = terms[k] * s.x;
      rows_(count_, of_u) = terms[k] * u.x;
      rows_(count_ + 1, of_s) = terms[k] * s.y;
      rows_(count_ + 1, of_u) = terms[k] * u.y;
    }
    values_[count_] = at.x;
    values_[count_ + 1] = at.y;
    count_ += 2;
  }
  RayCrossing solve() {
    const Eigen::MatrixXd used = rows_.topRows(count_);
    const Eigen::VectorXd solution =
        used.completeOrthogonalDecomposition().solve(values_.head(count_));
    for (std::size_t k = 0; k < kTerms; ++k) {
      crossing_.of_sensor[k] = solution[static_cast<Eigen::Index>(k)];
      crossing_.of_aim[k] = solution[static_cast<Eigen::Index>(k + kTerms)];
    }
    return crossing_;
  }

 private:
  static constexpr std::size_t kTerms = RayCrossing::kTerms;
  RayCrossing crossing_;
  double limit2_;
  Eigen::MatrixXd rows_ = Eigen::MatrixXd(2 * kCrossingRays, 2 * kTerms);
  Eigen::VectorXd values_ = Eigen::VectorXd(2 * kCrossingRays);
  Eigen::Index count_ = 0;
};

double stop_radius(const Camera& camera) {
  if (camera.ideal_lens()) return camera.ideal().stop_radius;
  const auto stop = static_cast<std::size_t>(camera.lens_first_order().stop);
  return 0.5 * camera.lens().surfaces()[stop].diameter;
}

}  // namespace

std::array<double, RayCrossing::kTerms> RayCrossing::terms(Vec2 sensor, Vec2 aim) {
  const double ss = dot(sensor, sensor), su = dot(sensor, aim), uu = dot(aim, aim);
  return {1, ss, su, uu, ss * ss, ss * su, ss * uu, su * su, su * uu, uu * uu};
}

Vec2 RayCrossing::at(Vec2 sensor, Vec2 aim) const {
  const Vec2 s = (1 / unit) * sensor, u = (1 / unit) * aim;
  const auto t = terms(s, u);
  return dot_terms(of_sensor, t) * s + dot_terms(of_aim, t) * u;
}

Vec2 StopMap::at(Vec2 c) const {
  return {along[0] + along[1] * c.x + along[2] * c.x * c.x + along[3] * c.y * c.y +
              along[4] * c.x * c.x * c.x + along[5] * c.x * c.y * c.y,
          c.y * (across[0] + across[1] * c.x + across[2] * c.x * c.x + across[3] * c.y * c.y)};
}

StopMap StopMap::mix(const StopMap& a, const StopMap& b, double t) {
  StopMap map;
  if (!a.known() || !b.known()) return map;
  for (std::size_t k = 0; k < map.along.size(); ++k)
    map.along[k] = a.along[k] + t * (b.along[k] - a.along[k]);
  for (std::size_t k = 0; k < map.across.size(); ++k)
    map.across[k] = a.across[k] + t * (b.across[k] - a.across[k]);
  map.reach = std::max(a.reach, b.reach);
  return map;
}

PupilPlane::PupilPlane(const Camera& camera) {
  const FirstOrder& main = camera.lens_first_order();
  const double focal = main.focal_length;
  distance = camera.exit_pupil() - camera.array_front();
  moves_with_lens = std::fabs(distance) > kNearest * focal &&
                    std::fabs(distance) < kFarthest * focal;  // also false for an infinite distance
  radius = 0.5 * main.exit_pupil_diameter;
  if (moves_with_lens) return;
  distance = focal;
  radius = 0.5 * main.entrance_pupil_diameter;
}

RayCrossings fit_crossings(const Camera& camera, int type, double sensor_reach, double field) {
  const PupilPlane plane(camera);
  const double own = 0.5 * camera.spec().array.diameter;
  std::vector<PupilTracer::Request> requests;
  SpreadPoints points;
  for (std::size_t i = 0; i < kCrossingRays; ++i, points.step())
    requests.push_back(
        {sensor_reach * of_disc(points[0], points[1]), own * of_disc(points[2], points[3])});
  PupilTracer open(camera, type, true);
  CrossingFit pupil(own, kPupilRoom + (plane.moves_with_lens ? field / plane.radius : 0.0));
  CrossingFit far_face(own, kFarFaceRoom);
  open.leave_microlens(requests, [&](std::size_t index, bool emerges, const Ray& ray) {
    if (!emerges) return;
    const double way = (plane.distance - ray.origin.z) / ray.direction.z;
    const Vec3 there = ray.at(way);
    const auto& [s, u] = requests[index];
    pupil.add(s, u, (1 / plane.radius) * Vec2{there.x, there.y});
    far_face.add(s, u, (1 / own) * Vec2{ray.origin.x, ray.origin.y});
  });
  return {pupil.solve(), far_face.solve()};
}

StopMap fit_stop_map(const Camera& at_place, double place, const RayCrossing& crossing) {
  const PupilPlane plane(at_place);
  const double radius = stop_radius(at_place);
  const Vec2 middle{plane.moves_with_lens ? -place / plane.radius : 0.0, 0};
  Eigen::Matrix<double, kMapRays, 6> along;
  Eigen::Matrix<double, kMapRays, 4> across;
  Eigen::Matrix<double, kMapRays, 1> x, y;
  Eigen::Index count = 0;
  SpreadPoints points;
  for (int i = 0; i < kMapRays; ++i, points.step()) {
    const Vec2 aim = crossing.unit * of_disc(points[2], points[3]);
    const Vec2 s =
        sensor_point_of(crossing, aim, middle + kPupilRoom * of_disc(points[0], points[1]));
    const auto at = at_place.at_stop({s.x + place, s.y}, LensIndex{}, {aim.x + place, aim.y});
    if (!at || !(length(*at) < kStopRoom * radius)) continue;
    const Vec2 c = crossing.at(s, aim);
    along.row(count) << 1, c.x, c.x * c.x, c.y * c.y, c.x * c.x * c.x, c.x * c.y * c.y;
    across.row(count) << c.y, c.x * c.y, c.x * c.x * c.y, c.y * c.y * c.y;
    x[count] = at->x / radius;
    y[count] = at->y / radius;
    ++count;
  }
  StopMap map;
  if (count < kFewestRays) return map;
  const Eigen::Matrix<double, 6, 1> of_x =
      along.topRows(count).colPivHouseholderQr().solve(x.head(count));
  const Eigen::Matrix<double, 4, 1> of_y =
      across.topRows(count).colPivHouseholderQr().solve(y.head(count));
  for (std::size_t k = 0; k < map.along.size(); ++k)
    map.along[k] = of_x[static_cast<Eigen::Index>(k)];
  for (std::size_t k = 0; k < map.across.size(); ++k)
    map.across[k] = of_y[static_cast<Eigen::Index>(k)];
  map.reach = 1;
  return map;
}

}  // namespace plenoflame
