#include "plenoflame/radiometry/source_function.h"

#include <cmath>
#include <limits>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::source_function_test {
namespace {

struct Row {
  double wavelength, temperature, radiance;
};

// mpmath, 50 digits, from the exact SI constants and the exact values of the doubles.
constexpr Row kPlanck[] = {
    {250e-9, 200, 1.30513570091827491290738431472e-108},
    {250e-9, 1500, 2.65145641096154494774879807499},
    {250e-9, 2000, 3.8830252604428366928929250132e+4},
    {250e-9, 10000, 3.87430098892739489044305177068e+14},
    {250e-9, 100000, 1.56756781772043980776552944206e+17},
    {431e-9, 200, 2.59902457069086842019590963479e-57},
    {431e-9, 1500, 1.73131857129792818071878042531e+6},
    {431e-9, 2000, 4.51510687906501737407817443887e+8},
    {431e-9, 10000, 2.94756998228385560246754224014e+14},
    {431e-9, 100000, 2.02079149711836284490748423479e+16},
    {650e-9, 200, 8.82584184487979531451228578992e-34},
    {650e-9, 1500, 4.00510171074275552022374328054e+8},
    {650e-9, 2000, 1.60253298361493317544339631838e+10},
    {650e-9, 10000, 1.2598690858529760447216760484e+14},
    {650e-9, 100000, 4.14313133702676010924877788039e+15},
    {2e-6, 200, 8.90135225673062411169269772745e-4},
    {2e-6, 1500, 3.10126041564709210620017240115e+10},
    {2e-6, 2000, 1.04885232606705678922263489065e+11},
    {2e-6, 10000, 3.53407702784707132704215280258e+12},
    {2e-6, 100000, 4.98998261865383788603163496129e+13},
    {20e-6, 200, 1.04885232606705661575606566033e+6},
    {20e-6, 1500, 6.04796007977462534449889486931e+7},
    {20e-6, 2000, 8.59802489127636328528002087278e+7},
    {20e-6, 10000, 4.9899826186538353731019083523e+8},
    {20e-6, 100000, 5.15526423343966523037789299075e+9},
};

TEST(PlanckRadiance, AgreesWithFiftyDigits) {
  for (const Row& row : kPlanck)
    EXPECT_TRUE(
        test::relative(planck_radiance(row.wavelength, row.temperature), row.radiance, 1.5e-15))
        << row.wavelength << " m, " << row.temperature << " K";
}

// Five digits as printed in tables (1500, 1800, 2000 K).
TEST(PlanckRadiance, AgreesWithTheTable) {
  constexpr double wavelengths[] = {431e-9, 532e-9, 589e-9, 650e-9, 700e-9, 850e-9};
  constexpr double temperatures[] = {1500, 1800, 2000};
  constexpr double table[3][6] = {{1.7313e6, 4.1317e7, 1.4219e8, 4.0051e8, 7.9334e8, 3.3731e9},
                                  {7.0670e7, 8.3401e8, 2.1460e9, 4.6853e9, 7.7856e9, 2.2124e10},
                                  {4.5151e8, 3.7471e9, 8.3368e9, 1.6025e10, 2.4390e10, 5.6666e10}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 6; ++j)
      EXPECT_TRUE(
          test::relative(planck_radiance(wavelengths[j], temperatures[i]), table[i][j], 5e-5));
}

TEST(PlanckRadiance, NothingIsEmittedAtZero) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double t : {0.0, -1.0, nan, 1e-300}) EXPECT_EQ(planck_radiance(650e-9, t), 0);
}

TEST(PlanckRadiance, WienLimit) {
  // B / (c1 / lambda^5 e^-x) = 1 / (1 - e^-x)
  for (const double t : {800.0, 1800.0}) {
    const double x = constants::second_radiation / (650e-9 * t);
    const double wien = constants::first_radiation / std::pow(650e-9, 5) * std::exp(-x);
    EXPECT_TRUE(test::relative(planck_radiance(650e-9, t), wien, 1.01 * std::exp(-x) + 1e-14));
  }
  const double ratio =
      planck_radiance(650e-9, 1800) / (constants::first_radiation / std::pow(650e-9, 5) *
                                       std::exp(-constants::second_radiation / (650e-9 * 1800)));
  EXPECT_TRUE(test::relative(ratio - 1, 4.6e-6, 0.02));
}

TEST(PlanckRadiance, RayleighJeansLimit) {
  const double wavelength = 1e-2, t = 1e5;  // x = 1.4e-5: B = 2ckT/lambda^4 (1 - x/2 + ...)
  const double x = constants::second_radiation / (wavelength * t);
  const double limit =
      2 * constants::light_speed * constants::boltzmann * t / std::pow(wavelength, 4);
  EXPECT_TRUE(test::relative(planck_radiance(wavelength, t), limit * (1 - x / 2), x * x));
}

// Wien's displacement law: the maximum lies at lambda T = 2.897771955e-3 m K (CODATA 2018).
TEST(PlanckRadiance, PeaksWhereWienSays) {
  const double peak = 2.897771955e-3 / 1650;
  EXPECT_LT(planck_radiance(peak * (1 - 1e-4), 1650), planck_radiance(peak, 1650));
  EXPECT_LT(planck_radiance(peak * (1 + 1e-4), 1650), planck_radiance(peak, 1650));
}

// Simpson's rule in ln(lambda) from 0.1 um to 1 mm; what lies outside is below 1e-7 here.
TEST(PlanckRadiance, IntegratesToStefanBoltzmann) {
  for (const double t : {1000.0, 1650.0, 3000.0}) {
    const int n = 4000;
    const double first = std::log(1e-7), step = (std::log(1e-3) - first) / n;
    double sum = 0;
    for (int i = 0; i <= n; ++i) {
      const double wavelength = std::exp(first + i * step);
      const int weight = i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2;
      sum += weight * wavelength * planck_radiance(wavelength, t);
    }
    const double expected = 5.670374419e-8 * std::pow(t, 4) / constants::pi;
    EXPECT_TRUE(test::relative(sum * step / 3, expected, 1e-6)) << t;
  }
}

TEST(SourceFunction, TotalIsStefanBoltzmann) {
  const SourceFunction total = SourceFunction::total();
  EXPECT_TRUE(total.is_total());
  EXPECT_TRUE(test::relative(total(1650), 1.8049362359900739e-8 * std::pow(1650.0, 4), 1e-15));
  EXPECT_EQ(total(0), 0);
  EXPECT_EQ(total(-5), 0);
}

struct BandRow {
  double wavelength, width, temperature, radiance;
};
// mpmath, 30 digits.
constexpr BandRow kBands[] = {
    {650e-9, 10e-9, 200, 9.8078676213809527125e-42},
    {650e-9, 10e-9, 1650, 1.5326294247469159294e+1},
    {650e-9, 10e-9, 100000, 4.1439020965201785823e+7},
    {500e-9, 400e-9, 200, 1.1589400650390538319e-38},
    {500e-9, 400e-9, 1650, 1.9871646115958905745e+2},
    {500e-9, 400e-9, 100000, 7.7549616680990641469e+9},
    {1e-6, 1.9e-6, 200, 2.3054762307088337262e-11},
    {1e-6, 1.9e-6, 1650, 4.3074245647902970453e+4},
    {1e-6, 1.9e-6, 100000, 6.6106525141024937909e+11},
    {10e-6, 19.98e-6, 200, 1.3876388380561055255e+1},
    {10e-6, 19.98e-6, 1650, 1.332998343934635024e+5},
    {10e-6, 19.98e-6, 100000, 1.8043572325324498116e+12},
    {1e-6, 1e-15, 200, 6.8121546918718504752e-33},
    {1e-6, 1e-15, 1650, 1.9454108766345738972e-5},
    {1e-6, 1e-15, 100000, 7.6969171119559143436e-1},
};

TEST(SourceFunction, BandsAgreeWithThirtyDigits) {
  for (const BandRow& row : kBands) {
    const SourceFunction band = SourceFunction::band(row.wavelength, row.width);
    EXPECT_TRUE(test::relative(band(row.temperature), row.radiance, 1e-12))
        << row.wavelength << " m, " << row.width << " m, " << row.temperature << " K, "
        << band.nodes().size() << " nodes";
  }
}

// sigma T^4 / pi from the band of 0.1 um to 1 mm; what lies beyond 1 mm is Rayleigh and Jeans' law,
// x = c_2 / (1 mm T): 15/pi^4 (x^3/3 - x^4/8 + x^5/60) of the whole, 2e-5 at 200 K.
TEST(SourceFunction, StefanBoltzmannFromABand) {
  const SourceFunction band = SourceFunction::band(0.5 * (1e-7 + 1e-3), 1e-3 - 1e-7);
  for (const double t : {600.0, 1000.0, 1700.0, 3000.0, 5000.0})
    EXPECT_TRUE(
        test::relative(band(t), 5.670374419e-8 / 3.14159265358979324 * std::pow(t, 4), 1e-6))
        << t;
  for (const double t : {200.0, 300.0, 450.0}) {
    const double x = 0.014387768775039337 / (1e-3 * t);
    const double beyond = 15 / std::pow(3.14159265358979324, 4) *
                          (x * x * x / 3 - std::pow(x, 4) / 8 + std::pow(x, 5) / 60);
    EXPECT_TRUE(test::relative(
        band(t), (1 - beyond) * 5.670374419e-8 / 3.14159265358979324 * std::pow(t, 4), 1e-7))
        << t;
  }
}

TEST(SourceFunction, BandsAreAdditive) {
  const double whole = SourceFunction::band(650e-9, 100e-9)(1500);
  const double parts =
      SourceFunction::band(625e-9, 50e-9)(1500) + SourceFunction::band(675e-9, 50e-9)(1500);
  EXPECT_TRUE(test::relative(parts, whole, 1e-12));
}

// A camera filter must stay cheap: nodes are evaluated at every step through a grid.
TEST(SourceFunction, NarrowBandsNeedFewNodes) {
  EXPECT_LE(SourceFunction::band(650e-9, 10e-9).nodes().size(), 7u);
  EXPECT_LE(SourceFunction::band(650e-9, 1e-9).nodes().size(), 4u);
}

TEST(SourceFunction, ColdAndHot) {
  const SourceFunction band = SourceFunction::band(650e-9, 10e-9);
  EXPECT_EQ(band(0), 0);
  EXPECT_EQ(band(-1), 0);
  EXPECT_EQ(band(std::numeric_limits<double>::quiet_NaN()), 0);
  EXPECT_EQ(band(1e-3), 0);
  EXPECT_TRUE(std::isfinite(band(1e30)));
}

TEST(SourceFunction, RefusesImpossibleBands) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double width : {0.0, -1e-9, 1300e-9, 2e-6, nan, inf})
    EXPECT_THROW(SourceFunction::band(650e-9, width), InputError) << width;
  EXPECT_THROW(SourceFunction::band(0, 1e-9), InputError);
  EXPECT_THROW(SourceFunction::band(nan, 1e-9), InputError);
  EXPECT_THROW(SourceFunction::band(inf, 1e-9), InputError);
}

}  // namespace
}  // namespace plenoflame::source_function_test
