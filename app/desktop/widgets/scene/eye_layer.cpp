#include "widgets/scene/eye_layer.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkImageData.h>
#include <vtkPlaneSource.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkTexture.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace plenoflame::desktop {
namespace {

constexpr int kCoarse = 110;           ///< pixels along the longer side while the view moves
constexpr int kRestsAfter = 120;       ///< [ms]
constexpr double kGlareMargin = 0.05;  ///< around the flames, for their glare
constexpr double kGlareShare = 0.02;   ///< its radius, of the longer side
constexpr double kLeastDepth = 1e-3;   ///< of the distance: how near to the eye corners may be

}  // namespace

EyeLayer::EyeLayer(vtkRenderer& renderer) : renderer_(renderer) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(plane_->GetOutputPort());
  vtkNew<vtkTexture> texture;
  texture->SetInputData(image_);
  texture->InterpolateOn();
  texture->SetColorModeToDirectScalars();
  texture->RepeatOff();  // else the other edge shines through
  texture->EdgeClampOn();
  actor_->SetMapper(mapper);
  actor_->SetTexture(texture);
  actor_->GetProperty()->LightingOff();
  actor_->ForceTranslucentOn();
  actor_->PickableOff();
  actor_->VisibilityOff();
  renderer_.AddActor(actor_);
  rest_.setSingleShot(true);
  connect(&rest_, &QTimer::timeout, this, [this] {
    const unsigned number = newest_;
    task_.request([this, number, flame = flame_, window = window()](std::stop_token stop) {
      Execution execution;
      execution.stop = std::move(stop);
      try {
        const auto light = std::make_shared<const EyeLight>(eye_light(*flame, window, execution));
        post(this, [this, number, light] {
          if (number != newest_ || fine_) return;
          fine_ = true;
          take(light);
          emit changed();
        });
      } catch (const std::exception&) {  // stopped: a newer request follows
      }
    });
  });
}

EyeLayer::~EyeLayer() {
  task_.cancel();
}

void EyeLayer::set_flame(std::shared_ptr<const EyeFlame> flame) {
  if (flame == flame_) return;
  flame_ = std::move(flame);
  light_ = nullptr;
  outdated_ = true;
  rest_.stop();  // nothing is drawn of the one before
  task_.cancel();
  ++newest_;
}

void EyeLayer::set_shift(const Vec3& shift) {
  outdated_ |= shift != shift_;
  shift_ = shift;
}

void EyeLayer::set_look(double exposure, const Box& kept) {
  outdated_ |= kept != kept_;
  kept_ = kept;
  if (exposure == exposure_) return;
  exposure_ = exposure;
  if (light_) develop();
}

/// Behind the eye, their picture would stand close before it, in front of everything.
bool EyeLayer::is_ahead() const {
  vtkCamera& camera = *renderer_.GetActiveCamera();
  const auto vec = [](const double* v) { return Vec3{v[0], v[1], v[2]}; };
  const Vec3 eye = vec(camera.GetPosition()) - shift_,
             ahead = vec(camera.GetDirectionOfProjection());
  const Box box = flame_->box();
  const auto farthest = [](double way, double lower, double upper) {
    return std::max(way * lower, way * upper);
  };
  return farthest(ahead.x, box.lower.x, box.upper.x) + farthest(ahead.y, box.lower.y, box.upper.y) +
             farthest(ahead.z, box.lower.z, box.upper.z) >
         dot(eye, ahead);
}

/// The rectangle around the flames as they are seen, as far as the view shows it.
EyeWindow EyeLayer::window() const {
  vtkCamera& camera = *renderer_.GetActiveCamera();
  const auto vec = [](const double* v) { return Vec3{v[0], v[1], v[2]}; };
  const Vec3 eye = vec(camera.GetPosition()) - shift_;
  const Vec3 ahead = normalize(vec(camera.GetDirectionOfProjection()));
  const Vec3 right = normalize(cross(ahead, vec(camera.GetViewUp())));
  const Vec3 up = cross(right, ahead);
  const Box box = flame_->box();
  const double depth =
      std::max(dot(0.5 * (box.lower + box.upper) - eye, ahead), kLeastDepth * length(eye));
  // The view shows a part of the plane, whose middle may be beside that of the picture.
  const int* const size = renderer_.GetSize();
  const double half = depth * std::tan(0.5 * camera.GetViewAngle() * 3.14159265358979 / 180);
  const double aspect = static_cast<double>(std::max(1, size[0])) / std::max(1, size[1]);
  const double* const middle = camera.GetWindowCenter();
  double left = half * aspect * (middle[0] - 1), top = half * (middle[1] + 1);
  double end = half * aspect * (middle[0] + 1), bottom = half * (middle[1] - 1);
  const double pixel = 2 * half / std::max(1, size[1]);
  double least_x = 1e300, most_x = -1e300, least_y = 1e300, most_y = -1e300;
  bool whole = true;
  for (const double x : {box.lower.x, box.upper.x})
    for (const double y : {box.lower.y, box.upper.y})
      for (const double z : {box.lower.z, box.upper.z}) {
        const Vec3 corner = Vec3{x, y, z} - eye;
        const double away = dot(corner, ahead);
        if (away < kLeastDepth * depth) {
          whole = false;
          continue;
        }
        least_x = std::min(least_x, dot(corner, right) * depth / away);
        most_x = std::max(most_x, dot(corner, right) * depth / away);
        least_y = std::min(least_y, dot(corner, up) * depth / away);
        most_y = std::max(most_y, dot(corner, up) * depth / away);
      }
  if (whole) {
    const double margin = kGlareMargin * std::max(most_x - least_x, most_y - least_y);
    left = std::max(left, least_x - margin);
    end = std::min(end, most_x + margin);
    bottom = std::max(bottom, least_y - margin);
    top = std::min(top, most_y + margin);
  }
  EyeWindow seen;
  seen.kept = kept_;
  seen.eye = eye;
  const double width = std::max(pixel, end - left), height = std::max(pixel, top - bottom);
  seen.corner = eye + depth * ahead + left * right + (bottom + height) * up;
  seen.across = width * right;
  seen.down = -height * up;
  seen.width = std::max(1, static_cast<int>(std::lround(width / pixel)));
  seen.height = std::max(1, static_cast<int>(std::lround(height / pixel)));
  return seen;
}

void EyeLayer::place(const EyeWindow& window) {
  const auto set = [&](const Vec3& at, void (vtkPlaneSource::*point)(double, double, double)) {
    (plane_.GetPointer()->*point)(at.x + shift_.x, at.y + shift_.y, at.z + shift_.z);
  };
  const Vec3 lower = window.corner + window.down;
  set(lower, &vtkPlaneSource::SetOrigin);
  set(lower + window.across, &vtkPlaneSource::SetPoint1);
  set(window.corner, &vtkPlaneSource::SetPoint2);
}

void EyeLayer::take(std::shared_ptr<const EyeLight> light) {
  light_ = std::move(light);
  develop();
}

void EyeLayer::develop() {
  const EyeLight& light = *light_;
  const int glare = static_cast<int>(kGlareShare * std::max(light.width, light.height));
  const auto picture = eye_picture(light, flame_->bright, exposure_, glare);
  image_->SetDimensions(light.width, light.height, 1);
  image_->AllocateScalars(VTK_UNSIGNED_CHAR, 4);
  const auto line = 4 * static_cast<std::size_t>(light.width);
  for (int row = 0; row < light.height; ++row)  // upwards
    std::memcpy(image_->GetScalarPointer(0, light.height - 1 - row, 0),
                picture.data() + line * static_cast<std::size_t>(row), line);
  image_->Modified();
}

void EyeLayer::follow_camera() {
  actor_->SetVisibility(visible_ && has_light() && is_ahead());
  if (!actor_->GetVisibility()) {
    outdated_ = fine_ = true;  // nothing is waited for
    return;
  }
  vtkCamera& camera = *renderer_.GetActiveCamera();
  const int* const size = renderer_.GetSize();
  std::array<double, 14> now{};
  std::copy_n(camera.GetPosition(), 3, now.begin());
  std::copy_n(camera.GetFocalPoint(), 3, now.begin() + 3);
  std::copy_n(camera.GetViewUp(), 3, now.begin() + 6);
  std::copy_n(camera.GetWindowCenter(), 2, now.begin() + 9);
  now[11] = camera.GetViewAngle();
  now[12] = size[0];
  now[13] = size[1];
  const bool moves = now != camera_;
  if (!moves && !outdated_ && (fine_ || !at_once_)) return;
  camera_ = now;
  outdated_ = false;
  ++newest_;
  rest_.stop();
  task_.cancel();
  EyeWindow seen = window();
  place(seen);
  fine_ = at_once_;
  if (!fine_) {
    const double share =
        std::min(1.0, static_cast<double>(kCoarse) / std::max(seen.width, seen.height));
    seen.width = std::max(1, static_cast<int>(share * seen.width));
    seen.height = std::max(1, static_cast<int>(share * seen.height));
    rest_.start(moves ? kRestsAfter : 0);
  }
  take(std::make_shared<const EyeLight>(eye_light(*flame_, seen, {})));
}

}  // namespace plenoflame::desktop
