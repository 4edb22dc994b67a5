#pragma once
#include "plenoflame/scene/scene_schema.h"
#include "scene/schema/schema_fields.h"
#include "scene/schema/schema_paths.h"

/// The rows of the schema table that say when: of flames that change, and of the sensor's exposure.
namespace plenoflame::schema {

#define FLAME_TIME FLAME, &FlameSpec::time

inline constexpr SchemaKey kExposureTime = key<SENSOR, &SensorSpec::exposure_time>(
    "camera.sensor.exposure_time",
    "How long light is gathered; 0 s: until the brightest pixels fill 95 % of the full well, and "
    "of flames that change one moment is seen.",
    Dimension::time, from_zero(1e6));
inline constexpr SchemaKey kExposureBegin = key<SENSOR, &SensorSpec::exposure_begin>(
    "camera.sensor.exposure_begin",
    "How long after the time of its frame an exposure begins, where flames change with time.",
    Dimension::time, from_zero(1e6));
inline constexpr SchemaKey kSensorFrameRate = key<SENSOR, &SensorSpec::frame_rate>(
    "camera.sensor.frame_rate",
    "How many pictures the camera takes per second, where flames change with time; 0 Hz: as many "
    "as the first series of flames has files.",
    Dimension::frequency, from_zero(1e12));
inline constexpr SchemaKey kExposureSteps = key<SENSOR, &SensorSpec::exposure_steps>(
    "camera.sensor.exposure_steps",
    "How many moments stand for an exposure of a flame that moves or dims by a `time_table`.",
    kPure, {1, 1000, false, false});

inline constexpr SchemaKey kBrightness = key<FLAME, &FlameSpec::brightness>(
    "flames[].brightness", "Factor on the light that the flame emits; what it absorbs stays.",
    kPure, from_zero(1e12));
inline constexpr SchemaKey kFlameFile = key<FLAME, &FlameSpec::file>(
    "flames[].file",
    "Kind `vdb`: the file, relative to the scene file. With `frame_rate` a series of files, # for "
    "each digit of their numbers: `run_####.vdb` (docs/user/time.md).");
inline constexpr SchemaKey kFlameFrameRate = key<FLAME_TIME, &FlameTimeSpec::frame_rate>(
    "flames[].frame_rate", "How many files of a series belong to a second; 0 Hz: a single file.",
    Dimension::frequency, from_zero(1e12));
inline constexpr SchemaKey kFirstFrame = key<FLAME_TIME, &FlameTimeSpec::first_frame>(
    "flames[].first_frame",
    "Number of a series' file at time 0; -1: the lowest number that there is.", kPure,
    {-1, 1000000000, false, false});
inline constexpr SchemaKey kTimeTable = key<FLAME_TIME, &FlameTimeSpec::table>(
    "flames[].time_table",
    "CSV file with a column `time [ms]` and any of `x [mm]`, `y [mm]`, `z [mm]`, `scale` and "
    "`brightness`, which take the place of the flame's `position`, `scale` and `brightness`; "
    "straight lines between rows.");

#undef FLAME_TIME

}  // namespace plenoflame::schema
