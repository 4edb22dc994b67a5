#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "plenoflame/math/vector.h"

/// The scene as plain values, SI units, as a file states it. Nothing here computes; validation and
/// reading live in scene_file.h, the compiled forms in camera/ and media/.
namespace plenoflame {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Whether an element refracts at its real surfaces or by its paraxial transform.
enum class LensModel {
  real,   ///< exact refraction at every surface
  ideal,  ///< the paraxial transform between the principal planes: no aberrations
};

/// One surface of the main lens. Surfaces are listed from the scene to the sensor.
struct SurfaceSpec {
  double radius = kInfinity;  ///< [m] > 0: centre of curvature on the sensor's side; inf: plane
  double thickness = 0;       ///< [m] to the vertex of the next surface
  double index = 1;           ///< refractive index behind the surface (towards the sensor)
  double diameter = 0;        ///< [m] clear diameter
  bool stop = false;          ///< the aperture stop (exactly one surface)
  /// What differs from a sphere: sag = c h^2 / (1 + sqrt(1 - (1 + conic) c^2 h^2)) + aspheric[i]
  /// h^(4 + 2 i), towards the sensor.
  double conic = 0;
  std::vector<double> aspheric = {};  ///< [1/m^3, 1/m^5, ...] from h^4 on, at most 7
  /// optics/glass.h; empty: `index` as it is. Otherwise set_indices() has put the index there.
  std::string glass = {};
  friend bool operator==(const SurfaceSpec&, const SurfaceSpec&) = default;
};

/// The main lens: either surfaces, or (model ideal only) focal length and diameter alone.
struct MainLensSpec {
  LensModel model = LensModel::real;
  std::vector<SurfaceSpec> surfaces;
  double focal_length = 0;  ///< [m] used when there are no surfaces: a thin ideal lens at z = 0
  double diameter = 0;      ///< [m] its stop, at the lens
  // What mounting adds; array, sensor and the camera's position stay where they are.
  Vec2 decentre;  ///< [m] camera x, y: by which the lens is moved across the axis
  Vec2 tilt;      ///< [rad] about camera x, then y, around its front vertex
  friend bool operator==(const MainLensSpec&, const MainLensSpec&) = default;
};

enum class Lattice { square, hexagonal };

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
/// pitch*(q, r) (square) in camera x, y, then rotated and moved by `offset`.
struct ArraySpec {
  bool present = false;
  Lattice lattice = Lattice::hexagonal;
  LensModel model = LensModel::real;
  double pitch = 0;                  ///< [m] between neighbouring centres
  double diameter = 0;               ///< [m] clear diameter of a microlens, at most the pitch
  double thickness = 0;              ///< [m] between the vertices
  std::vector<MicrolensSpec> types;  ///< 1 to 3
  bool opaque_between = true;        ///< the area between the lenses: opaque, or clear air
  double rotation = 0;               ///< [rad] about the optical axis, x towards y
  Vec2 offset;                       ///< [m]
  double sensor_distance = 0;        ///< [m] from `measured_from` to the sensor
  ArrayReference measured_from = ArrayReference::principal_plane;
  // What manufacture and mounting add.
  double spacing_error =
      0;  ///< [m] by which the sensor is farther from the array than it should be
  /// [m] every lens but (0, 0), whose place is `offset`, is displaced across the axis to a random
  /// point of a disc of this radius, at most half the gap between neighbours.
  double centre_jitter = 0;
  /// Every lens but (0, 0) has radii (or an ideal one its focal length) by a factor of its own,
  /// drawn evenly from 1 - focal_jitter to 1 + focal_jitter.
  double focal_jitter = 0;
  std::uint64_t jitter_seed = 1;
  Vec2 tilt;  ///< [rad] about camera x, then y, around the front of the array on the axis
  friend bool operator==(const ArraySpec&, const ArraySpec&) = default;
};

/// Colour filters over the pixels: the first letters are those of the top left pixels. R, G and B
/// are the scene's first three channels.
enum class MosaicPattern { none, rggb, bggr, grbg, gbrg };

struct SensorSpec {
  int columns = 0;
  int rows = 0;
  double pixel_pitch = 0;  ///< [m] square pixels
  // What turns light into numbers (lightfield/sensor.h); nothing here changes what is rendered.
  MosaicPattern mosaic = MosaicPattern::none;
  double exposure_time = 0;       ///< [s]; 0: until the brightest pixels are nearly full
  double quantum_efficiency = 1;  ///< electrons per photon
  double fill_factor = 1;         ///< share of a pixel that is sensitive
  double full_well = 20000;       ///< electrons that a pixel holds; what is more is lost
  double read_noise = 0;          ///< RMS electrons
  double dark_current = 0;        ///< electrons per second
  double gain = 0;         ///< electrons per digital number; 0: the full well fills the range
  int bits = 14;           ///< of the converter
  double black_level = 0;  ///< digital number of no light
  bool shot_noise = true;
  double hot_pixels = 0;         ///< share of pixels with hot_current instead of the dark current
  double hot_current = 0;        ///< electrons per second
  double dead_pixels = 0;        ///< share of pixels that see nothing
  std::uint64_t noise_seed = 1;  ///< of noise and defects
  friend bool operator==(const SensorSpec&, const SensorSpec&) = default;
};

/// How the distance between main lens and array (or sensor) is found.
enum class FocusMode {
  distance,  ///< given by lens_distance
  paraxial,  ///< object_distance is imaged paraxially on the conjugate plane
  best,      ///< least RMS spot of real rays from the axial point at object_distance
};

struct FocusSpec {
  FocusMode mode = FocusMode::paraxial;
  double lens_distance = 0;    ///< [m] mode distance: rear vertex of the main lens to the front
                               ///< vertices of the microlenses, or to the sensor without array
  double object_distance = 0;  ///< [m] from the front vertex of the main lens
  /// What is conjugate to the object: "array" (plenoptic 1.0: the front principal plane of the
  /// first type), the name of a microlens type (2.0: the plane on which that type is sharp), or
  /// "sensor" (only without array).
  std::string conjugate = "array";
  friend bool operator==(const FocusSpec&, const FocusSpec&) = default;
};

/// What is lost of the light on its way through the camera.
struct TransmissionSpec {
  bool fresnel = false;  ///< reflection at every real surface
  /// A single layer of this index on the main lens' surfaces that border on air, a quarter of the
  /// wavelength thick; 0: uncoated.
  double coating_index = 0;
  double coating_wavelength = 550e-9;  ///< [m]
  double cover_index = 1;              ///< of the sensor's cover glass, a plane plate; 1: none
  std::string filter = {};             ///< "400 nm 0.9, 700 nm 0.8"; empty: none
  friend bool operator==(const TransmissionSpec&, const TransmissionSpec&) = default;
};

struct CameraSpec {
  Vec3 position;                 ///< [m] world, of the front vertex of the main lens
  Vec3 look_direction{1, 0, 0};  ///< world
  Vec3 up{0, 0, 1};              ///< world; camera y (down) is the part of -up across the axis
  MainLensSpec lens;
  ArraySpec array;
  SensorSpec sensor;
  FocusSpec focus;
  TransmissionSpec transmission = {};
  /// [m] of the light that it is traced for, where that matters: the coating. 0: the coating's. Not
  /// in files; compile() sets it.
  double wavelength = 0;
  friend bool operator==(const CameraSpec&, const CameraSpec&) = default;
};

/// How a flame's absorption depends on wavelength.
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

/// How much of the light that a flame takes out of a ray goes on in another direction.
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

/// How a grid of a file becomes a physical quantity: value = scale * stored + offset, then `unit`.
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
  /// What a grid of the flame's file says of it: power per volume.
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
  friend bool operator==(const FlameSpec&, const FlameSpec&) = default;
};

/// What a solid surface is, in its own frame: bodies stand on the plane z = 0, a sphere is centred.
enum class SurfaceShape {
  sphere,    ///< around the origin
  cylinder,  ///< around z, from z = 0 to the height
  cone,      ///< base in z = 0, tip at the height
  disc,      ///< in z = 0, its front towards +z
  plane,     ///< the same, a rectangle or without end
  box,       ///< from z = 0 upwards, centred in x and y
  mesh,      ///< triangles of a file
};

enum class MaterialKind {
  lambertian,  ///< reflects diffusely
  black,       ///< absorbs everything, emits nothing
  blackbody,   ///< absorbs everything, emits at a temperature
  emitter,     ///< absorbs everything, emits a given radiance in all directions
};

/// Which side of a surface has its material; the other one is black and dark.
enum class MaterialSides { both, front };

enum class TextureKind { none, checkerboard, dots, siemens_star, bars, image };

/// How the reflectivity varies over a surface (docs/surfaces.md has pictures). Coordinates u, v of
/// the shapes are lengths on the surface [m]; those of a mesh are its texture coordinates times
/// `size`.
struct TextureSpec {
  TextureKind kind = TextureKind::none;
  double dark = 0;    ///< reflectivity of what is dark; what is light has the material's
  double cell = 0;    ///< [m] square, spacing of dots, period of the coarsest bars
  int columns = 8;    ///< squares or dots across; pairs of sectors of the star; groups of bars
  int rows = 6;       ///< squares or dots down
  double fill = 0.5;  ///< diameter of a dot over the spacing
  Vec2 size{1, 1};    ///< [m] of the image, or of the square of a star
  std::string file;   ///< image: PNG, relative to the scene file
  friend bool operator==(const TextureSpec&, const TextureSpec&) = default;
};

struct MaterialSpec {
  MaterialKind kind = MaterialKind::lambertian;
  double reflectivity = 0.5;  ///< lambertian
  double temperature = 0;     ///< [K] blackbody
  double radiance = 0;        ///< [W/(m^2 sr)] emitter, in every channel
  MaterialSides sides = MaterialSides::both;
  TextureSpec texture;
  friend bool operator==(const MaterialSpec&, const MaterialSpec&) = default;
};

/// A solid surface of the scene (those of the main lens are SurfaceSpec).
struct SolidSurfaceSpec {
  SurfaceShape shape = SurfaceShape::sphere;
  std::string name;
  Vec3 position;                      ///< [m] world place of the origin of its own frame
  Vec3 rotation;                      ///< [rad] about x, then y, then z of the world
  double radius = 0;                  ///< [m] sphere, cylinder, cone, disc
  double height = 0;                  ///< [m] cylinder, cone
  bool caps = true;                   ///< whether cylinder and cone are closed
  Vec2 extent{kInfinity, kInfinity};  ///< [m] plane: full sides along its x and y
  Vec3 size;                          ///< [m] box: full sides
  std::string file;                   ///< mesh: OBJ, PLY or STL, relative to the scene file
  double file_unit = 1;               ///< [m] mesh: what a length of 1 in the file is
  MaterialSpec material;
  friend bool operator==(const SolidSurfaceSpec&, const SolidSurfaceSpec&) = default;
};

enum class LightKind {
  point,        ///< evenly into a cone
  parallel,     ///< from infinitely far in one direction
  environment,  ///< the same radiance from everywhere
};

/// A light source. Its figure holds in every channel, or, with a temperature, for all wavelengths:
/// a channel then has the share that a blackbody of that temperature has in it.
struct LightSpec {
  LightKind kind = LightKind::point;
  std::string name;
  Vec3 position;             ///< [m] world; point
  Vec3 direction{0, 0, -1};  ///< world, in which the light goes; point, parallel
  double cone = 0;           ///< [rad] point: full angle of the cone; 0: all directions
  double power = 0;          ///< [W] point: into the cone
  double irradiance = 0;     ///< [W/m^2] parallel: on a plane across the direction
  double radiance = 0;       ///< [W/(m^2 sr)] environment
  double temperature = 0;    ///< [K] 0: the same in every channel
  friend bool operator==(const LightSpec&, const LightSpec&) = default;
};

enum class ChannelKind {
  total,  ///< all wavelengths: source function sigma T^4 / pi
  band,   ///< `width` around `wavelength`: the Planck function integrated over the band
  line,   ///< a line filter: Gaussian around `wavelength`, `width` at half its maximum
  curve,  ///< points of a response
  named,  ///< a response that is known by a name
};

struct ChannelSpec {
  std::string name = "total";
  ChannelKind kind = ChannelKind::total;
  double wavelength = 0;      ///< [m] centre, vacuum
  double width = 0;           ///< [m] full width
  std::string response = {};  ///< named
  std::string file = {};      ///< curve: CSV file, relative to the scene file
  std::string curve = {};     ///< curve: "450 nm 0.2, 460 nm 0.35, ..."; from the file when empty
  /// The response is a quantum efficiency: it counts photons, and light counts in proportion to its
  /// wavelength.
  bool photons = false;
  int wavelengths = 1;  ///< that stand for it where glasses are dispersive, at least
  friend bool operator==(const ChannelSpec&, const ChannelSpec&) = default;
};

enum class Estimator { backward, forward };

/// Defaults of a run; the command line overrides them.
struct RenderSpec {
  Estimator estimator = Estimator::backward;
  int samples = 64;  ///< rays per pixel and microlens that covers it (forward: bundles)
  std::uint64_t seed = 1;
  int reflections = 1;  ///< that light may undergo on surfaces on its way to the camera, at most
  bool flame_light = true;  ///< whether flames light the surfaces
  friend bool operator==(const RenderSpec&, const RenderSpec&) = default;
};

enum class ToneCurve { linear, display };

/// How `develop` turns flux into digital numbers.
struct DevelopSpec {
  double saturation = 0;  ///< [W] per pixel; 0: automatic exposure
  int bits = 14;
  ToneCurve curve = ToneCurve::display;
  friend bool operator==(const DevelopSpec&, const DevelopSpec&) = default;
};

struct Scene {
  std::string file;  ///< where it was read from; relative paths start there; empty: none
  CameraSpec camera;
  std::vector<FlameSpec> flames;
  std::vector<SolidSurfaceSpec> surfaces;
  std::vector<LightSpec> lights;
  std::vector<ChannelSpec> channels{ChannelSpec{}};
  RenderSpec render;
  DevelopSpec develop;
  friend bool operator==(const Scene&, const Scene&) = default;
};

}  // namespace plenoflame
