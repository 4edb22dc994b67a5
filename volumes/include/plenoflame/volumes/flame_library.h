#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/scene/flame_spec.h"
#include "plenoflame/volumes/flame_file.h"

/// Generated flames as pairs of grids. Flame frame: z up, the axis of a flame is the z axis, its
/// foot is at z = 0. A sample stands at the origin.
///
/// Absorption is 0 outside of the flame. Temperature extends beyond it by at least two voxels, so
/// that interpolation at the flame's border mixes in no ambient temperature. Farther out it is
/// kAmbientTemperature. The same options give the same grids for any number of threads.
namespace plenoflame {

inline constexpr double kAmbientTemperature = 293.15;  ///< [K] background of temperature grids

/// E(m) of soot is published from 0.2 to 0.4; above this it is another substance or a slip.
inline constexpr double kGreatestSootFunction = 1;

/// Absorption coefficient of soot in the Rayleigh limit, kappa = 6 pi E(m) f_v / lambda. Source:
/// Bohren and Huffman, Absorption and Scattering of Light by Small Particles, ch. 5.
/// @param volume_fraction f_v  @param absorption_function E(m) = -Im((m^2 - 1)/(m^2 + 2))
/// @param wavelength [m]  @return [1/m]
double soot_absorption(double volume_fraction, double absorption_function, double wavelength);

/// Homogeneous ellipsoids on a grid. If several overlap, the first one listed counts.
///
/// Every sample gets the mean absorption around it, from exact shares along 64 lines. The mean has
/// the weights of trilinear interpolation, a tent function of one voxel to each side. The integral
/// over space is then right. Chord integrals are right up to smoothing of second order and little
/// aliasing. At 0.25 mm and the default layers their error is 0.1 % RMS; with the values at the
/// voxels' centres it would be 0.9 %. If several layers share a
/// sample, its mean absorption emits the mean emission at its temperature T: sum f_i kappa_i T_i^4
/// = (sum f_i kappa_i) T^4. One error remains, because the product of two interpolated fields is
/// not the interpolated product. This error of emission is of first order, 0.15 % RMS in total and
/// 0.4 % at 650 nm (0.25 mm).
struct LayeredFlameOptions {
  std::vector<EllipsoidSpec> layers;  ///< empty: default_layers()
  double voxel_size = 0.25e-3;        ///< [m]
};
/// Three misaligned ellipsoids, 60 mm high: a stratified flame with a dense luminous zone between a
/// cool core and a hot, thin mantle. Chosen for this project from published soot volume fractions;
/// not the flame of any paper.
std::vector<EllipsoidSpec> default_layers();
/// Reads `[[layers]]` tables (name, centre, semi_axes, temperature, absorption; quantities with
/// units) from a TOML file. @throws FileError, InputError with file, line and column.
std::vector<EllipsoidSpec> read_layers(const std::string& path);
FlameFields make_layered_flame(const LayeredFlameOptions& options, const Execution& execution);

/// Laminar sooting flame: an annulus of soot around a lightly sooting core, closing at the tip,
/// inside of a hot rim. With u = z / height in (0, 1) its formulas are:
///
///   r0(u) = (1 - u) (base_radius + bulge u),  the radius of the annulus
///
///   f0(u) = peak (u/m)^p ((1-u)/(1-m))^q, p = q m/(1-m), m = peak_position
///   f_v   = f0(u) [exp(-((r - r0)/annulus_width)^2) + core_share u^2 exp(-(r/core_width)^2)]
///   T     = T_i + (T_rim - T_i) exp(-((r - r0 - rim_distance)/w)^2)
///
/// T_i is the core temperature (linear in u) and w is inner_width inside of the rim. Outside of it
/// T_i is ambient and w is outer_width. Soot below 1e-6 of the largest is left out.
///
/// Emission lines, if any, are where the flame is blue: in the hot rim, near the base.
///
///   emission = peak exp(-((r - r0 - rim_distance)/line_width)^2 - (u/line_height)^2)
///              (1 - exp(-10 u/line_height)).
///
/// Their place is that of a candle's visible blue base. Their strength does not come from a
/// measurement.
struct SootFlameOptions {
  struct Line {
    std::string name;  ///< of its grid
    double peak;       ///< [W/m^3]
  };
  double voxel_size = 0.25e-3;          ///< [m]
  double height = 65e-3;                ///< [m]
  double base_radius = 5e-3;            ///< [m]
  double bulge = 3e-3;                  ///< [m]
  double annulus_width = 0.9e-3;        ///< [m] 1/e half width
  double core_width = 2e-3;             ///< [m] 1/e half width
  double core_share = 1;                ///< of the annulus' soot that the core reaches at the tip
  double peak_volume_fraction = 8e-6;   ///< f_v of the annulus at its densest
  double peak_position = 0.55;          ///< u of the densest soot, in (0, 1)
  double sharpness = 1;                 ///< q, > 0
  double rim_temperature = 2000;        ///< [K]
  double core_temperature_base = 1450;  ///< [K] on the axis at u = 0
  double core_temperature_tip = 1750;   ///< [K] on the axis at u = 1
  double rim_distance = 1.5e-3;         ///< [m] of the hottest radius outside of the annulus
  double inner_width = 2.5e-3;          ///< [m]
  double outer_width = 2.5e-3;          ///< [m]
  double absorption_function = 0.26;    ///< E(m) of soot; published values are 0.2 to 0.4
  double wavelength = 650e-9;           ///< [m] at which kappa holds
  std::vector<Line> lines = {};
  double line_width = 0.5e-3;  ///< [m] 1/e half width across the rim
  double line_height = 0.3;    ///< u at which emission has fallen to 1/e
};
/// A candle: 32 mm high, soot to 3 ppm, 1500 to 1850 K.
SootFlameOptions candle_flame();
/// A laminar co-flow ethylene diffusion flame of the size of Gulder's burner (fuel tube 10.9 mm).
/// It is 65 mm high, with soot to 8 ppm in the annulus, and 1450 to 2000 K.
SootFlameOptions diffusion_flame();
FlameFields make_soot_flame(const SootFlameOptions& options, const Execution& execution);

/// Grey cylinder of Sun et al., ChinaXiv 201711.00595: T = 273.15 K + 1800 K sin(n (r^2 height/(2
/// radius^2) + z)). The factor n, lost in print, is taken as pi / (1.5 height), which keeps the
/// sine's argument between 0 and pi.
struct CylinderFlameOptions {
  double voxel_size = 2e-3;         ///< [m]
  double radius = 80e-3;            ///< [m]
  double height = 300e-3;           ///< [m]
  double absorption = 8;            ///< [1/m]
  double temperature_swing = 1800;  ///< [K]
};
FlameFields make_cylinder_flame(const CylinderFlameOptions& options, const Execution& execution);

/// A turbulent plume with thin wrinkled sheets on many scales. A mixture fraction xi is Gaussian
/// across a cone and falls with height. It is displaced and modulated by gradient noise in octaves
/// from the plume's width down to smallest_scale. Displacements are proportional to the scale l (an
/// eddy's turnover), fluctuations to l^(1/3) (Obukhov 1949, Corrsin 1951). Temperature peaks at the
/// stoichiometric xi, soot on its rich side, as in flamelets. Not a solution of any flow.
struct TurbulentFlameOptions {
  double voxel_size = 1e-3;        ///< [m]
  double height = 250e-3;          ///< [m]
  double base_radius = 15e-3;      ///< [m] 1/e half width at the foot
  double spread = 0.12;            ///< growth of the half width per height
  double smallest_scale = 3e-3;    ///< [m] of the noise
  double intensity = 1;            ///< of displacement and fluctuation; 0: laminar
  double peak_absorption = 40;     ///< [1/m]
  double peak_temperature = 2000;  ///< [K]
  std::uint64_t seed = 1;
};
FlameFields make_turbulent_flame(const TurbulentFlameOptions& options, const Execution& execution);

}  // namespace plenoflame
