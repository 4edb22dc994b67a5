// Special values, tabulated numbers and continuity of the kernels' exponentials; their worst errors
// over all ranges are measured by the stress suite (tests/stress/radiometry_stress_test.cpp).
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/isa.h"
#include "support/approx.h"
#include "support/isas.h"
#include "support/kernel_probes.h"

namespace plenoflame::kernel_exp_test {
namespace {

template <class Real>
test::KernelProbe<Real> probe(Isa isa) {
  for (const auto& candidate : test::kernel_probes<Real>())
    if (candidate.instruction_set() == isa) return candidate;
  throw std::logic_error("not supported by this processor");
}

template <class Real>
test::Exponentials<Real> run(Isa isa, const std::vector<Real>& in) {
  return probe<Real>(isa).exponentials(in);
}

template <class Real>
std::vector<Real> run_source(Isa isa, const std::vector<Real>& exponents,
                             const std::vector<Real>& weights, const std::vector<Real>& t) {
  return probe<Real>(isa).source(exponents, weights, t);
}

class KernelExp : public ::testing::TestWithParam<Isa> {};

template <class Real>
void check_special(Isa isa) {
  const Real inf = std::numeric_limits<Real>::infinity();
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  const std::vector<Real> x{0, -inf, nan, -800, -1e30f, inf, Real(-0.0)};
  const auto p = run(isa, x);
  EXPECT_EQ(p.exp[0], 1);
  EXPECT_EQ(p.expm1[0], 0);
  for (int i : {1, 2, 3, 4}) {
    EXPECT_EQ(p.exp[i], 0) << x[i];
    EXPECT_EQ(p.expm1[i], -1) << x[i];
  }
  EXPECT_TRUE(std::isfinite(p.exp[5]) && p.exp[5] > 1e38f);
  EXPECT_EQ(p.exp[6], 1);
  // As optical thickness: what is negative or NaN counts as none, infinity blocks everything.
  for (int i : {0, 1, 2, 3, 4, 6}) {
    EXPECT_EQ(p.transmittance[i], 1) << x[i];
    EXPECT_EQ(p.emissivity[i], 0) << x[i];
    EXPECT_EQ(p.far_weight[i], 0) << x[i];
    EXPECT_EQ(p.near_weight[i], 0) << x[i];
  }
  EXPECT_EQ(p.transmittance[5], 0);
  EXPECT_EQ(p.emissivity[5], 1);
  EXPECT_EQ(p.far_weight[5], 0);
  EXPECT_EQ(p.near_weight[5], 1);
}

TEST_P(KernelExp, SpecialValues) {
  check_special<float>(GetParam());
  check_special<double>(GetParam());
}

// Optical thickness in units of ln 2, against long double.
template <class Real>
void check_halvings(Isa isa, double ulps) {
  const Real inf = std::numeric_limits<Real>::infinity();
  const Real most = std::is_same_v<Real, float> ? 126 : 1022;
  std::vector<Real> h{0, -1, -inf, std::numeric_limits<Real>::quiet_NaN(), inf, most + 2};
  const std::size_t special = h.size();
  for (double x = 1e-30; x < 1.0; x *= 1.003) h.push_back(static_cast<Real>(x));
  for (Real x = 1; x < most; x += Real(0.00713)) h.push_back(x);
  const auto p = probe<Real>(isa).of_halvings(h);
  for (std::size_t i = 0; i < special; ++i) {
    EXPECT_EQ(p.transmittance[i], i < 4 ? 1 : 0) << h[i];
    EXPECT_EQ(p.emissivity[i], i < 4 ? 0 : 1) << h[i];
  }
  const double ulp = ulps * static_cast<double>(std::numeric_limits<Real>::epsilon());
  for (std::size_t i = special; i < h.size(); ++i) {
    const long double x = h[i];
    ASSERT_TRUE(test::relative(static_cast<double>(p.transmittance[i]),
                               static_cast<double>(std::exp2(-x)), ulp))
        << h[i];
    ASSERT_TRUE(test::relative(static_cast<double>(p.emissivity[i]),
                               static_cast<double>(-std::expm1(-x * std::log(2.0L))), ulp))
        << h[i];
  }
}

TEST_P(KernelExp, Halvings) {
  check_halvings<float>(GetParam(), 1.2);
  check_halvings<double>(GetParam(), 1.2);
}

// The weights as numbers: mpmath, 80 digits.
struct WeightRow {
  double tau, transmittance, emissivity, far_weight, near_weight;
};
constexpr WeightRow kWeights[] = {
    {1e-12, 9.99999999999e-1, 9.9999999999949998e-13, 4.99999999999666657e-13,
     4.99999999999833323e-13},
    {3e-9, 9.99999997000000004e-1, 2.99999999549999998e-9, 1.49999999699999999e-9,
     1.49999999849999999e-9},
    {1e-6, 9.999990000005e-1, 9.99999500000166621e-7, 4.99999666666791644e-7,
     4.99999833333374977e-7},
    {0.001, 9.99000499833374992e-1, 9.99500166625008353e-4, 4.99666791633340287e-4,
     4.99833374991668066e-4},
    {0.01, 9.90049833749168053e-1, 9.95016625083194663e-3, 4.96679133402658914e-3,
     4.98337491680535749e-3},
    {0.1, 9.04837418035959568e-1, 9.51625819640404319e-2, 4.67884016044446976e-2,
     4.83741803595957342e-2},
    {0.5, 6.06530659712633424e-1, 3.93469340287366576e-1, 1.80408020862099729e-1,
     2.13061319425266847e-1},
    {1, 3.67879441171442322e-1, 6.32120558828557678e-1, 2.64241117657115357e-1,
     3.67879441171442322e-1},
    {1.25, 2.865047968601901e-1, 7.134952031398099e-1, 2.84291365651657819e-1,
     4.2920383748815208e-1},
    {1.4990234375, 2.23348167126844071e-1, 7.76651832873155929e-1, 2.94757029525997409e-1,
     4.8189480334715852e-1},
    {1.5, 2.23130160148429829e-1, 7.76869839851570171e-1, 2.94783066419283618e-1,
     4.82086773432286553e-1},
    {1.5009765625, 2.22912365963535447e-1, 7.77087634036464553e-1, 2.94808998547420767e-1,
     4.82278635489043785e-1},
    {2, 1.35335283236612692e-1, 8.64664716763387308e-1, 2.96997075145080962e-1,
     5.67667641618306346e-1},
    {3.7, 2.47235264703393868e-2, 9.75276473529660613e-1, 2.38864709618758064e-1,
     7.3641176391090255e-1},
    {10, 4.53999297624848515e-5, 9.99954600070237515e-1, 9.99500600772612667e-2,
     9.00004539992976248e-1},
    {30, 9.3576229688401746e-14, 9.99999999999906424e-1, 3.33333333332366379e-2,
     9.66666666666669786e-1},
    {86, 4.47377930618112073e-38, 1.0, 1.1627906976744186e-2, 9.88372093023255814e-1},
    {1e3, 0, 1.0, 1.0e-3, 9.99e-1},
    {1e6, 0, 1.0, 1.0e-6, 9.99999e-1},
};

TEST_P(KernelExp, LinearSourceWeightsOfMpmath) {
  std::vector<double> tau;
  for (const WeightRow& row : kWeights) tau.push_back(row.tau);
  const auto p = run(GetParam(), tau);
  for (std::size_t i = 0; i < tau.size(); ++i) {
    const WeightRow& row = kWeights[i];
    EXPECT_TRUE(test::relative(p.transmittance[i], row.transmittance, 3e-16)) << row.tau;
    EXPECT_TRUE(test::relative(p.emissivity[i], row.emissivity, 4e-16)) << row.tau;
    EXPECT_TRUE(test::relative(p.far_weight[i], row.far_weight, 9e-16)) << row.tau;
    EXPECT_TRUE(test::relative(p.near_weight[i], row.near_weight, 6e-16)) << row.tau;
  }
}

// Neighbouring numbers to both sides of the switch between polynomial and closed form: the step
// there is no larger than the rounding elsewhere.
template <class Real>
void check_switch(Isa isa) {
  std::vector<Real> tau{Real(1.5)};
  for (int i = 0; i < 200; ++i) tau.push_back(std::nextafter(tau.back(), Real(2)));
  std::vector<Real> below{Real(1.5)};
  for (int i = 0; i < 200; ++i) below.push_back(std::nextafter(below.back(), Real(1)));
  tau.insert(tau.begin(), below.rbegin(), below.rend() - 1);
  const auto p = run(isa, tau);
  const Real ulp_of_scale = std::numeric_limits<Real>::epsilon() / 2;  // weights lie below 1
  for (std::size_t i = 1; i < tau.size(); ++i) {
    const Real limit = (tau[i] == Real(1.5) ? 2 : 3) * ulp_of_scale;
    EXPECT_LE(std::fabs(p.far_weight[i] - p.far_weight[i - 1]), limit) << tau[i];
    EXPECT_LE(std::fabs(p.near_weight[i] - p.near_weight[i - 1]), limit) << tau[i];
  }
}

TEST_P(KernelExp, NoJumpAcrossTheSwitch) {
  check_switch<float>(GetParam());
  check_switch<double>(GetParam());
}

TEST_P(KernelExp, SourcesAddAndTotalIsStefanBoltzmann) {
  const auto two = run_source<double>(GetParam(), {1e4, 2e4}, {3.0, 5.0}, {1500.0});
  EXPECT_TRUE(
      test::relative(two[0], 3 / std::expm1(1e4 / 1500) + 5 / std::expm1(2e4 / 1500), 1e-14));
  const auto total = run_source<double>(GetParam(), {}, {}, {1650.0, 0.0, -1.0});
  EXPECT_TRUE(test::relative(
      total[0], constants::stefan_boltzmann * std::pow(1650.0, 4) / constants::pi, 1e-15));
  EXPECT_EQ(total[1], 0);
  EXPECT_EQ(total[2], 0);
  const double inf = std::numeric_limits<double>::infinity();
  for (const double garbage : {0.0, -300.0, std::nan(""), -inf})
    EXPECT_EQ(run_source<double>(GetParam(), {1e4}, {3.0}, {garbage})[0], 0) << garbage;
  EXPECT_TRUE(std::isfinite(run_source<float>(GetParam(), {1e4f}, {3.0f}, {HUGE_VALF})[0]));
}

INSTANTIATE_TEST_SUITE_P(Isas, KernelExp, ::testing::ValuesIn(test::supported_isas()),
                         [](const auto& i) { return std::string(name(i.param)); });

}  // namespace
}  // namespace plenoflame::kernel_exp_test
