#pragma once
#include <string>
#include <vector>

#include "plenoflame/camera/camera.h"

namespace plenoflame {

/// Distances at which a microlens type is sharp to a pixel. In array space: a [m] in front of the
/// type's front principal plane; negative: behind it, which is past infinity. In object space: from
/// the front vertex of the main lens [m]; negative: past infinity (light that converges on a point
/// behind the front vertex).
struct SharpRange {
  double near = 0;   ///< a0-
  double focus = 0;  ///< a0
  double far = 0;    ///< a0+
};

/// Tells whether distances from near to far in array space pass through infinity: from in front of
/// the array to behind it. Ranges of Galilean types lie behind it as a whole and do not.
bool passes_infinity(double near, double far);

/// First-order properties of one microlens type. Perwass and Wietzke, Proc. SPIE 8291 (2012),
/// 829108.
struct TypeDesign {
  std::string name;
  double focal_length = 0;     ///< f [m], thick lens
  double sensor_distance = 0;  ///< B [m]
  double f_number = 0;         ///< B / D
  double image_diameter = 0;   ///< [m] of the exit pupil's image: the micro-image
  bool keplerian = true;       ///< f < B; otherwise Galilean
  double virtual_depth = 0;    ///< a0 / B
  /// [pixels per m] how fast the disparity between neighbouring microlenses, pitch * B / (p a),
  /// changes with the object's distance where the type is sharp.
  double disparity_rate = 0;
  double dioptric_width = 0;  ///< [1/m] 1/a0- - 1/a0+ = 2 p / (D B)
  SharpRange array, object;
  bool object_through_infinity = false;  ///< whether objects at infinity are within `object`
};

/// Image of an object point by real rays in its plane of least RMS radius.
struct SpotDesign {
  double image_height = 0;  ///< [m] paraxial
  double rms = 0;           ///< [m] RMS radius about the centroid
  double shift = 0;         ///< [m] of the plane from the paraxial image towards the lens
};

/// Number of micro-images that fit wholly on the sensor in this arrangement, and the share of the
/// sensor that they cover. They count as discs of their diameter that touch at most.
struct LatticeDesign {
  int lenses = 0;
  double used_share = 0;
};

/// The sub-aperture views, one pixel per microlens, of the object in focus.
struct ViewDesign {
  double across = 0;             ///< views across: pixels in a micro-image's diameter (first type)
  double count = 0;              ///< pixels in its disc: views with different directions
  double columns = 0, rows = 0;  ///< lenses across and down the sensor: pixels of a view
  double object_pixel = 0;       ///< [m] in the plane in focus, from one lens to the next
  /// [view pixels per m] how fast the disparity between views from opposite sides of the pupil
  /// changes with the object's distance.
  double disparity_rate = 0;
};

/// The figures of a camera that are known before an image is rendered.
struct CameraDesign {
  FirstOrder lens;
  double object_distance =
      0;  ///< [m] of the object in focus, from the front vertex; may be infinite
  double array_f_number = 0;  ///< exit pupil to the array (or sensor) / exit pupil's diameter
  std::vector<TypeDesign> types;
  /// All types together: length of the union of their ranges of 1/a, over that of the first type.
  double joint_ratio = 0;
  double covering_depth = 0;  ///< least |v| at which every point is seen through every type
  LatticeDesign hexagonal, square;
  ViewDesign views;
  std::vector<SpotDesign>
      spots;  ///< on the axis, then towards the sensor's corner; real lenses only
  std::vector<std::string> warnings;
};

/// a0-, a0, a0+ of a thin microlens: s = D |B (1/f - 1/a) - 1| is at most a pixel between the ends.
/// All [m]; infinite where the dioptres vanish.
SharpRange depth_of_field(double focal_length, double sensor_distance, double diameter,
                          double pixel_pitch);

/// Distance of the object that is imaged at `image_distance` behind the last vertex [m]: from the
/// first vertex, negative past infinity. Inverse of paraxial_image_distance().
double paraxial_object_distance(const FirstOrder& lens, double image_distance);

/// Least RMS spot of the object point whose paraxial image is at `image_height`. The point is
/// `object_distance` in front of the first vertex (may be infinite).
/// @throws InputError when no ray gets through
/// @param rings of rays in the pupil: 2000 give the RMS radius to 0.1 % also where rays are blocked
SpotDesign best_spot(const std::vector<SurfaceSpec>& surfaces, double object_distance,
                     double image_height, int rings = 2000);

/// The types of first_order_design() alone: cheap enough for an optimiser.
std::vector<TypeDesign> design_types(const Camera& camera);

/// The paraxial figures alone; no rays, no spots. Warnings: f-numbers that do not match.
CameraDesign first_order_design(const Camera& camera);

/// The same with real rays: spots, and warnings where they disagree with the paraxial figures.
CameraDesign design(const Camera& camera);

}  // namespace plenoflame
