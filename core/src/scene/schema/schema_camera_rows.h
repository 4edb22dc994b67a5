#pragma once
#include "optics/kernel_lens_limit.h"
#include "plenoflame/camera/pupil_filters.h"
#include "plenoflame/optics/surface_shape.h"
#include "plenoflame/scene/scene_schema.h"
#include "scene/schema/schema_fields.h"
#include "scene/schema/schema_paths.h"

/// Rows of the schema table about the camera: those of apertures, and those that need functions of
/// their own.
namespace plenoflame::schema {

/// A list of numbers with units of their own, kept as numbers.
inline constexpr SchemaKey kAspheric{
    "camera.lens.surfaces[].aspheric",
    ValueType::text,
    Dimension::none,
    {},
    {},
    "Even aspheric terms of h^4, h^6, h^8, ... in the sag towards the sensor: `1.2e-7 1/mm^3, 0, "
    "-3e-12 1/mm^7`.",
    [](const Scene& scene, SchemaIndices i) -> SchemaValue {
      return format_aspheric(locate<SURFACE, &SurfaceSpec::aspheric>(scene, i));
    },
    [](Scene& scene, SchemaIndices i, const SchemaValue& value) {
      locate<SURFACE, &SurfaceSpec::aspheric>(scene, i) =
          parse_aspheric(std::get<std::string>(value));
    }};

inline constexpr SchemaKey kGlass = key<SURFACE, &SurfaceSpec::glass>(
    "camera.lens.surfaces[].glass",
    "Glass behind the surface, in place of `index`: a name of the catalogue (`N-BK7`), "
    "`sellmeier B1 B2 B3 C1 C2 C3` (C in um^2), `abbe nd vd` or `constant n`. The index is taken "
    "at the centre of the first channel's band, or at the d line (587.6 nm).");

inline constexpr double kMostDistortion = 1e6;
inline constexpr SchemaKey kDistortionK1 = key<DISTORTION, &DistortionSpec::k1>(
    "camera.lens.distortion.k1",
    "Radial distortion, coefficient of r^2. The direction (x, y, 1) from the centre of the "
    "entrance pupil is imaged like (x, y) (1 + k1 r^2 + k2 r^4 + k3 r^6) by a lens without "
    "distortion; r^2 = x^2 + y^2. Below 0: barrel.",
    kPure, within(kMostDistortion));
inline constexpr SchemaKey kDistortionK2 = key<DISTORTION, &DistortionSpec::k2>(
    "camera.lens.distortion.k2", "Radial distortion, coefficient of r^4.", kPure,
    within(kMostDistortion));
inline constexpr SchemaKey kDistortionK3 = key<DISTORTION, &DistortionSpec::k3>(
    "camera.lens.distortion.k3", "Radial distortion, coefficient of r^6.", kPure,
    within(kMostDistortion));
inline constexpr SchemaKey kDistortionP1 = key<DISTORTION, &DistortionSpec::p1>(
    "camera.lens.distortion.p1",
    "Tangential distortion: 2 p1 x y + p2 (r^2 + 2 x^2) is added to x, p1 (r^2 + 2 y^2) + 2 p2 x y "
    "to y.",
    kPure, within(kMostDistortion));
inline constexpr SchemaKey kDistortionP2 = key<DISTORTION, &DistortionSpec::p2>(
    "camera.lens.distortion.p2", "See `p1`.", kPure, within(kMostDistortion));
inline constexpr SchemaKey kDistortionDistance =
    key<DISTORTION, &DistortionSpec::distance>("camera.lens.distortion.distance",
                                               "Distance from the front vertex of the main lens to "
                                               "the plane whose image is distorted but sharp.",
                                               kLength, above_zero(kInf));

inline constexpr SchemaKey kPitchY = key<ARRAY, &ArraySpec::pitch_y>(
    "camera.array.pitch_y", "Lattice `square`: pitch along y; 0 m: as `pitch`.", kLength,
    from_zero(1));
inline constexpr SchemaKey kArrayColumns =
    key<ARRAY, &ArraySpec::columns>("camera.array.columns",
                                    "Microlenses in a row, centred on lens (0, 0); an even number "
                                    "has one more right. 0: unlimited.",
                                    kPure, {0, 65536, false, false});
inline constexpr SchemaKey kArrayRows = key<ARRAY, &ArraySpec::rows>(
    "camera.array.rows", "Rows of microlenses, centred on lens (0, 0); 0: unlimited.", kPure,
    {0, 65536, false, false});
inline constexpr SchemaKey kAperture = key<ARRAY, &ArraySpec::aperture>(
    "camera.array.aperture",
    "Shape of a microlens. Sides of a square lie along rows and columns; those of a hexagon face "
    "the neighbours in a hexagonal lattice.");
inline constexpr SchemaKey kDiameter = key<ARRAY, &ArraySpec::diameter>(
    "camera.array.diameter",
    "Clear diameter of a microlens; of a square or hexagon, from side to side. At most the pitch.",
    kLength, above_zero(1));
inline constexpr SchemaKey kDiameterY = key<ARRAY, &ArraySpec::diameter_y>(
    "camera.array.diameter_y",
    "Aperture `square`: clear diameter along y, for rectangles; 0 m: as `diameter`.", kLength,
    from_zero(1));

inline constexpr SchemaKey kPixelPitch = key<SENSOR, &SensorSpec::pixel_pitch>(
    "camera.sensor.pixel_pitch",
    "Distance between the centres of neighbouring pixels, along a row if pixels are not square.",
    kLength, above_zero(0.1));
inline constexpr SchemaKey kPixelPitchY = key<SENSOR, &SensorSpec::pixel_pitch_y>(
    "camera.sensor.pixel_pitch_y", "Pixel pitch along a column; 0 m: as `pixel_pitch`.", kLength,
    from_zero(0.1));

/// Wider ones would blur microlenses into one another.
inline constexpr double kMostBlur = 16;
inline constexpr SchemaKey kSensorBlur = key<SENSOR, &SensorSpec::blur>(
    "camera.sensor.blur",
    "Standard deviation, in pixels, of a Gaussian blur on the sensor (diffraction, cover glass, "
    "crosstalk), which ends at four deviations.",
    kPure, from_zero(kMostBlur));

inline constexpr SchemaKey kFilterName =
    key<FILTER, &PupilFilterSpec::name>("camera.pupil_filters[].name", "Name for reports.");
inline constexpr SchemaKey kFilterShape =
    key<FILTER, &PupilFilterSpec::shape>("camera.pupil_filters[].shape",
                                         "Part of the stop: a `sector` (also a half or a ring), or "
                                         "a convex `polygon`. Filters must not overlap.");
inline constexpr SchemaKey kFilterAngle = key<FILTER, &PupilFilterSpec::angle>(
    "camera.pupil_filters[].angle",
    "Sector: angle of its start, from camera x (right) towards camera y (down).", kAngle,
    within(1000));
inline constexpr SchemaKey kFilterExtent = key<FILTER, &PupilFilterSpec::extent>(
    "camera.pupil_filters[].extent", "Sector: angle over which it extends; 0 deg: all around.",
    kAngle, {0, 6.2831853071795872, false, false});
inline constexpr SchemaKey kFilterInner = key<FILTER, &PupilFilterSpec::inner>(
    "camera.pupil_filters[].inner", "Sector: inner radius, in radii of the stop.", kPure,
    from_zero(1));
inline constexpr SchemaKey kFilterOuter = key<FILTER, &PupilFilterSpec::outer>(
    "camera.pupil_filters[].outer", "Sector: outer radius, in radii of the stop.", kPure,
    above_zero(10));
/// A list of points, kept as numbers.
inline constexpr SchemaKey kFilterCorners{
    "camera.pupil_filters[].corners",
    ValueType::text,
    Dimension::none,
    {},
    {},
    "Polygon: its corners x y (camera axes) in radii of the stop, in order: `0 -1, 1 -1, 1 1, 0 "
    "1`.",
    [](const Scene& scene, SchemaIndices i) -> SchemaValue {
      return format_corners(locate<FILTER, &PupilFilterSpec::corners>(scene, i));
    },
    [](Scene& scene, SchemaIndices i, const SchemaValue& value) {
      locate<FILTER, &PupilFilterSpec::corners>(scene, i) =
          parse_corners(std::get<std::string>(value));
    }};
inline constexpr SchemaKey kCameraName = key<CAMERA, &CameraSpec::name>(
    "camera.name",
    "Name of the camera: letters, digits, _ and -. Each of several `[[cameras]]` needs its own.");
inline constexpr SchemaList kLensSurfaces =
    list<SURFACE>("camera.lens.surfaces", 0, kMaxLensSurfaces);
inline constexpr SchemaKey kFilterTransmission = key<FILTER, &PupilFilterSpec::transmission>(
    "camera.pupil_filters[].transmission",
    "Transmission, linear between points: `640 nm 0, 650 nm 0.9, 660 nm 0`, 0 outside; empty: all "
    "light passes.");

}  // namespace plenoflame::schema
