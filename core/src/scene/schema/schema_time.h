#pragma once
#include "plenoflame/scene/scene_schema.h"
#include "scene/schema/schema_fields.h"
#include "scene/schema/schema_paths.h"

/// The rows of the schema table that say when: of flames that change, and of the sensor's exposure.
namespace plenoflame::schema {

#define FLAME_TIME FLAME, &FlameSpec::time

inline constexpr SchemaKey kExposureTime =
    key<SENSOR, &SensorSpec::exposure_time>("camera.sensor.exposure_time",
                                            "Exposure time. 0 s: until the brightest pixels fill "
                                            "95 % of the full well, at one moment of the flame.",
                                            Dimension::time, from_zero(1e6));
inline constexpr SchemaKey kExposureBegin = key<SENSOR, &SensorSpec::exposure_begin>(
    "camera.sensor.exposure_begin", "Delay of the exposure after the time of its frame.",
    Dimension::time, from_zero(1e6));
inline constexpr SchemaKey kSensorFrameRate = key<SENSOR, &SensorSpec::frame_rate>(
    "camera.sensor.frame_rate",
    "Pictures per second; 0 Hz: the rate of the first series of flames.", Dimension::frequency,
    from_zero(1e12));
inline constexpr SchemaKey kExposureSteps = key<SENSOR, &SensorSpec::exposure_steps>(
    "camera.sensor.exposure_steps", "Moments that sample an exposure with a `time_table`.", kPure,
    {1, 1000, false, false});

inline constexpr SchemaKey kBrightness = key<FLAME, &FlameSpec::brightness>(
    "flames[].brightness", "Factor on the flame's emission; its absorption is not changed.", kPure,
    from_zero(1e12));
inline constexpr SchemaKey kFlameFile =
    key<FLAME, &FlameSpec::file>("flames[].file",
                                 "Kind `vdb`: the file. With `frame_rate`: a series of files, # "
                                 "for each digit: `run_####.vdb` (docs/user/time.md).");
inline constexpr SchemaKey kFlameFrameRate = key<FLAME_TIME, &FlameTimeSpec::frame_rate>(
    "flames[].frame_rate", "Files of a series per second; 0 Hz: a single file.",
    Dimension::frequency, from_zero(1e12));
inline constexpr SchemaKey kFirstFrame = key<FLAME_TIME, &FlameTimeSpec::first_frame>(
    "flames[].first_frame", "Number of a series' file at time 0; -1: the lowest existing number.",
    kPure, {-1, 1000000000, false, false});
inline constexpr SchemaKey kTimeTable = key<FLAME_TIME, &FlameTimeSpec::table>(
    "flames[].time_table",
    "CSV file with a column `time [ms]` and any of `x [mm]`, `y [mm]`, `z [mm]`, `scale` and "
    "`brightness`, which replace the flame's; linear between rows.");

#undef FLAME_TIME

}  // namespace plenoflame::schema
