#pragma once
#include <string>
#include <vector>

#include "plenoflame/camera/array_solver.h"
#include "plenoflame/camera/camera.h"

namespace plenoflame {

/// Figures by which a camera is judged. All merits are better when greater.
enum class MeritKind {
  /// Depth of field, paraxial: minus the mean of (blur / pixel - 1)^2 over equal steps of 1/a in
  /// `array_range`. Only depths at which no type is sharp to a pixel count, so 0 means that the
  /// types' ranges have no gap.
  depth,
  /// The least effective resolution (one axis, best type) over `near` to `far`.
  resolution,
  /// Resolved pixels along the height of a flame, at its worst depth. This is the effective
  /// resolution times the pixels that the flame's image covers on the sensor.
  volume,
  /// Light per pixel, pi sin^2 of the cone behind the array [sr].
  light,
};

struct MeritSpec {
  MeritKind kind = MeritKind::resolution;
  double array_near = 0,
         array_far = 0;      ///< [m] depth: a0- and a0+ to cover; far < 0: past infinity
  double near = 0, far = 0;  ///< [m] object distances from the first vertex
  double height = 0;         ///< [m] of the flame
  /// Depths from near to far at which it is judged.
  int depths = 7;
};

/// @param traced blur by real rays (BlurTracer) instead of the formulas; `depth` has no traced form
double merit(const Camera& camera, const MeritSpec& spec, bool traced);

/// By how much micro-images are wider than the distance between them, in pixels (the widest type);
/// at most 0 without overlap.
double overlap_pixels(const Camera& camera);

/// A camera with some of its properties changed.
struct CameraChange {
  double pitch = 1;                   ///< factors on pitch and diameter of the microlenses,
  double sensor_distance = 1;         ///< on B,
  double aperture = 1;                ///< on the diameter of the stop,
  double object_distance = 1;         ///< on the distance in focus (or on the lens distance)
  std::vector<double> focal_lengths;  ///< [m] per type; empty: as they are
  MicrolensFreedom freedom = MicrolensFreedom::index;  ///< what makes them so in real lenses
  MicrolensLimits limits;
};

/// @throws InputError when a microlens of such a focal length cannot be made
CameraSpec changed_camera(const CameraSpec& camera, const CameraChange& change);

}  // namespace plenoflame
