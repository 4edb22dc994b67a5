#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "plenoflame/base/constants.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/scene/main_lens_spec.h"

/// The microlens array as plain values (scene.h).
namespace plenoflame {

enum class Lattice { square, hexagonal };

/// The open aperture of a microlens. Sides turn with the lattice. Sides of a square are parallel to
/// its rows and columns; sides of a hexagon face the six neighbours of a hexagonal lattice.
enum class ApertureShape { circular, square, hexagonal };

/// One of the interleaved kinds of microlenses.
struct MicrolensSpec {
  std::string name;
  double radius_front = kInfinity;  ///< [m] scene side; > 0: convex
  double radius_back = kInfinity;   ///< [m] sensor side; > 0: convex
  double index = 1.5;
  double focal_length = 0;  ///< [m] model ideal without radii: a thin ideal lens
  std::string glass = {};   ///< as of a surface
  friend bool operator==(const MicrolensSpec&, const MicrolensSpec&) = default;
};

/// From where the distance between array and sensor is measured.
enum class ArrayReference {
  principal_plane,  ///< rear principal plane of the first type: B of the paraxial formulas
  vertex,           ///< rear vertices of the microlenses
};

/// The microlens array. Lens (q, r) is centred at pitch*(q + r/2, r*cos 30) (hexagonal) or
/// (pitch*q, pitch_y*r) (square) in camera x, y, then rotated and moved by `offset`.
struct ArraySpec {
  bool present = false;
  Lattice lattice = Lattice::hexagonal;
  LensModel model = LensModel::real;
  double pitch = 0;           ///< [m] between neighbouring centres
  double pitch_y = 0;         ///< [m] the same along y, lattice square; 0: as the pitch
  int columns = 0, rows = 0;  ///< of microlenses about (0, 0); 0: without end
  ApertureShape aperture = ApertureShape::circular;
  double diameter = 0;               ///< [m] clear, of a polygon across flats; at most the pitch
  double diameter_y = 0;             ///< [m] the same along y, aperture square; 0: as the diameter
  double thickness = 0;              ///< [m] between the vertices
  std::vector<MicrolensSpec> types;  ///< 1 to 3
  bool opaque_between = true;        ///< the area between the lenses: opaque, or clear air
  double rotation = 0;               ///< [rad] about the optical axis, x towards y
  Vec2 offset;                       ///< [m]
  double sensor_distance = 0;        ///< [m] from `measured_from` to the sensor
  ArrayReference measured_from = ArrayReference::principal_plane;
  // Errors of manufacture and mounting.
  double spacing_error =
      0;  ///< [m] by which the sensor is farther from the array than it should be
  /// [m] Every lens except (0, 0), which is at `offset`, is displaced across the axis to a random
  /// point of a disc. This is the disc's radius, at most half the gap between neighbours.
  double centre_jitter = 0;
  /// Every lens except (0, 0) has its radii (an ideal one its focal length) multiplied by its own
  /// factor. Factors are uniform from 1 - focal_jitter to 1 + focal_jitter.
  double focal_jitter = 0;
  std::uint64_t jitter_seed = 1;
  Vec2 tilt;  ///< [rad] about camera x, then y, around the front of the array on the axis
  friend bool operator==(const ArraySpec&, const ArraySpec&) = default;
};

}  // namespace plenoflame
