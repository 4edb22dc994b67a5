// Pixels of imported pictures that say nothing are left out of a measurement.
#include "plenoflame/inverse/measurement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plenoflame/inverse/flame_estimate.h"
#include "support/approx.h"

namespace plenoflame::test::measurement_test {
namespace {

Scene scene_of(MosaicPattern mosaic) {
  Scene scene;
  scene.camera.sensor.columns = 4;
  scene.camera.sensor.rows = 3;
  scene.camera.sensor.mosaic = mosaic;
  scene.channels.assign(3, {});
  for (std::size_t c = 0; c < 3; ++c) scene.channels[c].name = std::string(1, "rgb"[c]);
  return scene;
}

LightField picture() {
  LightField field;
  field.sensor_width = 4;
  field.sensor_height = 3;
  field.window = {0, 0, 4, 3};
  for (const char* name : {"r", "g", "b"})
    field.channels.push_back({name, Image(4, 3, 1e-9F), Image(4, 3, 1e-11F)});
  return field;
}

TEST(Measurement, LeavesOutWhatSaysNothing) {
  LightField field = picture();
  field.channels[0].flux.at(1, 2) = 5e-9F;  // defective: not the brightest pixel of the picture
  Image state(4, 3);
  state.at(1, 2) = 1;
  state.at(3, 0) = 2;
  field.layers["sensor.state"] = state;
  const Measurement result = take_measurement(field, scene_of(MosaicPattern::none), 0, 0.5);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      EXPECT_EQ(result.deviation.at(column, row) > 0, state.at(column, row) == 0);
  EXPECT_EQ(result.saturated, 1U);
  // Half of the brightest pixel that is used.
  EXPECT_TRUE(relative(result.model_error, 0.5e-9, 1e-6));
}

// Noise averages out over a block, an error of the model is common to its pixels and adds up.
TEST(Measurement, ModelErrorAddsUpOverABlock) {
  Measurement from;
  from.window = {0, 0, 4, 4};
  from.flux = Image(4, 4, 1.0F);
  from.deviation = Image(4, 4, 0.25F);
  CameraRays rays;
  rays.rows.push_back({0, 0, 0, 0});
  EXPECT_TRUE(relative(measured_rows({from}, rays, 4).deviation[0], 4 * 0.25, 1e-12));
  from.model_error = 0.5;
  EXPECT_TRUE(
      relative(measured_rows({from}, rays, 4).deviation[0], std::hypot(4 * 0.25, 16 * 0.5), 1e-12));
}

// RGGB: red where column and row are even, blue where both are odd.
TEST(Measurement, MosaicsTakeOwnColoursOnly) {
  LightField field = picture();
  field.layers["sensor.state"] = Image(4, 3);
  const Scene scene = scene_of(MosaicPattern::rggb);
  for (std::size_t c = 0; c < 3; ++c) {
    const Measurement result = take_measurement(field, scene, c, 0);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) {
        const std::size_t own = static_cast<std::size_t>(column % 2 + row % 2);
        EXPECT_EQ(result.deviation.at(column, row) > 0, own == c) << column << "," << row;
      }
  }
  // A picture that was computed knows all colours everywhere.
  field.layers.clear();
  EXPECT_GT(take_measurement(field, scene, 0, 0).deviation.at(1, 1), 0);
}

TEST(Measurement, InversePlanck) {
  const SourceFunction band = SourceFunction::band(650e-9, 10e-9), total = SourceFunction::total();
  for (const double t : {300.0, 1000.0, 1800.0, 3000.0}) {
    EXPECT_TRUE(relative(temperature_of(band, band(t)), t, 1e-12));
    EXPECT_TRUE(relative(temperature_of(total, total(t)), t, 1e-12));
  }
  EXPECT_EQ(temperature_of(band, 0), 0);
}

// By Wien's law ln S is -c2 / (wavelength T). The deviation is that of the slope, or of the
// brighter end of the interval if the darker end is below zero.
TEST(Measurement, DeviationsOfTemperatures) {
  constexpr double kSecondConstant = 0.014387769, kWavelength = 650e-9;
  const SourceFunction band = SourceFunction::band(kWavelength, 1e-9);
  for (const double t : {600.0, 1500.0}) {
    const double slope = kWavelength * t * t / kSecondConstant;
    EXPECT_TRUE(relative(temperature_deviation(t, 0.05 * band(t), band), 0.05 * slope, 1e-4));
    const double end = 1 / (1 / t - kWavelength / kSecondConstant * std::log(1001));
    EXPECT_TRUE(relative(temperature_deviation(t, 1000 * band(t), band), end - t, 1e-3));
    EXPECT_EQ(temperature_deviation(t, 0, band), 0);
  }
}

// Small errors of the logarithm are relative ones. Larger ones have the 95 % interval of a
// log-normal distribution.
TEST(Measurement, DeviationsOfAbsorptions) {
  EXPECT_TRUE(relative(absorption_deviation(40, 0.01), 0.4, 1e-3));
  EXPECT_EQ(absorption_deviation(40, 0), 0);
  for (const double error : {0.3, 1.0}) {
    const double upper = 40 * std::exp(1.96 * error), lower = 40 / std::exp(1.96 * error);
    EXPECT_TRUE(relative(2 * 1.96 * absorption_deviation(40, error), upper - lower, 1e-12));
  }
}

}  // namespace
}  // namespace plenoflame::test::measurement_test
