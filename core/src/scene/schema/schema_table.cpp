#include "plenoflame/scene/scene_schema.h"
#include "scene/schema/schema_camera_rows.h"
#include "scene/schema/schema_cameras.h"
#include "scene/schema/schema_fields.h"
#include "scene/schema/schema_paths.h"
#include "scene/schema/schema_time.h"
#include "scene/schema/schema_windows.h"

namespace plenoflame {
namespace {

using namespace schema;

constexpr SchemaKey kRows[] = {
    kCameraName,
    key<CAMERA, &CameraSpec::position>(
        "camera.position", "World place of the main lens' front vertex.", kLength, within(kFar)),
    key<CAMERA, &CameraSpec::look_direction>(
        "camera.look_direction", "World direction in which the camera looks; any length.", kPure,
        within(kFar)),
    key<CAMERA, &CameraSpec::up>(
        "camera.up",
        "World direction that is up in the picture, at any angle to the look direction.", kPure,
        within(kFar)),

    key<LENS, &MainLensSpec::model>("camera.lens.model",
                                    "`real` refracts at every surface; `ideal` is the paraxial "
                                    "transform between the principal planes."),
    key<LENS, &MainLensSpec::focal_length>(
        "camera.lens.focal_length",
        "Focal length of an ideal thin lens at the origin, if `surfaces` is empty.", kLength,
        from_zero(kLargestLens)),
    key<LENS, &MainLensSpec::diameter>(
        "camera.lens.diameter", "Diameter of the thin lens and its stop, if `surfaces` is empty.",
        kLength, from_zero(kLargestLens)),
    key<LENS, &MainLensSpec::decentre>(
        "camera.lens.decentre",
        "Displacement of the main lens from the axis, along camera x and y.", kLength, within(1)),
    key<LENS, &MainLensSpec::tilt>(
        "camera.lens.tilt",
        "Tilt of the main lens about camera x, then y, around its front vertex.", kAngle,
        within(0.2)),

    kDistortionK1,
    kDistortionK2,
    kDistortionK3,
    kDistortionP1,
    kDistortionP2,
    kDistortionDistance,

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

    key<SURFACE, &SurfaceSpec::conic>("camera.lens.surfaces[].conic",
                                      "Conic constant: 0 a sphere, -1 a paraboloid.", kPure,
                                      within(1e6)),
    kAspheric,
    key<SURFACE, &SurfaceSpec::radius_x>(
        "camera.lens.surfaces[].radius_x",
        "Biconic surface: radius of the section along camera x, in place of `radius`. `inf` makes "
        "a cylinder. 0 m: a round surface.",
        kLength),
    key<SURFACE, &SurfaceSpec::radius_y>("camera.lens.surfaces[].radius_y",
                                         "Biconic surface: radius of the section along camera y.",
                                         kLength),
    key<SURFACE, &SurfaceSpec::conic_x>("camera.lens.surfaces[].conic_x",
                                        "Conic constant along camera x of a biconic surface.",
                                        kPure, within(1e6)),
    key<SURFACE, &SurfaceSpec::conic_y>("camera.lens.surfaces[].conic_y",
                                        "Conic constant along camera y of a biconic surface.",
                                        kPure, within(1e6)),
    kGlass,

    key<ARRAY, &ArraySpec::present>("camera.array.present",
                                    "Whether there is a microlens array; true with this table."),
    key<ARRAY, &ArraySpec::lattice>("camera.array.lattice", "Arrangement of the microlenses."),
    key<ARRAY, &ArraySpec::model>("camera.array.model",
                                  "`real` microlenses are thick lenses with two spherical faces; "
                                  "`ideal` ones apply the paraxial transform."),
    key<ARRAY, &ArraySpec::pitch>("camera.array.pitch",
                                  "Distance between the centres of neighbouring microlenses.",
                                  kLength, above_zero(1)),
    kPitchY,
    kArrayColumns,
    kArrayRows,
    kAperture,
    kDiameter,
    kDiameterY,
    key<ARRAY, &ArraySpec::thickness>("camera.array.thickness",
                                      "Thickness of a microlens between its two vertices.", kLength,
                                      from_zero(1)),
    key<ARRAY, &ArraySpec::opaque_between>("camera.array.opaque_between",
                                           "Whether the area between the microlenses is opaque."),
    key<ARRAY, &ArraySpec::rotation>(
        "camera.array.rotation",
        "Rotation of the array about the optical axis, from camera x towards y.", kAngle,
        within(1000)),
    key<ARRAY, &ArraySpec::offset>("camera.array.offset",
                                   "Centre of lens (0, 0), camera x and y, from the optical axis.",
                                   kLength, within(1)),
    key<ARRAY, &ArraySpec::sensor_distance>("camera.array.sensor_distance",
                                            "Distance B between array and sensor.", kLength,
                                            above_zero(10)),
    key<ARRAY, &ArraySpec::measured_from>("camera.array.measured_from",
                                          "Start of `sensor_distance`: the rear principal plane of "
                                          "the first type, or the rear vertices."),

    key<ARRAY, &ArraySpec::spacing_error>("camera.array.spacing_error",
                                          "The sensor is this much farther from the array than "
                                          "`sensor_distance`; the focus is computed without it.",
                                          kLength, within(1)),
    key<ARRAY, &ArraySpec::centre_jitter>(
        "camera.array.centre_jitter",
        "Each microlens is displaced to a random point of a disc of this radius, at most half the "
        "gap between neighbours. Lens (0, 0) stays.",
        kLength, from_zero(1)),
    key<ARRAY, &ArraySpec::focal_jitter>(
        "camera.array.focal_jitter",
        "Random factors from 1 - focal_jitter to 1 + focal_jitter multiply the radii of each "
        "microlens, or the focal length of an ideal one. Lens (0, 0) is exact.",
        kPure, from_zero(0.5)),
    key<ARRAY, &ArraySpec::jitter_seed>("camera.array.jitter_seed", "Seed of both jitters."),
    key<ARRAY, &ArraySpec::tilt>("camera.array.tilt",
                                 "Tilt of the array against the sensor, about camera x, then y.",
                                 kAngle, within(0.2)),

    key<TYPE, &MicrolensSpec::name>("camera.array.types[].name",
                                    "Name, for `focus.conjugate` and reports."),
    key<TYPE, &MicrolensSpec::radius_front>(
        "camera.array.types[].radius_front",
        "Radius of the face towards the scene, positive when convex.", kLength, kNonzero),
    key<TYPE, &MicrolensSpec::radius_back>(
        "camera.array.types[].radius_back",
        "Radius of the face towards the sensor, positive when convex.", kLength, kNonzero),
    key<TYPE, &MicrolensSpec::index>("camera.array.types[].index",
                                     "Refractive index of the microlens.", kPure, kIndex),
    key<TYPE, &MicrolensSpec::focal_length>("camera.array.types[].focal_length",
                                            "Focal length of an `ideal` microlens, which is then "
                                            "thin; 0 m: computed from radii and `index`.",
                                            kLength, within(10)),

    key<TYPE, &MicrolensSpec::glass>(
        "camera.array.types[].glass",
        "Glass of the microlens in place of `index`, as for the main lens."),

    key<SENSOR, &SensorSpec::columns>("camera.sensor.columns",
                                      "Pixels across; columns times rows are at most 1000 million.",
                                      kPure, {1, 65536, false, false}),
    key<SENSOR, &SensorSpec::rows>("camera.sensor.rows",
                                   "Pixels down; columns times rows are at most 1000 million.",
                                   kPure, {1, 65536, false, false}),
    kPixelPitch,
    kPixelPitchY,
    kSensorBlur,
    key<SENSOR, &SensorSpec::mosaic>(
        "camera.sensor.mosaic",
        "Colour filters over the pixels; R, G and B are the first three channels."),
    kSensorFrameRate,
    kExposureBegin,
    kExposureTime,
    kExposureSteps,
    key<SENSOR, &SensorSpec::quantum_efficiency>(
        "camera.sensor.quantum_efficiency",
        "Electrons per photon; 1 if the responses of the channels include it.", kPure,
        above_zero(1)),
    key<SENSOR, &SensorSpec::fill_factor>("camera.sensor.fill_factor",
                                          "Share of a pixel's area that is sensitive.", kPure,
                                          above_zero(1)),
    key<SENSOR, &SensorSpec::full_well>(
        "camera.sensor.full_well",
        "Greatest number of electrons in a pixel; excess electrons are lost.", kPure,
        above_zero(1e12)),
    key<SENSOR, &SensorSpec::read_noise>("camera.sensor.read_noise",
                                         "RMS noise of reading a pixel, in electrons.", kPure,
                                         from_zero(1e6)),
    key<SENSOR, &SensorSpec::dark_current>("camera.sensor.dark_current",
                                           "Electrons per second and pixel without light.", kPure,
                                           from_zero(1e12)),
    key<SENSOR, &SensorSpec::gain>(
        "camera.sensor.gain",
        "Electrons per digital number; 0: the full well is the largest number.", kPure,
        from_zero(1e9)),
    key<SENSOR, &SensorSpec::bits>("camera.sensor.bits", "Bit depth of the sensor's converter.",
                                   kPure, {1, 16, false, false}),
    key<SENSOR, &SensorSpec::black_level>(
        "camera.sensor.black_level",
        "Digital number without light; 0: five times the read noise, rounded up, or 0 if the read "
        "noise is below a tenth of a digital number.",
        kPure, from_zero(65535)),
    key<SENSOR, &SensorSpec::shot_noise>("camera.sensor.shot_noise",
                                         "Whether electrons arrive by Poisson's law."),
    key<SENSOR, &SensorSpec::hot_pixels>("camera.sensor.hot_pixels",
                                         "Share of the pixels whose dark current is `hot_current`.",
                                         kPure, from_zero(1)),
    key<SENSOR, &SensorSpec::hot_current>("camera.sensor.hot_current",
                                          "Dark current of the hot pixels, electrons per second.",
                                          kPure, from_zero(1e12)),
    key<SENSOR, &SensorSpec::dead_pixels>("camera.sensor.dead_pixels",
                                          "Share of the pixels that record no light.", kPure,
                                          from_zero(1)),
    key<SENSOR, &SensorSpec::noise_seed>("camera.sensor.noise_seed",
                                         "The same seed gives the same noise and defects."),

    key<FOCUS, &FocusSpec::mode>(
        "camera.focus.mode",
        "`distance`: by `lens_distance`; `paraxial`: the paraxial image of the object plane lies "
        "on the conjugate plane; `best`: the least RMS spot of real rays."),
    key<FOCUS, &FocusSpec::lens_distance>(
        "camera.focus.lens_distance",
        "Mode `distance`: from the last lens vertex to the front vertices of the microlenses, or "
        "to the sensor without an array.",
        kLength, from_zero(1000)),
    key<FOCUS, &FocusSpec::object_distance>(
        "camera.focus.object_distance",
        "Other modes: from the front vertex of the main lens to the object plane; may be `inf`.",
        kLength, from_zero(kInf)),
    key<FOCUS, &FocusSpec::conjugate>(
        "camera.focus.conjugate",
        "Conjugate of the object plane: `array` (plenoptic 1.0), a microlens type (2.0: the plane "
        "on which it is sharp), or `sensor` (only without array, and then the default)."),

    key<TRANSMISSION, &TransmissionSpec::fresnel>(
        "camera.transmission.fresnel",
        "Whether every refracting surface reflects light (unpolarised)."),
    key<TRANSMISSION, &TransmissionSpec::coating_index>(
        "camera.transmission.coating_index",
        "Index of a quarter-wave layer on the main lens' surfaces in air; 0: uncoated.", kPure,
        from_zero(5)),
    key<TRANSMISSION, &TransmissionSpec::coating_wavelength>(
        "camera.transmission.coating_wavelength",
        "Wavelength for which the layer is a quarter wave thick.", kLength, above_zero(1e-3)),
    key<TRANSMISSION, &TransmissionSpec::cover_index>(
        "camera.transmission.cover_index",
        "Index of the sensor's cover glass, which reflects but does not shift the image. 1: no "
        "cover glass.",
        kPure, kIndex),
    key<TRANSMISSION, &TransmissionSpec::filter>(
        "camera.transmission.filter",
        "Transmission of a filter before the sensor, linear between points: `400 nm 0.9, 700 nm "
        "0.8`, 0 outside."),

    kFilterName,
    kFilterShape,
    kFilterAngle,
    kFilterExtent,
    kFilterInner,
    kFilterOuter,
    kFilterCorners,
    kFilterTransmission,

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
    key<FLAME, &FlameSpec::scale>("flames[].scale",
                                  "Factor on the flame's lengths, for files that are not in metres "
                                  "(0.001: millimetres); absorption is not scaled.",
                                  kPure, above_zero(1e9)),
    kBrightness,
    kFlameFile,
    kFlameFrameRate,
    kFirstFrame,
    kTimeTable,
    key<FLAME, &FlameSpec::interpolation>("flames[].interpolation",
                                          "Kind `vdb`: interpolation of values within a voxel."),

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
    key<LAYER, &EllipsoidSpec::volume_fraction>(
        "flames[].layers[].volume_fraction",
        "Volume fraction of soot, in place of the absorption, with the spectrum `soot`.", kPure,
        from_zero(1)),

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
    key<ABSORPTION, &GridSpec::unit>("flames[].absorption.unit",
                                     "Unit of scale * stored + offset (1/m, 1/cm, 1/mm; `1` or "
                                     "`ppm` of soot); empty: the file's metadata, else 1/m."),
    key<ABSORPTION, &GridSpec::scale>("flames[].absorption.scale", "Factor on the stored values.",
                                      kPure, kNonzero),
    key<ABSORPTION, &GridSpec::offset>("flames[].absorption.offset", "Added after the factor.",
                                       kPure, within(1e12)),

    key<LINE, &LineSpec::kind>(
        "flames[].lines[].kind",
        "`custom`: at `wavelength`; `ch`: CH*; `c2_474`, `c2_517`, `c2_564`: Swan bands of C2*; "
        "`oh`: OH*; `na_d`: both sodium D lines."),
    key<LINE, &LineSpec::wavelength>("flames[].lines[].wavelength",
                                     "Kind `custom`: vacuum wavelength.", kLength, from_zero(1e-3)),
    key<LINE, &LineSpec::width>(
        "flames[].lines[].width",
        "Full width at half the maximum of a Gaussian profile; 0: narrow against every channel.",
        kLength, from_zero(1e-3)),
    key<EMISSION, &GridSpec::grid>(
        "flames[].lines[].grid",
        "Name of the grid in the file; empty: the line's known names (`CH*`, `CH`, ...)."),
    key<EMISSION, &GridSpec::unit>(
        "flames[].lines[].unit",
        "Unit of scale * stored + offset: power into all directions (W/m^3, kW/m^3, W/cm^3, "
        "W/mm^3), into each (W/(m^3 sr), W/(cm^3 sr)), or photons (1/(m^3 s), 1/(cm^3 s), "
        "mol/(m^3 s)); empty: the file's metadata, which must state it then."),
    key<EMISSION, &GridSpec::scale>("flames[].lines[].scale", "Factor on the stored values.", kPure,
                                    kNonzero),
    key<EMISSION, &GridSpec::offset>("flames[].lines[].offset", "Added after the factor.", kPure,
                                     within(1e30)),

    key<SPECTRUM, &SpectrumSpec::kind>(
        "flames[].spectrum.kind",
        "`grey`: constant; `power`: proportional to (reference / wavelength)^exponent; `soot`: 6 "
        "pi E(m) f_v / wavelength; `table`: points."),
    key<SPECTRUM, &SpectrumSpec::reference>("flames[].spectrum.reference",
                                            "Wavelength at which the flame's absorption holds.",
                                            kLength, above_zero(1e-3)),
    key<SPECTRUM, &SpectrumSpec::exponent>("flames[].spectrum.exponent",
                                           "Kind `power`: exponent; about 1 to 1.4 for soot.",
                                           kPure, within(20)),
    key<SPECTRUM, &SpectrumSpec::index>(
        "flames[].spectrum.index",
        "Kind `soot`: refractive index; `constant` E(m), `chang` (Chang and Charalampopoulos 1990, "
        "from 0.4 um) or `dalzell` (Dalzell and Sarofim 1969, 436 to 806 nm)."),
    key<SPECTRUM, &SpectrumSpec::absorption_function>(
        "flames[].spectrum.absorption_function",
        "Kind `soot` with a constant index: E(m); published values are 0.2 to 0.4.", kPure,
        above_zero(10)),
    key<SPECTRUM, &SpectrumSpec::table>(
        "flames[].spectrum.table",
        "Kind `table`: relative absorption, linear between points: `450 nm 1.4, 650 nm 1`."),

    key<SCATTERING, &ScatteringSpec::albedo>(
        "flames[].scattering.albedo",
        "Share of scattering in the extinction, below 1. Scattering is added to the absorption.",
        kPure, from_zero(1)),
    key<SCATTERING, &ScatteringSpec::grid>("flames[].scattering.grid",
                                           "Kind `vdb`: name of a grid of albedos in the file, at "
                                           "least 0 and below 1; empty: `albedo` everywhere."),
    key<SCATTERING, &ScatteringSpec::phase>("flames[].scattering.phase", "Phase function."),
    key<SCATTERING, &ScatteringSpec::asymmetry>(
        "flames[].scattering.asymmetry",
        "Henyey-Greenstein: mean cosine of the scattering angle; 0: isotropic.", kPure,
        {-0.999, 0.999, false, false}),

    key<SOLID, &SolidSurfaceSpec::shape>(
        "surfaces[].shape", "Shape; a body stands on z = 0 of its own frame, a sphere is centred."),
    key<SOLID, &SolidSurfaceSpec::name>("surfaces[].name", "Name for messages."),
    key<SOLID, &SolidSurfaceSpec::position>("surfaces[].position",
                                            "World place of the origin of its own frame.", kLength,
                                            within(kFar)),
    key<SOLID, &SolidSurfaceSpec::rotation>("surfaces[].rotation",
                                            "Rotation about the world's x, then y, then z.", kAngle,
                                            within(1000)),
    key<SOLID, &SolidSurfaceSpec::radius>("surfaces[].radius",
                                          "Radius of a sphere, cylinder, cone's base or disc.",
                                          kLength, from_zero(kFar)),
    key<SOLID, &SolidSurfaceSpec::height>("surfaces[].height",
                                          "Height of a cylinder or cone, along its z.", kLength,
                                          from_zero(kFar)),
    key<SOLID, &SolidSurfaceSpec::caps>("surfaces[].caps",
                                        "Whether a cylinder or cone has end caps."),
    key<SOLID, &SolidSurfaceSpec::extent>(
        "surfaces[].extent", "Sides of a plane along its x and y; its front looks along its z.",
        kLength, above_zero(kInf)),
    key<SOLID, &SolidSurfaceSpec::size>("surfaces[].size",
                                        "Sides of a box, which is centred in x and y.", kLength,
                                        from_zero(kFar)),
    key<SOLID, &SolidSurfaceSpec::file>("surfaces[].file", "Mesh: an OBJ, PLY or STL file."),
    key<SOLID, &SolidSurfaceSpec::file_unit>(
        "surfaces[].file_unit", "Mesh: length of one unit in the file.", kLength, above_zero(kFar)),

    key<MATERIAL, &MaterialSpec::kind>(
        "surfaces[].material.kind",
        "`lambertian` reflects diffusely; the others absorb: `black` is dark, `blackbody` emits at "
        "`temperature`, `emitter` emits `radiance` in all directions."),
    key<MATERIAL, &MaterialSpec::reflectivity>(
        "surfaces[].material.reflectivity",
        "Kind `lambertian`: share of reflected light, the same in every channel.", kPure,
        from_zero(1)),
    key<MATERIAL, &MaterialSpec::temperature>("surfaces[].material.temperature",
                                              "Kind `blackbody`: temperature.",
                                              Dimension::temperature, from_zero(1e5)),
    key<MATERIAL, &MaterialSpec::radiance>("surfaces[].material.radiance",
                                           "Kind `emitter`: radiance, the same in every channel.",
                                           Dimension::radiance, from_zero(1e30)),
    key<MATERIAL, &MaterialSpec::sides>(
        "surfaces[].material.sides",
        "`front`: only the front has this material, and the back is black."),

    key<TEXTURE, &TextureSpec::kind>(
        "surfaces[].material.texture.kind",
        "Generated pattern, or an `image` (PNG, converted to linear values)."),
    key<TEXTURE, &TextureSpec::dark>("surfaces[].material.texture.dark",
                                     "Reflectivity of the dark parts.", kPure, from_zero(1)),
    key<TEXTURE, &TextureSpec::cell>("surfaces[].material.texture.cell",
                                     "Side of a square, spacing of dots, period of the coarsest "
                                     "bars.",
                                     kLength, from_zero(kFar)),
    key<TEXTURE, &TextureSpec::columns>(
        "surfaces[].material.texture.columns",
        "Squares or dots across, sectors of the star, or groups of bars.", kPure,
        {1, 10000, false, false}),
    key<TEXTURE, &TextureSpec::rows>("surfaces[].material.texture.rows",
                                     "Squares or dots down the pattern.", kPure,
                                     {1, 10000, false, false}),
    key<TEXTURE, &TextureSpec::fill>("surfaces[].material.texture.fill",
                                     "Diameter of a dot over the spacing.", kPure, above_zero(1)),
    key<TEXTURE, &TextureSpec::size>("surfaces[].material.texture.size",
                                     "Sides of an image; a star's diameter is the smaller one.",
                                     kLength, above_zero(kFar)),
    key<TEXTURE, &TextureSpec::file>("surfaces[].material.texture.file", "Kind `image`: the file."),

    key<LIGHT, &LightSpec::kind>("lights[].kind",
                                 "`point`: evenly into a cone; `parallel`: like the sun; "
                                 "`environment`: the same radiance from everywhere."),
    key<LIGHT, &LightSpec::name>("lights[].name", "Name for messages."),
    key<LIGHT, &LightSpec::position>("lights[].position", "World place of a point source.", kLength,
                                     within(kFar)),
    key<LIGHT, &LightSpec::direction>(
        "lights[].direction",
        "World direction in which the light goes (the axis of a cone); any length.", kPure,
        within(kFar)),
    key<LIGHT, &LightSpec::cone>("lights[].cone",
                                 "Full angle of a point source's cone; 0 rad: all directions.",
                                 kAngle, from_zero(6.2831853071795864)),
    key<LIGHT, &LightSpec::power>("lights[].power", "Kind `point`: radiant flux into the cone.",
                                  Dimension::flux, from_zero(1e30)),
    key<LIGHT, &LightSpec::irradiance>(
        "lights[].irradiance", "Kind `parallel`: irradiance of a plane across the direction.",
        Dimension::irradiance, from_zero(1e30)),
    key<LIGHT, &LightSpec::radiance>("lights[].radiance", "Kind `environment`: radiance.",
                                     Dimension::radiance, from_zero(1e30)),
    key<LIGHT, &LightSpec::temperature>(
        "lights[].temperature",
        "0 K: the value above holds in every channel. Otherwise it is the total, and a channel "
        "gets its share of this blackbody's light.",
        Dimension::temperature, from_zero(1e5)),

    key<CHANNEL, &ChannelSpec::name>("channels[].name",
                                     "Name of the image channel: letters, digits, _ and -."),
    key<CHANNEL, &ChannelSpec::kind>(
        "channels[].kind",
        "`total`: all wavelengths, sigma T^4 / pi; `band`: Planck's law over a band; `line`: "
        "Gaussian filter; `curve`: response by points; `named`: a named response."),
    key<CHANNEL, &ChannelSpec::wavelength>("channels[].wavelength",
                                           "Kinds `band` and `line`: centre, in vacuum.", kLength,
                                           from_zero(1e-3)),
    key<CHANNEL, &ChannelSpec::width>(
        "channels[].width", "Kind `band`: full width; `line`: full width at half the maximum.",
        kLength, from_zero(1e-3)),
    key<CHANNEL, &ChannelSpec::response>(
        "channels[].response",
        "Kind `named`: `cie_x`, `cie_y`, `cie_z`, or a sensor's colour (docs/radiometry.md)."),
    key<CHANNEL, &ChannelSpec::file>(
        "channels[].file",
        "Kind `curve`: CSV file of wavelength in nm (or as its header says) and response."),
    key<CHANNEL, &ChannelSpec::curve>("channels[].curve",
                                      "Kind `curve`: the points, `450 nm 0.2, 460 nm 0.35`, joined "
                                      "by straight lines; empty: read from `file`."),
    key<CHANNEL, &ChannelSpec::photons>("channels[].photons",
                                        "Whether the response is a quantum efficiency: light then "
                                        "counts in proportion to its wavelength, as electrons do."),
    key<CHANNEL, &ChannelSpec::wavelengths>(
        "channels[].wavelengths",
        "Least number of wavelengths that sample the channel if a glass disperses.", kPure,
        {1, 16, false, false}),

    key<RENDER, &RenderSpec::estimator>("render.estimator",
                                        "`backward`: rays from the sensor; `forward`: energy "
                                        "bundles from the flame, slow, for checks."),
    key<RENDER, &RenderSpec::samples>(
        "render.samples",
        "`backward`: rays per pixel and microlens; `forward`: energy bundles in total.", kPure,
        {1, 1 << 30, false, false}),
    key<RENDER, &RenderSpec::seed>(
        "render.seed",
        "The same seed gives the same image, bit for bit, with any number of threads."),
    key<RENDER, &RenderSpec::reflections>(
        "render.reflections", "Most reflections by surfaces along a path; 1: direct light only.",
        kPure, {0, 64, false, false}),
    key<RENDER, &RenderSpec::flame_light>("render.flame_light",
                                          "Whether flames light the surfaces."),

    key<DEVELOP, &DevelopSpec::saturation>(
        "develop.saturation", "Radiant flux of a white pixel; 0 W: automatic exposure.",
        Dimension::flux, from_zero(1e6)),
    key<DEVELOP, &DevelopSpec::bits>("develop.bits", "Bit depth of the sensor's converter.", kPure,
                                     {1, 16, false, false}),
    key<DEVELOP, &DevelopSpec::curve>(
        "develop.curve",
        "`linear`: numbers proportional to flux; `display`: brightened for a screen."),
};

constexpr SchemaList kListRows[] = {
    list<&Scene::cameras>("cameras", 0, 100), kLensSurfaces,
    list<TYPE>("camera.array.types", 0, 3),   list<FILTER>("camera.pupil_filters", 0, 16),
    list<FLAME>("flames", 0, 1000),           list<LAYER>("flames[].layers", 0, 100000),
    list<LINE>("flames[].lines", 0, 8),       list<SOLID>("surfaces", 0, 10000),
    list<LIGHT>("lights", 0, 1000),           list<&Scene::windows>("windows", 0, 100),
    list<CHANNEL>("channels", 1, 64),
};

constexpr auto kAllRows = joined(kRows, kWindowRows);
constexpr auto kKeys = with_each_camera<kAllRows>();
constexpr auto kLists = with_each_camera<kListRows>();

}  // namespace

std::span<const SchemaKey> schema_keys() {
  return kKeys;
}
std::span<const SchemaList> schema_lists() {
  return kLists;
}

}  // namespace plenoflame
