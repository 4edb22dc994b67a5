#pragma once
#include <array>
#include <optional>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/camera/pupil_cut.h"
#include "plenoflame/camera/stop_landing.h"

namespace plenoflame {

/// The aim points that rays need to get through the camera, for a microlens at some distance from
/// the optical axis. They are derived from traced pupil edges (docs/theory/sampling.md).
///
/// Sensor points s and points u of the aim plane are relative to the microlens' centre. Their first
/// axis points away from the optical axis. A ray (s, u) reaches the scene only inside the discs of
/// the microlens' two apertures (PupilTable) and inside the cut of s. Without array u is relative
/// to the optical axis, and one disc at `aim_centre` bounds it.
struct PupilNode {
  double centre = 0;        ///< of the micro-image, first axis [m]
  double image_radius = 0;  ///< of the micro-image seen from the microlens' middle [m]; 0: dark
  double aim_centre = 0;    ///< without array: centre of the disc, first axis [m]
  double aim_radius = 0;    ///< without array: its radius [m]
  double outer_radius = 0;  ///< no ray that passes has |s - centre| beyond this [m]
  /// Open share of the aperture, integrated over the distance from the centre up to i/16 of
  /// opened_radius [m]. It decides the number of rays of a pixel (OpenShare).
  std::array<double, 17> opened{};
  double opened_radius = 0;  ///< [m]
  PixelCuts cuts;            ///< about `centre`
  StopMap stop;              ///< from the plane of the exit pupil; with array
  /// No ray that reaches the scene crosses the microlens' far face farther from its middle [radii
  /// of the aperture]; 0: not known.
  double far_reach = 0;

  bool dark() const { return image_radius <= 0; }
};

/// Share of a microlens' aperture that pixels of half the side `half` [m] see open.
class OpenShare {
 public:
  OpenShare(const PupilNode& node, double half);
  /// Mean share within `half` of this distance from the micro-image's centre [m].
  double mean(double distance) const;

 private:
  static constexpr double kLast = 16;  ///< of PupilNode::opened
  double up_to(double distance) const;

  const std::array<double, 17>& opened_;
  double half_, steps_per_metre_;
};

/// The two apertures of a microlens as discs of the aim plane, for a sensor point s. The near
/// face's rim is seen along straight lines: |u - near_shift * s| < near_radius holds exactly. The
/// far face's is seen through the near one: |u - far_centre(s)| < radius_at(s).
struct ApertureDiscs {
  double near_radius = 0, near_shift = 0;  ///< [m], none
  double radius = 0, shift = 0;            ///< [m], none
  double growth = 0, bend = 0;             ///< [1/m], [1/m^2]
  double bound = 0;                        ///< of |u|, for all s [m]
  double room = 0;  ///< by which they are wider than those of an aligned camera [m]

  Vec2 far_centre(Vec2 s) const { return (shift + bend * dot(s, s)) * s; }
  double radius_at(Vec2 s) const { return radius + growth * dot(s, s); }
};

/// The area between pairs of parallel sides of a microlens' apertures, in the aim plane. For a
/// sensor point s it is |n . (u - near_shift s)| < near_half and |n . (u - far_centre(s))| <
/// far_half. The shifts are those of the discs bounded by the circumscribed circles. A round
/// aperture has no pairs.
struct ApertureSides {
  int pairs = 0;
  std::array<Vec2, MicrolensAperture::kMostPairs> normals{};
  std::array<double, MicrolensAperture::kMostPairs> near_half{}, far_half{};  ///< [m]
};

/// The table of one microlens type (or of the bare camera) over the field.
class PupilTable {
 public:
  ApertureDiscs discs;  ///< with array; of the circle around apertures with sides
  ApertureSides sides;  ///< with array
  /// With array: where rays cross the plane of the exit pupil, in its radii, and the microlens' far
  /// face, in radii of its aperture.
  RayCrossing at_pupil, at_far_face;
  double field_step = 0;  ///< [m] between nodes
  std::vector<PupilNode> nodes;
  /// Rays that bound the beam, per node, as they leave the camera (camera frame). They belong to a
  /// microlens centre (or sensor point) on the +x axis, without the distortion of the main lens.
  /// They lie at the edge of the open pupil and within it. Zones of a lens focus at different
  /// distances, so rays at the edge need not be the outermost.
  std::vector<std::vector<Ray>> edges;

  /// Linear interpolation; h beyond the table takes the last node.
  PupilNode at(double h) const;
  void look_up(double h, PupilNode& node) const;  ///< the same in place, as it is large
  /// The numbers `centre` and `outer_radius` of that node alone: all light is inside of this disc.
  struct MicroImage {
    double centre, outer_radius;
  };
  MicroImage micro_image(double h) const;
};

/// Tables for all microlens types, or one for the camera without array.
/// Margins cover what the table interpolates: they are measured on nodes between the nodes.
/// @throws InputError when no light at all gets through the camera.
class PupilSampling {
 public:
  explicit PupilSampling(const Camera& camera, const Execution& execution = {});
  const std::vector<PupilTable>& tables() const { return tables_; }
  /// The light that passes between clear microlenses, as of the same camera without them.
  struct Between {
    Camera camera;
    PupilTable table;
  };
  /// Only where the array is not opaque between its lenses.
  const std::optional<Between>& between() const { return between_; }

 private:
  std::vector<PupilTable> tables_;
  std::optional<Between> between_;
};

}  // namespace plenoflame
