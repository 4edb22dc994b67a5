#include "picture_camera.h"

#include <vtkCamera.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace plenoflame::views {

std::vector<Vec3> corners(const std::array<double, 6>& b) {
  std::vector<Vec3> out;
  for (const double x : {b[0], b[1]})
    for (const double y : {b[2], b[3]})
      for (const double z : {b[4], b[5]}) out.push_back({x, y, z});
  return out;
}

Vec3 way_to_eye(Subject subject, Vec3 axis, Vec3 right, Vec3 up, const Surroundings& around) {
  const Vec3 left = -right;
  switch (subject) {
    case Subject::array:
      return 0.75 * axis + 0.8 * left + 0.55 * up;
    case Subject::flame:
      // Bodies nearly as the camera sees them, so that they stand side by side.
      return around.bodies ? -0.9 * axis + 0.35 * left + 0.35 * up
                           : -0.55 * axis + 0.8 * left + 0.2 * up;
    case Subject::camera:
      return 0.35 * axis + 1.0 * left + 0.35 * up;
    case Subject::scene:
      break;
  }
  // With walls and floors from the camera's side, so that they do not hide what is before them.
  // Several cameras are looked down on, so that none hides another.
  return (around.surfaces ? -0.35 : 0.35) * axis + 1.0 * left +
         (around.several_cameras ? 0.9 : 0.35) * up;
}

double round_length(double length) {
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  for (const double digit : {5.0, 2.0, 1.0})
    if (digit * power <= length * (1 + 1e-12)) return digit * power;
  return power;
}

void look_at(const std::vector<Vec3>& points, Vec3 direction, Vec3 up, double aspect, double far,
             vtkRenderer& renderer) {
  constexpr double kViewAngle = 24, kMargin = 1.12;
  const Vec3 ahead = normalize(direction), right = normalize(cross(ahead, up)),
             upward = cross(right, ahead);
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const Vec3 p : points) {
    const Vec3 q{dot(p, right), dot(p, upward), dot(p, ahead)};
    low = {std::min(low.x, q.x), std::min(low.y, q.y), std::min(low.z, q.z)};
    high = {std::max(high.x, q.x), std::max(high.y, q.y), std::max(high.z, q.z)};
  }
  const Vec3 middle = 0.5 * (low + high);
  const Vec3 centre = middle.x * right + middle.y * upward + middle.z * ahead;
  const double tangent = std::tan(0.5 * kViewAngle * std::numbers::pi / 180) / kMargin;
  double distance = 0;
  for (const Vec3 p : points) {
    const Vec3 q = p - centre;
    const double across = std::max(std::fabs(dot(q, right)) / aspect, std::fabs(dot(q, upward)));
    distance = std::max(distance, across / tangent - dot(q, ahead));
  }
  const Vec3 eye = centre - distance * ahead;
  vtkCamera* const camera = renderer.GetActiveCamera();
  camera->SetViewAngle(kViewAngle);
  camera->SetFocalPoint(centre.x, centre.y, centre.z);
  camera->SetPosition(eye.x, eye.y, eye.z);
  camera->SetViewUp(upward.x, upward.y, upward.z);
  // The depth buffer has 24 bits: near and far may be no more than some 1e4 apart.
  const double near = 0.02 * distance;
  camera->SetClippingRange(near, std::min(distance + far, 2e4 * near));
}

void keep_below(double share, vtkRenderer& renderer) {
  vtkCamera* const camera = renderer.GetActiveCamera();
  const double degree = std::numbers::pi / 180;
  const double tangent = std::tan(0.5 * camera->GetViewAngle() * degree);
  camera->SetViewAngle(2 * std::atan(tangent / share) / degree);
  camera->SetWindowCenter(0, 1 - share);
}

}  // namespace plenoflame::views
