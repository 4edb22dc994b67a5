#pragma once
#include "plenoflame/base/execution.h"
#include "plenoflame/image/image.h"
#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame {

/// The regular grid that best fits the centres of the micro-images, for tools that use one pitch
/// and one angle. It has continuous coordinates of the upright image: x to the right, y down, pixel
/// (0, 0) has its centre at (0.5, 0.5).
///
/// Grid indices are those of the upright image: i to the right, j down (hexagonal: down and half a
/// step to the right). Lens (q, r) of the array is grid point (-q, -r), because the readout turns
/// the sensor's image by 180 degrees.
struct MicroImageGrid {
  bool hexagonal = true;
  Vec2 origin;             ///< [pixel] of grid point (0, 0)
  double pitch = 0;        ///< [pixel] between neighbouring centres
  double rotation = 0;     ///< [rad] of the rows, from x towards y: clockwise as one sees it
  double worst = 0;        ///< [pixel] largest distance of a traced centre from its grid point
  double mean_radius = 0;  ///< [pixel] of the micro-images near the axis: of the stop's image

  Vec2 point(int i, int j) const;
};

/// Least squares over all micro-images with their centres in the window.
/// @throws InputError when there are fewer than three
MicroImageGrid fit_grid(const MicroImages& micro_images, const PixelWindow& window);

/// The white image [W]: each pixel's light from a uniform scene of radiance 1 W/(m^2 sr), through
/// all microlenses together.
Image white_image(const MicroImages& micro_images, const PixelWindow& window,
                  const Execution& execution = {});

/// The sub-aperture views as pinhole cameras in a plane, fitted to the chief rays. All look along
/// the optical axis and are sheared so that they agree on one plane. Offsets o are upright, in
/// pixels of the raw image from the micro-images' centres. The view at offset o is at (camera x, y)
/// = o * `centre_step` in the plane z = `plane`. An object point (X, Y, Z) lies in this pixel of
/// its picture:
///
///   x = c + focal X / (Z - plane) - focal centre_step o_x (1 / (Z - plane) - 1 / (focus - plane))
///
/// Here c is the optical axis, and signs are those of an upright picture.
struct ViewGeometry {
  double plane = 0;        ///< [m] z of the pinholes, camera frame: near the entrance pupil
  double focus = 0;        ///< [m] z of the plane on which the views agree; may be infinite
  double focal = 0;        ///< [view pixel] focal length
  double centre_step = 0;  ///< [m] of the viewpoint per raw pixel of offset; positive
  /// [view pixel] Displacement of a point at z between views whose offsets differ by `offset` raw
  /// pixels. Positive for points nearer than `focus`: they move against the viewpoint.
  double disparity(double z, double offset) const;
};

/// @param lens_step [m] on the array between neighbouring pixels of a view (Views::lens_step)
/// @throws InputError when almost no light gets through the camera
ViewGeometry fit_view_geometry(const MicroImages& micro_images, double lens_step);

/// Tells whether the sensor stands in the focal plane of the microlenses (plenoptic 1.0,
/// unfocused), to 5 % of the focal length.
bool is_unfocused(const Camera& camera);

}  // namespace plenoflame
