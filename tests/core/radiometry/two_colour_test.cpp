#include "plenoflame/radiometry/two_colour.h"

#include <cmath>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame {
namespace {

using test::relative;

const SpectralResponse kRed = SpectralResponse::band(650e-9, 10e-9);
const SpectralResponse kInfrared = SpectralResponse::band(850e-9, 40e-9);

// Ratios by mpmath, 30 digits: grey, and absorption in proportion to 1/wavelength.
TEST(TwoColour, RatiosAndTheirTemperatures) {
  const TwoColour grey(kRed, kInfrared, {});
  const TwoColour soot(kRed, kInfrared, AbsorptionSpectrum::power(650e-9, 1));
  const double rows[][3] = {{1200, 0.0124106358400224659, 0.0162494977457673028},
                            {1800, 0.0529342554712539326, 0.069256581677681297}};
  for (const auto& row : rows) {
    EXPECT_TRUE(relative(std::exp(grey.log_ratio(row[0])), row[1], 1e-11));
    EXPECT_TRUE(relative(grey.temperature(row[1]), row[0], 1e-11));
    EXPECT_TRUE(relative(soot.temperature(row[2]), row[0], 1e-11)) << row[0];
  }
  const TwoColour back(kInfrared, kRed, {});
  EXPECT_TRUE(relative(back.temperature(1 / rows[0][1]), 1200, 1e-11));
}

// Wien's law: d ln(ratio) / dT = c2 (1/l1 - 1/l2) / T^2.
TEST(TwoColour, SlopeIsThatOfWien) {
  const TwoColour narrow(SpectralResponse::band(650e-9, 1e-12),
                         SpectralResponse::band(850e-9, 1e-12), {});
  const double wien = constants::second_radiation * (1 / 650e-9 - 1 / 850e-9) / (1500.0 * 1500);
  EXPECT_TRUE(relative(narrow.slope(1500), wien, 1e-3));
}

TEST(TwoColour, HasNoTemperatureForEveryRatio) {
  const TwoColour grey(kRed, kInfrared, {});
  for (const double ratio : {0.0, -1.0, 1e-30, 1e9, std::nan(""), HUGE_VAL})
    EXPECT_TRUE(std::isnan(grey.temperature(ratio))) << ratio;
  EXPECT_THROW(TwoColour(kRed, kRed, {}), InputError);
}

}  // namespace
}  // namespace plenoflame
