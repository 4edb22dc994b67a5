#pragma once
#include <array>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/camera/camera.h"

namespace plenoflame {

/// Where rays must be aimed so that they get through the camera: derived from traced pupil edges.
///
/// For a microlens at distance h from the axis, let s be a sensor point and u a point of the aim
/// plane, both relative to the microlens' centre, with the first axis pointing away from the
/// optical axis, and t = (|u| / aperture_radius)^2. A ray (s, u) can only reach the scene inside
/// both of two discs:
///     |u - aperture_shift * s| < aperture_radius    the microlens' own apertures
///     |s - centre(u)| < radius(u)                   the stop seen through the point u
/// with centre(u) = (centre + centre2 t) first axis - (coupling . (1, t, t^2) - coma u_1) u and
/// radius(u) = radius . (1, t, t^2) + radius_odd t u_1 / aperture_radius: the higher terms are the
/// microlens' spherical aberration and coma (docs/theory.md, "Pupil sampling"). Across the
/// direction of u the stop's image is narrower, by `flattening` . (t, t^2). Without array there is
/// no microlens: u is relative to the optical axis, the first disc is centred at `aim_centre`, and
/// the second has no edge.
struct PupilNode {
  double centre = 0;   ///< [m]
  double centre2 = 0;  ///< [m]
  double coma = 0;     ///< [1/m]
  std::array<double, 3> coupling{};
  std::array<double, 3> radius{};      ///< [m]; radius[0] = 0: no light gets through
  double radius_odd = 0;               ///< [m]
  std::array<double, 2> flattening{};  ///< [m] narrows the choice of rays only, loses none
  double aim_centre = 0;               ///< [m] without array: centre of the first disc, first axis
  double aim_radius = 0;               ///< [m] radius of the first disc
  double outer_radius = 0;             ///< [m] no ray that passes has |s - centre| beyond this

  double open_radius = 0;  ///< [m] within it the whole aperture sees the scene
  /// Share of the aperture that is open at distance i/16 of outer_radius from the centre: decides
  /// how many rays a pixel there is worth.
  std::array<double, 17> open{};

  bool dark() const { return radius[0] <= 0; }
  /// centre(u) and radius(u) as defined above.
  Vec2 centre_at(Vec2 u) const;
  double radius_at(Vec2 u) const;
};

/// The table of one microlens type (or of the bare camera) over the field.
class PupilTable {
 public:
  double aperture_shift = 0;
  double bound_radius = 0;     ///< [m] nothing beyond this distance from the microlens' axis passes
  double aperture_radius = 0;  ///< [m] (nodes hold it as aim_radius too)
  double field_step = 0;       ///< [m] between nodes
  /// Factor on the circle of curvature at which the stop cuts the aperture: 1 for an ideal
  /// microlens, more the more its higher terms bend that cut.
  double cut_margin = 1;
  std::vector<PupilNode> nodes;
  /// Rays at the edge of what gets through, per node, leaving the camera (camera frame), for a
  /// microlens centre (or sensor point) on the +x axis: they bound the beam.
  std::vector<std::vector<Ray>> edges;

  /// Linear interpolation; h beyond the table takes the last node.
  PupilNode at(double h) const;
};

/// Tables for all microlens types, or one for the camera without array.
/// Margins cover what the table interpolates: they are measured on nodes between the nodes.
/// @throws InputError when no light at all gets through the camera.
class PupilSampling {
 public:
  explicit PupilSampling(const Camera& camera, const Execution& execution = {});
  const std::vector<PupilTable>& tables() const { return tables_; }

 private:
  std::vector<PupilTable> tables_;
};

}  // namespace plenoflame
