#pragma once
#include <QObject>
#include <QString>
#include <memory>
#include <vector>

#include "model/document.h"
#include "model/jobs/latest_task.h"
#include "model/jobs/scene_compiler.h"
#include "plenoflame/render/ray_paths.h"

namespace plenoflame::desktop {

/// The rays of what is selected.
struct SelectedRays {
  Selection selection;
  std::shared_ptr<const CompiledScene> scene;
  RayPaths paths;
  /// Pixels at which rays of a point arrive, or the pixels of a microlens, each once.
  std::vector<Pixel> pixels;
};

/// A line of the table of rays.
struct RayRow {
  int ray = 0;
  int column = -1, row = -1;  ///< pixel that it belongs to; -1: none
  QString status;             ///< "reached", "vignetted at stop", ...
  QString microlens;          ///< "type1 (3, -2)"
  double angle = 0;           ///< [rad] with the optical axis where it leaves the sensor
  double scene_angle = 0;     ///< [rad] where it leaves the front of the camera; NaN: it does not
  double optical_thickness = 0;
  double radiance = 0;  ///< [W/(m^2 sr)] first channel
  double weight = 0;    ///< [m^2 sr]
};
std::vector<RayRow> ray_rows(const SelectedRays& rays);

/// A line of the table of surfaces that one ray meets.
struct RaySurfaceRow {
  QString surface;
  double distance = 0;  ///< [m] along the ray from its start
  double height = 0;    ///< [m] from the optical axis
  double angle = 0;     ///< [rad] with the axis behind the surface; NaN: it ends there
  double index = 1;     ///< behind it, on the ray's way
};
std::vector<RaySurfaceRow> ray_surfaces(const SelectedRays& rays, std::size_t ray);

/// "reached the scene", "vignetted at aperture stop", ...
QString status_text(const RayPaths& paths, const TraceStatus& status);

/// The microlens in whose micro-image a pixel lies. Its ray from the pixel's middle through its own
/// middle comes nearest to the middle of the stop.
LensIndex microlens_of_pixel(const Camera& camera, int column, int row);

/// Description of a place of the world: "1.01 m in front, 3 mm beside, 2 mm above; 1650 K, 8.1
/// 1/m".
QString place_text(const CompiledScene& scene, const Vec3& world);
/// "microlens (3, -2), type1".
QString microlens_text(const CompiledScene& scene, LensIndex lens);

/// Point of a ray of the world at which a viewer sees the flame. This place sends most light per
/// length to the viewer, including absorption on the way. False: the ray meets no flame.
bool flame_point(const Medium& medium, const Ray& ray, Vec3& point);

/// Traces the rays of the document's selection in the background, again when the scene changes.
class RaySelector : public QObject {
  Q_OBJECT
 public:
  static constexpr int kRaysPerPixel = 32;
  static constexpr int kRaysPerPoint = 256;
  static constexpr std::size_t kMostRays = 600;  ///< of a microlens, drawn evenly from all

  RaySelector(Document& document, SceneCompiler& compiler, QObject* parent = nullptr);

  /// Null: nothing is selected, or its rays are not there yet.
  const std::shared_ptr<const SelectedRays>& rays() const { return rays_; }
  /// True when nothing is being traced.
  bool is_current() const { return done_ == newest_; }

 signals:
  void rays_changed();
  void failed(const QString& message);

 private:
  void request();

  Document& document_;
  SceneCompiler& compiler_;
  std::shared_ptr<const SelectedRays> rays_;
  unsigned newest_ = 0, done_ = 0;
  LatestTask task_{Urgency::waited_for};  ///< last: it ends first
};

}  // namespace plenoflame::desktop
