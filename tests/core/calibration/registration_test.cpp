// Pictures of a known function, moved and scaled: the fit knows nothing but pixels.
#include "plenoflame/calibration/registration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "plenoflame/base/error.h"
#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::test::registration_test {
namespace {

/// Smooth light, as of micro-images: band limited, so that a cubic between pixels follows it.
double light(double x, double y) {
  return 2 + std::sin(0.31 * x + 0.1 * y) + 0.5 * std::cos(0.23 * y - 0.17 * x + 1);
}

Image picture(int width, int height, Vec2 shift, double gain) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at(x, y) = static_cast<float>(gain * light(x - shift.x, y - shift.y));
  return image;
}

MicroImages micro_images() {
  return MicroImages(
      Camera(small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real)).camera),
      false);
}

TEST(Registration, FindsShiftAndGain) {
  const MicroImages images = micro_images();
  const PixelWindow window{0, 0, 60, 60};
  const Image simulated = picture(60, 60, {}, 1e-9);
  for (const Vec2 shift : {Vec2{0, 0}, Vec2{0.3, -0.2}, Vec2{-1.4, 0.7}}) {
    const Image measured = picture(60, 60, shift, 3.5e3 * 1e-9);
    const Registration found = register_pictures(measured, simulated, window, images);
    // The cubic's own error, and the edges, where nothing is known from beyond.
    EXPECT_TRUE(within(length(found.whole.shift - shift), 0, 0.02, 1));
    EXPECT_TRUE(relative(found.whole.gain, 3.5e3, 2e-3));
    ASSERT_GT(found.lenses.size(), 60u);
    int inside = 0;
    for (const LensFit& lens : found.lenses) {
      if (lens.centre.x < 8 || lens.centre.y < 8 || lens.centre.x > 52 || lens.centre.y > 52)
        continue;
      ++inside;
      EXPECT_TRUE(within(length(lens.fit.shift - shift), 0, 0.02, 1));
      EXPECT_TRUE(relative(lens.fit.gain, 3.5e3, 5e-3));
      EXPECT_LT(lens.fit.residual, 5e-3);
    }
    EXPECT_GT(inside, 30);
  }
}

// With noise the shift is known to as much as it says: squares of its errors in units of theirs.
TEST(Registration, ErrorsAreThoseOfTheNoise) {
  const MicroImages images = micro_images();
  const PixelWindow window{0, 0, 60, 60};
  const Image simulated = picture(60, 60, {}, 1);
  Image measured = simulated;
  std::mt19937_64 random(7);
  std::normal_distribution<float> noise(0, 0.05f);
  for (float& value : measured.pixels) value += noise(random);
  const Registration found = register_pictures(measured, simulated, window, images);
  double chi2 = 0;
  for (const LensFit& lens : found.lenses)
    chi2 += std::pow(lens.fit.shift.x / lens.fit.shift_error.x, 2) +
            std::pow(lens.fit.shift.y / lens.fit.shift_error.y, 2) +
            std::pow((lens.fit.gain - 1) / lens.fit.gain_error, 2);
  const double n = 3.0 * static_cast<double>(found.lenses.size());
  // Discs of some pixels: Student's distribution is a little wider than the normal one.
  EXPECT_GT(chi2, 0.7 * n);
  EXPECT_LT(chi2, 1.6 * n);
  EXPECT_LT(std::fabs(found.whole.shift.x), 4 * found.whole.shift_error.x);
  EXPECT_LT(std::fabs(found.whole.shift.y), 4 * found.whole.shift_error.y);
}

TEST(Registration, RefusesWhatDoesNotFit) {
  const MicroImages images = micro_images();
  const Image bright = picture(60, 60, {}, 1), dark(60, 60);
  EXPECT_THROW(register_pictures(bright, dark, {0, 0, 60, 60}, images), InputError);
  EXPECT_THROW(register_pictures(picture(50, 60, {}, 1), bright, {0, 0, 60, 60}, images),
               InputError);
}

}  // namespace
}  // namespace plenoflame::test::registration_test
