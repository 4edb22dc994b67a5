// integrate_reference against closed forms.
#include <cmath>
#include <limits>

#include "core/media/field_medium.h"
#include "plenoflame/media/layered_medium.h"
#include "support/approx.h"

namespace plenoflame::reference_test {
namespace {

using test::FieldMedium;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr Box kUnit{{0, -1, -1}, {1, 1, 1}};
constexpr Ray kAlongX{{-3, 0.1, 0.2}, {1, 0, 0}};

// Constant source: L = S (1 - e^-tau) whatever the absorption; a Gaussian has tau by erf.
TEST(ReferenceIntegrator, ConstantSourceThroughAGaussian) {
  for (const double peak : {1e-9, 0.5, 40.0, 3e4}) {
    const double width = 0.03, centre = 0.4;
    const FieldMedium medium(
        [=](double x) { return peak * std::exp(-std::pow((x - centre) / width, 2)); },
        [](double) { return 5.0; }, kUnit);
    const auto r = integrate_reference(medium, kAlongX, 0, kInf);
    const double tau = peak * width * std::sqrt(std::acos(-1.0)) / 2 *
                       (std::erf((1 - centre) / width) + std::erf(centre / width));
    ASSERT_EQ(r.size(), 3u);
    EXPECT_TRUE(test::relative(r[2], tau, 1e-10)) << peak;
    EXPECT_TRUE(test::relative(r[0], -std::expm1(-tau) * 5, 1e-10)) << peak;
    EXPECT_TRUE(test::relative(r[1], 2 * r[0], 1e-12)) << peak;
  }
}

// tau = k x^2 / 2 and S = 1 + tau: L = 2 - (2 + tau) e^-tau.
TEST(ReferenceIntegrator, SourceGrowingWithOpticalDepth) {
  for (const double k : {1e-6, 1.0, 60.0, 1e7}) {
    const FieldMedium medium([=](double x) { return k * x; },
                             [=](double x) { return 1 + 0.5 * k * x * x; }, kUnit);
    const auto r = integrate_reference(medium, kAlongX, 0, kInf);
    const long double tau = 0.5L * k;
    const long double expected = -2 * std::expm1(-tau) - tau * std::exp(-tau);
    EXPECT_TRUE(test::relative(r[0], static_cast<double>(expected), 1e-10)) << k;
    EXPECT_TRUE(test::relative(r[2], 0.5 * k, 1e-13)) << k;
  }
}

// The same light from the other side: the dark end now lies behind the hot one.
TEST(ReferenceIntegrator, DirectionMatters) {
  const double k = 3;
  const FieldMedium medium([=](double) { return k; }, [](double x) { return x; }, kUnit);
  const double t = std::exp(-k), psi = (1 - t) / k;
  const Ray back{{5, 0, 0}, {-1, 0, 0}};
  EXPECT_TRUE(test::relative(integrate_reference(medium, kAlongX, 0, kInf)[0], psi - t, 1e-12));
  EXPECT_TRUE(test::relative(integrate_reference(medium, back, 0, kInf)[0], 1 - psi, 1e-12));
}

TEST(ReferenceIntegrator, JumpsAndKinksAreBreakpoints) {
  const FieldMedium medium([](double x) { return x < 0.3 ? 2.0 : 50.0 * (x - 0.3); },
                           [](double x) { return x < 0.3 ? 7.0 : 1.0; }, kUnit, {0.3});
  const double first = 2 * 0.3, second = 25 * 0.7 * 0.7;
  const auto r = integrate_reference(medium, kAlongX, -10, 10);
  EXPECT_TRUE(test::relative(r[2], first + second, 1e-13));
  EXPECT_TRUE(test::relative(r[0], -std::expm1(-first) * 7 - std::exp(-first) * std::expm1(-second),
                             1e-10));
}

TEST(ReferenceIntegrator, SegmentsAndMisses) {
  const FieldMedium medium([](double) { return 1.0; }, [](double) { return 1.0; }, kUnit);
  EXPECT_TRUE(test::relative(integrate_reference(medium, kAlongX, 3.25, 3.5)[2], 0.25, 1e-13));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Ray& miss : {Ray{{0, 2, 0}, {1, 0, 0}}, Ray{{0, 0, 5}, {0, 1, 0}},
                          Ray{{nan, 0, 0}, {1, 0, 0}}, Ray{{0, 0, 0}, {0, 0, 0}}}) {
    const auto r = integrate_reference(medium, miss, -kInf, kInf);
    EXPECT_EQ(r, (std::vector<double>{0, 0, 0}));
  }
  EXPECT_EQ(integrate_reference(medium, kAlongX, 8, 9)[2], 0);
}

TEST(ReferenceIntegrator, OpticalThicknessOfAMillion) {
  const SourceFunction total = SourceFunction::total();
  const auto medium = make_layered_medium({{{}, {0.5, 0.5, 0.5}, 1500, 1e6}}, {}, {total});
  const auto r = integrate_reference(*medium, {{}, {0, 0, 1}}, -kInf, kInf);
  EXPECT_TRUE(test::relative(r[0], total(1500), 1e-10));
  EXPECT_TRUE(test::relative(r[1], 1e6, 1e-12));
}

}  // namespace
}  // namespace plenoflame::reference_test
