#pragma once
#include <optional>
#include <vector>

#include "plenoflame/camera/design.h"

namespace plenoflame {

/// Effective resolution ratio along one axis of a point at `array_distance` a [m] in front of the
/// array (negative: behind it). It is the number of image pixels that the micro-images can make up,
/// over pixels of the sensor. A micro-image shows the point smaller by |B / a|, here at most 1. Its
/// blur is s = D |B (1/f - 1/a) - 1|, so that the ratio is
///     min(1, |B / a|) * p / max(s, p, least_spot)
/// Perwass and Wietzke, Proc. SPIE 8291 (2012), 829108. Squared it is the share of the area.
/// @param least_spot [m] of diffraction, 1.22 wavelength * B / D, or 0
double effective_resolution(const TypeDesign& type, double diameter, double pixel,
                            double array_distance, double least_spot = 0);

/// Blur of an axial point's image in one type's micro-images by real rays [m]. It is the diameter
/// of the uniform disc with the same RMS radius about each micro-image's own centroid.
struct TracedBlur {
  double central = 0;  ///< seen by the microlens on the axis
  double all = 0;      ///< RMS over microlenses at zones of equal area of the main lens' pupil
  /// As `all`, each zone's blur over the share min(1, |B / a|) that its micro-images keep: blur in
  /// the main lens' image. Aberrations of the main lens give every zone an a of its own.
  double in_image = 0;
  double growth = 0;  ///< RMS over the zones of one over that share
};

/// effective_resolution() by rays: p / max(in_image, growth * max(p, least_spot)).
/// @return NaN where no light arrives
double traced_resolution(const TracedBlur& blur, double pixel, double least_spot = 0);

/// Traces the blur in the micro-images of one type, as if all microlenses were of that type.
class BlurTracer {
 public:
  BlurTracer(const Camera& camera, std::size_t type);
  /// @param object_distance [m] in front of the first vertex of the main lens, positive; NaN in the
  ///        result where no light arrives
  TracedBlur operator()(double object_distance) const;

 private:
  /// Place on the plane of the array's front, and dx/dz, dy/dz there.
  struct Arriving {
    Vec2 place, slope;
  };
  struct Zone {
    double blur2;  ///< [m^2]
    double kept;
  };
  /// The ray through a point of the entrance pupil.
  std::optional<Arriving> at_array(double object_distance, Vec2 pupil) const;
  std::optional<Zone> zone_blur(double object_distance, double zone) const;
  Camera camera_;
};

/// Effective resolution at one distance.
struct ResolutionPoint {
  double object_distance = 0;                   ///< [m] from the front vertex of the main lens
  double array_distance = 0;                    ///< a [m] of its paraxial image
  std::vector<double> paraxial, traced;         ///< per type; traced: traced_resolution()
  double paraxial_joint = 0, traced_joint = 0;  ///< the best type's
};

/// Resolution over the distances that a type resolves: |a| from B / 4 to 20 B on the sides on which
/// the types are sharp. Steps of the object's distance are equal. Empty without array.
std::vector<ResolutionPoint> resolution_curve(const Camera& camera, int points,
                                              double wavelength = 0);

}  // namespace plenoflame
