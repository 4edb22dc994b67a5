#include <limits>
#include <numbers>
#include <type_traits>

#include "plenoflame/scene/scene_schema.h"

namespace plenoflame {
namespace {

// ---- words of the choices, in the order of the enumerators -------------------------------------

template <class Enum>
struct Words;
template <>
struct Words<LensModel> {
  static constexpr std::string_view list[] = {"real", "ideal"};
};
template <>
struct Words<Lattice> {
  static constexpr std::string_view list[] = {"square", "hexagonal"};
};
template <>
struct Words<ArrayReference> {
  static constexpr std::string_view list[] = {"principal_plane", "vertex"};
};
template <>
struct Words<FocusMode> {
  static constexpr std::string_view list[] = {"distance", "paraxial", "best"};
};
template <>
struct Words<FlameKind> {
  static constexpr std::string_view list[] = {"layered", "vdb"};
};
template <>
struct Words<Interpolation> {
  static constexpr std::string_view list[] = {"trilinear", "constant"};
};
template <>
struct Words<ChannelKind> {
  static constexpr std::string_view list[] = {"total", "band"};
};
template <>
struct Words<Estimator> {
  static constexpr std::string_view list[] = {"backward", "forward"};
};
template <>
struct Words<ToneCurve> {
  static constexpr std::string_view list[] = {"linear", "display"};
};

// ---- from a chain of members to a field of a scene ----------------------------------------------

template <class T>
inline constexpr bool is_list = false;
template <class T>
inline constexpr bool is_list<std::vector<T>> = true;

/// The field that a chain of members leads to; every list on the way takes the next index.
template <auto First, auto... Rest>
auto& locate(auto& object, SchemaIndices indices) {
  auto& member = object.*First;
  if constexpr (sizeof...(Rest) == 0) {
    return member;
  } else if constexpr (is_list<std::remove_cvref_t<decltype(member)>>) {
    return locate<Rest...>(member.at(indices.front()), indices.subspan(1));
  } else {
    return locate<Rest...>(member, indices);
  }
}

template <class Field>
constexpr ValueType value_type() {
  if constexpr (std::is_enum_v<Field>) return ValueType::choice;
  if constexpr (std::is_same_v<Field, bool>) return ValueType::boolean;
  if constexpr (std::is_same_v<Field, int>) return ValueType::integer;
  if constexpr (std::is_same_v<Field, std::uint64_t>) return ValueType::natural;
  if constexpr (std::is_same_v<Field, double>) return ValueType::number;
  if constexpr (std::is_same_v<Field, Vec2>) return ValueType::vector2;
  if constexpr (std::is_same_v<Field, Vec3>) return ValueType::vector3;
  return ValueType::text;
}

template <auto... Members>
SchemaValue get_field(const Scene& scene, SchemaIndices indices) {
  const auto& field = locate<Members...>(scene, indices);
  using Field = std::remove_cvref_t<decltype(field)>;
  if constexpr (std::is_enum_v<Field>) {
    const auto i = static_cast<std::size_t>(field);
    return std::string(i < std::size(Words<Field>::list) ? Words<Field>::list[i] : "?");
  } else if constexpr (std::is_same_v<Field, int>) {
    return std::int64_t{field};
  } else {
    return field;
  }
}

template <auto... Members>
void set_field(Scene& scene, SchemaIndices indices, const SchemaValue& value) {
  auto& field = locate<Members...>(scene, indices);
  using Field = std::remove_cvref_t<decltype(field)>;
  if constexpr (std::is_enum_v<Field>) {
    for (std::size_t i = 0; i < std::size(Words<Field>::list); ++i)
      if (Words<Field>::list[i] == std::get<std::string>(value)) field = static_cast<Field>(i);
  } else if constexpr (std::is_same_v<Field, int>) {
    field = static_cast<int>(std::get<std::int64_t>(value));
  } else {
    field = std::get<Field>(value);
  }
}

template <auto... Members>
constexpr SchemaKey key(std::string_view path, std::string_view description,
                        Dimension dimension = Dimension::none, ValueRange range = {}) {
  using Field = std::remove_cvref_t<decltype(locate<Members...>(std::declval<Scene&>(), {}))>;
  std::span<const std::string_view> choices;
  if constexpr (std::is_enum_v<Field>) choices = Words<Field>::list;
  return {path,
          value_type<Field>(),
          dimension,
          range,
          choices,
          description,
          &get_field<Members...>,
          &set_field<Members...>};
}

template <auto... Members>
constexpr SchemaList list(std::string_view path, std::size_t fewest, std::size_t most) {
  return {path,
          fewest,
          most,
          [](const Scene& scene, SchemaIndices i) { return locate<Members...>(scene, i).size(); },
          [](Scene& scene, SchemaIndices i, std::size_t size) {
            locate<Members...>(scene, i).resize(size);
          },
          [](Scene& scene, SchemaIndices i, std::size_t position) {
            auto& items = locate<Members...>(scene, i);
            items.emplace(items.begin() + static_cast<std::ptrdiff_t>(position));
          },
          [](Scene& scene, SchemaIndices i, std::size_t position) {
            auto& items = locate<Members...>(scene, i);
            items.erase(items.begin() + static_cast<std::ptrdiff_t>(position));
          }};
}

// ---- ranges -------------------------------------------------------------------------------------

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr ValueRange above_zero(double upper) {
  return {0, upper, true, false};
}
constexpr ValueRange from_zero(double upper) {
  return {0, upper, false, false};
}
constexpr ValueRange within(double size) {
  return {-size, size, false, false};
}
constexpr ValueRange kNonzero{-kInf, kInf, false, true};
constexpr ValueRange kIndex{1, 5, false, false};
constexpr double kFar = 1e6;          // [m] positions
constexpr double kLargestLens = 100;  // [m]
constexpr Dimension kLength = Dimension::length;
constexpr Dimension kAngle = Dimension::angle;
constexpr Dimension kPure = Dimension::none;

// ---- the table ----------------------------------------------------------------------------------

#define CAMERA &Scene::camera
#define LENS CAMERA, &CameraSpec::lens
#define SURFACE LENS, &MainLensSpec::surfaces
#define ARRAY CAMERA, &CameraSpec::array
#define TYPE ARRAY, &ArraySpec::types
#define SENSOR CAMERA, &CameraSpec::sensor
#define FOCUS CAMERA, &CameraSpec::focus
#define FLAME &Scene::flames
#define LAYER FLAME, &FlameSpec::layers
#define TEMPERATURE FLAME, &FlameSpec::temperature
#define ABSORPTION FLAME, &FlameSpec::absorption
#define CHANNEL &Scene::channels
#define RENDER &Scene::render
#define DEVELOP &Scene::develop

constexpr SchemaKey kKeys[] = {
    key<CAMERA, &CameraSpec::position>("camera.position",
                                       "Place of the front vertex of the main lens in the world.",
                                       kLength, within(kFar)),
    key<CAMERA, &CameraSpec::look_direction>(
        "camera.look_direction",
        "World direction in which the camera looks; its length does not matter.", kPure,
        within(kFar)),
    key<CAMERA, &CameraSpec::up>("camera.up",
                                 "World direction that is up in the picture; its part along the "
                                 "look direction does not matter.",
                                 kPure, within(kFar)),

    key<LENS, &MainLensSpec::model>("camera.lens.model",
                                    "`real` refracts at every surface; `ideal` is the paraxial "
                                    "transform between the principal planes, "
                                    "without aberrations."),
    key<LENS, &MainLensSpec::focal_length>("camera.lens.focal_length",
                                           "Focal length of an ideal thin lens at the origin; used "
                                           "when `surfaces` is empty, 0 m otherwise.",
                                           kLength, from_zero(kLargestLens)),
    key<LENS, &MainLensSpec::diameter>(
        "camera.lens.diameter",
        "Diameter of that thin lens, which is its stop; used when `surfaces` is empty.", kLength,
        from_zero(kLargestLens)),

    key<SURFACE, &SurfaceSpec::radius>("camera.lens.surfaces[].radius",
                                       "Radius of curvature, positive when its centre lies on the "
                                       "sensor's side; `inf` is a plane.",
                                       kLength, kNonzero),
    key<SURFACE, &SurfaceSpec::thickness>(
        "camera.lens.surfaces[].thickness",
        "Distance along the axis to the vertex of the next surface.", kLength,
        from_zero(kLargestLens)),
    key<SURFACE, &SurfaceSpec::index>(
        "camera.lens.surfaces[].index",
        "Refractive index behind the surface, towards the sensor; 1 after the last.", kPure,
        kIndex),
    key<SURFACE, &SurfaceSpec::diameter>("camera.lens.surfaces[].diameter",
                                         "Clear diameter, at most twice the radius.", kLength,
                                         above_zero(kLargestLens)),
    key<SURFACE, &SurfaceSpec::stop>("camera.lens.surfaces[].stop",
                                     "Whether this is the aperture stop; exactly one surface is."),

    key<ARRAY, &ArraySpec::present>(
        "camera.array.present",
        "Whether there is a microlens array; a file that has the table `camera.array` means yes."),
    key<ARRAY, &ArraySpec::lattice>("camera.array.lattice", "How the microlenses are arranged."),
    key<ARRAY, &ArraySpec::model>("camera.array.model",
                                  "`real` microlenses are thick lenses with two spherical faces; "
                                  "`ideal` ones the paraxial transform."),
    key<ARRAY, &ArraySpec::pitch>("camera.array.pitch",
                                  "Distance between the centres of neighbouring microlenses.",
                                  kLength, above_zero(1)),
    key<ARRAY, &ArraySpec::diameter>("camera.array.diameter",
                                     "Clear diameter of a microlens, at most the pitch.", kLength,
                                     above_zero(1)),
    key<ARRAY, &ArraySpec::thickness>("camera.array.thickness",
                                      "Thickness of a microlens between its two vertices.", kLength,
                                      from_zero(1)),
    key<ARRAY, &ArraySpec::opaque_between>(
        "camera.array.opaque_between",
        "Whether the area between the microlenses is opaque; if not, it is clear air."),
    key<ARRAY, &ArraySpec::rotation>(
        "camera.array.rotation",
        "Rotation of the array about the optical axis, from camera x towards y.", kAngle,
        within(1000)),
    key<ARRAY, &ArraySpec::offset>(
        "camera.array.offset",
        "Where the centre of lens (0, 0) lies, camera x and y, from the optical axis.", kLength,
        within(1)),
    key<ARRAY, &ArraySpec::sensor_distance>("camera.array.sensor_distance",
                                            "Distance B between array and sensor.", kLength,
                                            above_zero(10)),
    key<ARRAY, &ArraySpec::measured_from>("camera.array.measured_from",
                                          "Where that distance begins: at the rear principal plane "
                                          "of the first type, or at the rear vertices."),

    key<TYPE, &MicrolensSpec::name>(
        "camera.array.types[].name",
        "Name of this kind of microlens, for `focus.conjugate` and reports."),
    key<TYPE, &MicrolensSpec::radius_front>(
        "camera.array.types[].radius_front",
        "Radius of the face towards the scene, positive when convex.", kLength, kNonzero),
    key<TYPE, &MicrolensSpec::radius_back>(
        "camera.array.types[].radius_back",
        "Radius of the face towards the sensor, positive when convex.", kLength, kNonzero),
    key<TYPE, &MicrolensSpec::index>("camera.array.types[].index",
                                     "Refractive index of the microlens.", kPure, kIndex),
    key<TYPE, &MicrolensSpec::focal_length>(
        "camera.array.types[].focal_length",
        "Focal length of an ideal thin microlens; used when both faces are plane, 0 m otherwise.",
        kLength, within(10)),

    key<SENSOR, &SensorSpec::columns>("camera.sensor.columns", "Pixels across.", kPure,
                                      {1, 65536, false, false}),
    key<SENSOR, &SensorSpec::rows>("camera.sensor.rows", "Pixels down.", kPure,
                                   {1, 65536, false, false}),
    key<SENSOR, &SensorSpec::pixel_pitch>("camera.sensor.pixel_pitch",
                                          "Side of the square pixels, which leave no gaps.",
                                          kLength, above_zero(0.1)),

    key<FOCUS, &FocusSpec::mode>("camera.focus.mode",
                                 "`distance`: as given by `lens_distance`; `paraxial`: the object "
                                 "plane is imaged paraxially on the conjugate "
                                 "plane; `best`: with the least RMS spot of real rays there."),
    key<FOCUS, &FocusSpec::lens_distance>("camera.focus.lens_distance",
                                          "Mode `distance`: from the vertex of the last lens "
                                          "surface to the front vertices of the microlenses, or to "
                                          "the sensor without an array.",
                                          kLength, from_zero(1000)),
    key<FOCUS, &FocusSpec::object_distance>(
        "camera.focus.object_distance",
        "Other modes: from the front vertex of the main lens to the object plane; may be `inf`.",
        kLength, from_zero(kInf)),
    key<FOCUS, &FocusSpec::conjugate>(
        "camera.focus.conjugate",
        "What is conjugate to the object plane: `array` (plenoptic 1.0), the name of a microlens "
        "type (2.0: the plane "
        "on which that type is sharp), or `sensor` (only without array, and then the default)."),

    key<FLAME, &FlameSpec::kind>(
        "flames[].kind",
        "`layered`: exact ellipsoids, given in `layers`; `vdb`: grids of an OpenVDB file."),
    key<FLAME, &FlameSpec::name>("flames[].name", "Name for messages."),
    key<FLAME, &FlameSpec::position>("flames[].position",
                                     "World place of the origin of the flame's own frame.", kLength,
                                     within(kFar)),
    key<FLAME, &FlameSpec::rotation>("flames[].rotation",
                                     "Rotation of the flame about the world's x, then y, then z.",
                                     kAngle, within(1000)),
    key<FLAME, &FlameSpec::scale>(
        "flames[].scale",
        "Factor on the flame's own lengths before it is turned and placed, for files that are not "
        "in metres (0.001: millimetres); absorption stays as it is.",
        kPure, above_zero(1e9)),
    key<FLAME, &FlameSpec::file>("flames[].file",
                                 "Kind `vdb`: the file, relative to the scene file."),
    key<FLAME, &FlameSpec::interpolation>("flames[].interpolation",
                                          "Kind `vdb`: how values vary within a voxel."),

    key<LAYER, &EllipsoidSpec::name>("flames[].layers[].name", "Name for messages."),
    key<LAYER, &EllipsoidSpec::centre>("flames[].layers[].centre",
                                       "Centre of the ellipsoid in the flame's frame.", kLength,
                                       within(kFar)),
    key<LAYER, &EllipsoidSpec::semi_axes>("flames[].layers[].semi_axes",
                                          "Semi-axes along the flame's x, y and z.", kLength,
                                          above_zero(kFar)),
    key<LAYER, &EllipsoidSpec::temperature>("flames[].layers[].temperature",
                                            "Temperature of the layer.", Dimension::temperature,
                                            above_zero(1e5)),
    key<LAYER, &EllipsoidSpec::absorption>("flames[].layers[].absorption",
                                           "Absorption coefficient of the layer.",
                                           Dimension::absorption, from_zero(1e12)),

    key<TEMPERATURE, &GridSpec::grid>(
        "flames[].temperature.grid",
        "Name of the grid in the file; empty: `temperature` and its known aliases."),
    key<TEMPERATURE, &GridSpec::unit>(
        "flames[].temperature.unit",
        "Unit of scale * stored + offset (K, degC); empty: the file's metadata, else K."),
    key<TEMPERATURE, &GridSpec::scale>("flames[].temperature.scale", "Factor on the stored values.",
                                       kPure, kNonzero),
    key<TEMPERATURE, &GridSpec::offset>("flames[].temperature.offset", "Added after the factor.",
                                        kPure, within(1e12)),

    key<ABSORPTION, &GridSpec::grid>(
        "flames[].absorption.grid",
        "Name of the grid in the file; empty: `absorption` and its known aliases."),
    key<ABSORPTION, &GridSpec::unit>(
        "flames[].absorption.unit",
        "Unit of scale * stored + offset (1/m, 1/cm, 1/mm); empty: the file's metadata, else 1/m."),
    key<ABSORPTION, &GridSpec::scale>("flames[].absorption.scale", "Factor on the stored values.",
                                      kPure, kNonzero),
    key<ABSORPTION, &GridSpec::offset>("flames[].absorption.offset", "Added after the factor.",
                                       kPure, within(1e12)),

    key<CHANNEL, &ChannelSpec::name>("channels[].name",
                                     "Name of the image channel: letters, digits, _ and -."),
    key<CHANNEL, &ChannelSpec::kind>(
        "channels[].kind",
        "`total`: all wavelengths, sigma T^4 / pi; `band`: Planck's law over a band."),
    key<CHANNEL, &ChannelSpec::wavelength>(
        "channels[].wavelength", "Kind `band`: its centre, in vacuum.", kLength, from_zero(1e-3)),
    key<CHANNEL, &ChannelSpec::width>("channels[].width", "Kind `band`: its full width.", kLength,
                                      from_zero(1e-3)),

    key<RENDER, &RenderSpec::estimator>("render.estimator",
                                        "`backward`: rays from the sensor to the flame; `forward`: "
                                        "energy bundles from the flame, slow, for checks."),
    key<RENDER, &RenderSpec::samples>(
        "render.samples",
        "Estimator `backward`: rays per pixel and microlens that covers it; "
        "`forward`: energy bundles in total.",
        kPure, {1, 1 << 30, false, false}),
    key<RENDER, &RenderSpec::seed>("render.seed",
                                   "The same seed gives the same image, bit for bit."),

    key<DEVELOP, &DevelopSpec::saturation>(
        "develop.saturation", "Radiant flux per pixel that is white; 0 W: automatic exposure.",
        Dimension::flux, from_zero(1e6)),
    key<DEVELOP, &DevelopSpec::bits>("develop.bits", "Bit depth of the sensor's converter.", kPure,
                                     {1, 16, false, false}),
    key<DEVELOP, &DevelopSpec::curve>(
        "develop.curve",
        "`linear`: numbers proportional to flux; `display`: brightened for a screen."),
};

constexpr SchemaList kLists[] = {
    list<SURFACE>("camera.lens.surfaces", 0, 1000),
    list<TYPE>("camera.array.types", 0, 3),
    list<FLAME>("flames", 0, 1000),
    list<LAYER>("flames[].layers", 0, 100000),
    list<CHANNEL>("channels", 1, 64),
};

constexpr SchemaTable kTables[] = {
    {"camera", "Where the camera stands and looks.", true, PresetKind::camera},
    {"camera.lens", "The main lens: surfaces, or a thin ideal lens.", false, {}},
    {"camera.lens.surfaces[]",
     "The surfaces of the main lens, from the scene to the sensor, in air.",
     false,
     {}},
    {"camera.array",
     "The microlens array; without this table the camera is a conventional one.",
     false,
     {}},
    {"camera.array.types[]", "The one to three interleaved kinds of microlenses.", false, {}},
    {"camera.sensor", "The sensor, centred on the optical axis.", false, {}},
    {"camera.focus", "How the distance between main lens and array is found.", false, {}},
    {"flames[]", "The flames.", true, PresetKind::flame},
    {"flames[].layers[]",
     "Ellipsoids of a layered flame; where several overlap, the first listed counts.",
     false,
     {}},
    {"flames[].temperature", "Kind `vdb`: how a grid becomes the temperature.", false, {}},
    {"flames[].absorption",
     "Kind `vdb`: how a grid becomes the absorption coefficient.",
     false,
     {}},
    {"channels[]", "What is measured; without any, one channel `total`.", false, {}},
    {"render", "Defaults of a run; the command line overrides them.", false, {}},
    {"develop", "How the command `develop` turns flux into digital numbers.", false, {}},
};

}  // namespace

std::span<const SchemaKey> schema_keys() {
  return kKeys;
}
std::span<const SchemaList> schema_lists() {
  return kLists;
}
std::span<const SchemaTable> schema_tables() {
  return kTables;
}

}  // namespace plenoflame
