#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/scene/window_spec.h"

namespace plenoflame {

/// A straight stretch of a ray in air.
struct AirSegment {
  Ray ray;                ///< world; starts at t = 0 with a unit direction
  double far = 0;         ///< [m] where it meets a window, or infinite
  double throughput = 1;  ///< share of its light that passes the windows before it
  int window = -1;        ///< number of the window at `far`; -1: none
};

/// The way of a ray through windows: stretches in air, joined by straight ones in glass.
struct WindowPath {
  std::vector<AirSegment> segments;  ///< from the ray's origin on; one at least
  /// Nothing comes from beyond the last stretch: behind it the ray meets a window's ground rim, or
  /// is reflected totally.
  bool stopped = false;
  Vec3 stop;  ///< [m] world, where
};

/// The windows of a scene, ready to trace; immutable.
class WindowSet {
 public:
  /// @param specs sound as check_windows() has it, with their indices set
  explicit WindowSet(const std::vector<WindowSpec>& specs);
  ~WindowSet();
  WindowSet(const WindowSet&) = delete;
  WindowSet& operator=(const WindowSet&) = delete;

  int size() const;
  double index(int window) const;  ///< refractive

  /// Follows a ray that starts in air, with a unit direction; the path is the same in both
  /// directions. Refraction is exact at every face, in double precision (12 digits). Each wall
  /// transmits exp(-absorption x length) and, where its faces reflect, the share of Fresnel's
  /// formulas. Light that is reflected back and forth within the wall is added to the direct light
  /// (incoherent sum; Born and Wolf, Principles of Optics, 7th ed., 1.5.2).
  void trace(const Ray& from, WindowPath& path) const;

  /// Number of the window in whose glass a point lies; -1: in air.
  int glass_at(Vec3 world) const;

  /// Points in the glass of a window, its faces included (at most 400 across). They are so dense
  /// that no body as thick as the window itself passes between them.
  std::vector<Vec3> points_of(int window) const;
  /// Closed loops that outline a window, for drawings [m] world.
  std::vector<std::vector<Vec3>> outline(int window) const;

 private:
  class Body;
  std::vector<Body> bodies_;
};

/// Share of unpolarised light that passes a wall of glass in air.
/// @param cos_in of the angle with the normal, in air, at both faces
/// @param clear share that absorption transmits on one way through
double wall_transmission(double index, const std::array<double, 2>& cos_in, double clear,
                         bool fresnel);

/// "window 2" or "window "tube"", for messages.
std::string window_name(const std::vector<WindowSpec>& windows, std::size_t index);

}  // namespace plenoflame
