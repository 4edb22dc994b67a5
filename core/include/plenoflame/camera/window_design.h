#pragma once
#include "plenoflame/camera/camera.h"
#include "plenoflame/optics/window_set.h"

namespace plenoflame {

/// Effect of windows on the picture of a point on the optical axis, by traced rays near the axis.
struct WindowDesign {
  bool crossed = false;  ///< whether rays between the point and the lens go through the windows
  /// [m] Shift of the focus away from the camera that the windows cause, from rays in the planes of
  /// camera x and y.
  double shift_x = 0, shift_y = 0;
  double displacement = 0;  ///< [m] of it across the axis
  double loss = 0;          ///< share of the light that the windows keep
  double astigmatism() const { return shift_y - shift_x; }
};

/// @param object_distance of the point in focus without windows, from the front vertex [m]; finite
/// @param pupil entrance pupil's radius [m]; its distance in front of the front vertex: pupil_z [m]
WindowDesign window_design(const Camera& camera, const WindowSet& windows, double object_distance,
                           double pupil_radius, double pupil_z);

/// The same with the camera's own plane in focus and paraxial entrance pupil. Not crossed where the
/// camera is focused on infinity.
WindowDesign window_design(const Camera& camera, const WindowSet& windows);

}  // namespace plenoflame
