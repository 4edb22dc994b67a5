#include "widgets/scene/lens_detail.h"

#include <vtkCamera.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "array_geometry.h"
#include "camera_mesh.h"
#include "widgets/scene/scene_geometry.h"

namespace plenoflame::desktop {
namespace {

constexpr double kMostSeen = 1200;     ///< microlenses
constexpr double kLeastPitch = 6;      ///< [screen pixel]
constexpr double kMarginOfView = 0.3;  ///< on each side, of the part in view
constexpr double kLargest = 8;         ///< of a part, in areas of a new one: else it is coarse
constexpr double kNear = 3.5;          ///< pitches on each side of a pixel
constexpr double kFaces = 1e5;         ///< of all microlenses together
constexpr int kLeastSectors = 8, kMostSectors = 28;

/// The part of a polygon on the inner side of a plane.
std::vector<Vec3> cut(const std::vector<Vec3>& polygon, const double* plane) {
  std::vector<Vec3> part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double from = dot(vec(plane), a) + plane[3], to = dot(vec(plane), b) + plane[3];
    if (from >= 0) part.push_back(a);
    if ((from < 0) != (to < 0)) part.push_back(a + from / (from - to) * (b - a));
  }
  return part;
}

/// The rectangle around points of the world.
ArrayPart around(const std::vector<Vec3>& points, const Camera& camera) {
  const RigidTransform to_camera = camera.to_world().inverse();
  ArrayPart part{{1e300, 1e300}, {-1e300, -1e300}};
  for (const Vec3& point : points) {
    const Vec3 p = to_camera.point(point);
    part.lower = {std::min(part.lower.x, p.x), std::min(part.lower.y, p.y)};
    part.upper = {std::max(part.upper.x, p.x), std::max(part.upper.y, p.y)};
  }
  return part;
}

}  // namespace

bool ArrayPart::suits(const ArrayPart& in_view, const Camera& camera) const {
  if (empty() || in_view.empty()) return empty() && in_view.empty();
  return has(in_view.lower) && has(in_view.upper) &&
         area() <= kLargest * with_margin(in_view, camera).area();
}

Vec3 array_shift(const Camera& camera, const Schematic& drawing) {
  const Vec3 middle = camera.to_world().point({0, 0, camera.array_front()});
  return drawing.place(middle) - middle;
}

ArrayPart whole_array(const Camera& camera) {
  return around(array_plate(camera).points, camera);
}

ArrayPart large_lenses(const Camera& camera, const Schematic& drawing, vtkRenderer& renderer) {
  const Vec3 shift = array_shift(camera, drawing);
  std::vector<Vec3> seen = array_plate(camera).points;
  for (Vec3& corner : seen) corner = corner + shift;
  vtkCamera& eye = *renderer.GetActiveCamera();
  std::array<double, 24> planes{};
  eye.GetFrustumPlanes(renderer.GetTiledAspectRatio(), planes.data());
  for (std::size_t k = 0; k < planes.size(); k += 4) seen = cut(seen, &planes[k]);
  if (seen.empty()) return {};
  Vec3 middle;
  for (Vec3& point : seen) {
    middle = middle + 1 / static_cast<double>(seen.size()) * point;
    point = point - shift;
  }
  const double depth = dot(middle - vec(eye.GetPosition()), vec(eye.GetDirectionOfProjection()));
  const double height = 2 * depth * std::tan(eye.GetViewAngle() * std::numbers::pi / 360);
  const double pitch = shortest_pitch(camera.spec().array);
  const ArrayPart part = around(seen, camera);
  const bool large = pitch / height * renderer.GetSize()[1] >= kLeastPitch;
  return large && part.area() / (pitch * pitch) <= kMostSeen ? part : ArrayPart();
}

ArrayPart with_margin(const ArrayPart& part, const Camera& camera) {
  const ArrayPart whole = whole_array(camera);
  const double pitch = longest_pitch(camera.spec().array);
  const Vec2 margin = kMarginOfView * (part.upper - part.lower) + Vec2{pitch, pitch};
  return {{std::max(part.lower.x - margin.x, whole.lower.x - pitch),
           std::max(part.lower.y - margin.y, whole.lower.y - pitch)},
          {std::min(part.upper.x + margin.x, whole.upper.x + pitch),
           std::min(part.upper.y + margin.y, whole.upper.y + pitch)}};
}

ArrayPart lenses_near(const Camera& camera, const std::array<double, 2>& pixel) {
  const Vec2 middle = camera.sensor_point(pixel[0], pixel[1]);
  const double reach = kNear * longest_pitch(camera.spec().array);
  return {middle - Vec2{reach, reach}, middle + Vec2{reach, reach}};
}

vtkSmartPointer<vtkPolyData> lenses_of(const Camera& camera, const ArrayPart& part) {
  const std::vector<LensIndex> lenses = camera.lattice().within(part.lower, part.upper);
  const double each = kFaces / std::max<double>(1, static_cast<double>(lenses.size()));
  const int sectors = std::clamp(static_cast<int>(std::sqrt(each)), kLeastSectors, kMostSectors);
  return pipeline::polydata_of(microlens_surfaces(camera, lenses, {sectors, sectors / 4}));
}

}  // namespace plenoflame::desktop
