#include "model/jobs/lens_job.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "plenoflame/base/error.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/scene/glass_indices.h"

namespace plenoflame::desktop {
namespace {

constexpr int kLensFields = 11;

/// Half the sensor's diagonal as the angle under which the lens takes it in [rad].
double field_of(const CameraSpec& spec, double focal_length) {
  const Vec2 size = spec.sensor.size();
  const double corner = 0.5 * std::hypot(size.x, size.y);
  return focal_length > 0 && corner > 0 ? std::atan(corner / focal_length) : 0;
}

}  // namespace

std::vector<MtfPoint> geometric_mtf(const std::vector<Vec2>& spot, double greatest, int steps) {
  std::vector<MtfPoint> curve;
  for (int i = 0; i <= steps && !spot.empty(); ++i) {
    MtfPoint point;
    point.frequency = greatest * i / steps;
    std::complex<double> along = 0, across = 0;
    for (const Vec2 at : spot) {
      along += std::polar(1.0, -2 * std::numbers::pi * point.frequency * at.x);
      across += std::polar(1.0, -2 * std::numbers::pi * point.frequency * at.y);
    }
    point.tangential = std::abs(along) / static_cast<double>(spot.size());
    point.sagittal = std::abs(across) / static_cast<double>(spot.size());
    curve.push_back(point);
  }
  return curve;
}

LensJob::LensJob(Document& document, QObject* parent) : QObject(parent), document_(document) {
  connect(&document_, &Document::scene_changed, this, [this](const SceneChanges& changes) {
    if (wanted_ && (changes.camera || changes.channels)) request();
  });
}

void LensJob::want() {
  if (wanted_) return;
  wanted_ = true;
  request();
}

void LensJob::request() {
  const unsigned number = ++newest_;
  const auto show = [this, number](std::shared_ptr<const LensDesign> design, QString why) {
    if (number != newest_) return;
    result_ = std::move(design);
    failure_ = std::move(why);
    emit result_changed();
  };
  if (document_.is_empty() || !document_.is_valid()) return task_.cancel();
  if (document_.camera().lens.surfaces.empty())
    return show(nullptr, tr("An ideal lens has no surfaces: its images are points."));
  task_.request([this, show, scene = document_.scene_of_camera().scene](const std::stop_token&) {
    try {
      Scene at_wavelength = scene;
      set_indices(at_wavelength);
      const CameraSpec& spec = at_wavelength.camera;
      const FirstOrder lens = first_order(spec.lens.surfaces);
      const double distance =
          spec.focus.object_distance > 0 ? spec.focus.object_distance : kInfinity;
      auto design = std::make_shared<const LensDesign>(
          design_lens(spec.lens.surfaces, distance, field_of(spec, lens.focal_length), kLensFields,
                      std::numeric_limits<double>::quiet_NaN()));
      post(this, [show, design] { show(design, {}); });
    } catch (const std::exception& error) {
      post(this, [show, why = QString::fromUtf8(error.what())] { show(nullptr, why); });
    }
  });
}

}  // namespace plenoflame::desktop
