#pragma once
#include <string>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/scene/time_spec.h"

/// A flame as plain values (scene.h).
namespace plenoflame {

/// The dependence of a flame's absorption on wavelength.
enum class SpectrumKind {
  grey,   ///< not at all
  power,  ///< (reference / wavelength)^exponent
  soot,   ///< 6 pi E(m) f_v / wavelength
  table,  ///< points
};

/// From where the refractive index m of soot comes (radiometry/absorption_spectrum.h).
enum class SootIndexSource { constant, chang, dalzell };

struct SpectrumSpec {
  SpectrumKind kind = SpectrumKind::grey;
  double reference = 650e-9;  ///< [m] at which the flame's absorption holds
  double exponent = 1;        ///< power
  SootIndexSource index = SootIndexSource::constant;
  double absorption_function = 0.26;  ///< E(m) of soot with a constant index
  std::string table = {};             ///< "450 nm 1.4, 650 nm 1": relative absorption
  friend bool operator==(const SpectrumSpec&, const SpectrumSpec&) = default;
};

enum class PhaseFunction {
  henyey_greenstein,  ///< with the asymmetry g
  rayleigh,           ///< 3 (1 + cos^2) / (16 pi)
};

/// Light that a flame scatters into other directions.
struct ScatteringSpec {
  double albedo = 0;  ///< scattering over extinction; 0: none
  PhaseFunction phase = PhaseFunction::henyey_greenstein;
  double asymmetry = 0;   ///< mean cosine, Henyey-Greenstein
  std::string grid = {};  ///< vdb: name of a grid of albedos in the file; empty: the constant
  bool present() const { return albedo > 0 || !grid.empty(); }
  friend bool operator==(const ScatteringSpec&, const ScatteringSpec&) = default;
};

/// One layer of a stratified flame: an ellipsoid with axes along the flame's x, y, z.
struct EllipsoidSpec {
  std::string name;
  Vec3 centre;                 ///< [m] flame frame
  Vec3 semi_axes;              ///< [m]
  double temperature = 0;      ///< [K]
  double absorption = 0;       ///< [1/m]
  double volume_fraction = 0;  ///< of soot, in place of the absorption
  friend bool operator==(const EllipsoidSpec&, const EllipsoidSpec&) = default;
};

/// Scaling of a file's grid to a physical quantity: value = scale * stored + offset, then `unit`.
struct GridSpec {
  std::string grid;       ///< name in the file; empty: the default name and its known aliases
  std::string unit = {};  ///< "K", "degC", "1/m", "1/mm", ...; empty: the file's metadata, else SI
  double scale = 1;
  double offset = 0;
  friend bool operator==(const GridSpec&, const GridSpec&) = default;
};

/// Emission lines and bands of flames (radiometry/emission_line.h).
enum class LineKind {
  custom,  ///< `wavelength`
  ch,
  c2_474,
  c2_517,
  c2_564,
  oh,
  na_d,
};

/// Light that a gas emits at one wavelength whatever its temperature: chemiluminescence, atoms.
struct LineSpec {
  LineKind kind = LineKind::custom;
  double wavelength = 0;  ///< [m] custom: vacuum
  double width = 0;       ///< [m] full, at half the maximum; 0: narrow
  /// The grid of the flame's file that holds it: power per volume.
  GridSpec emission = {};
  friend bool operator==(const LineSpec&, const LineSpec&) = default;
};

enum class FlameKind { layered, vdb };

enum class Interpolation { trilinear, constant };

struct FlameSpec {
  FlameKind kind = FlameKind::layered;
  std::string name;
  Vec3 position;                      ///< [m] world place of the flame frame's origin
  Vec3 rotation;                      ///< [rad] about x, then y, then z of the world
  double scale = 1;                   ///< on all lengths of the flame frame, before it is placed
  std::vector<EllipsoidSpec> layers;  ///< layered: where several overlap, the first listed wins
  std::string file;                   ///< vdb: path as in the scene file, relative to it
  GridSpec temperature;
  GridSpec absorption;
  std::vector<LineSpec> lines = {};  ///< vdb
  SpectrumSpec spectrum = {};
  ScatteringSpec scattering = {};
  Interpolation interpolation = Interpolation::trilinear;
  double brightness = 1;  ///< factor on its light; absorption is unchanged
  FlameTimeSpec time = {};
  friend bool operator==(const FlameSpec&, const FlameSpec&) = default;
};

}  // namespace plenoflame
