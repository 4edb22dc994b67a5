// The references are the C library's long double functions (64-bit mantissa), which share no code
// with the kernels, and numbers from mpmath.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/isa.h"
#include "support/approx.h"

namespace plenoflame {

#define PLENOFLAME_DECLARE_PROBES(isa)                                                             \
  namespace isa {                                                                                  \
  void probe_exp_float(const float*, int, float*, float*, float*, float*, float*, float*);         \
  void probe_exp_double(const double*, int, double*, double*, double*, double*, double*, double*); \
  void probe_source_float(const float*, const float*, int, const float*, float*, int);             \
  void probe_source_double(const double*, const double*, int, const double*, double*, int);        \
  }
PLENOFLAME_DECLARE_PROBES(baseline)
#if defined(__x86_64__)
PLENOFLAME_DECLARE_PROBES(avx2)
PLENOFLAME_DECLARE_PROBES(avx512)
#endif

namespace {

template <class Real>
struct Probe {
  std::vector<Real> exp, expm1, transmittance, emissivity, far_weight, near_weight;
};

template <class Real, class Float, class Double, class... Args>
void call(Float f, Double d, Args... args) {
  if constexpr (std::is_same_v<Real, float>)
    f(args...);
  else
    d(args...);
}

template <class Real>
Probe<Real> run(Isa isa, const std::vector<Real>& in) {
  const auto n = static_cast<int>(in.size());
  const std::vector<Real> zero(in.size());
  Probe<Real> p{zero, zero, zero, zero, zero, zero};
  const auto with = [&](auto f, auto d) {
    call<Real>(f, d, in.data(), n, p.exp.data(), p.expm1.data(), p.transmittance.data(),
               p.emissivity.data(), p.far_weight.data(), p.near_weight.data());
  };
#if defined(__x86_64__)
  if (isa == Isa::avx512) with(avx512::probe_exp_float, avx512::probe_exp_double);
  if (isa == Isa::avx2) with(avx2::probe_exp_float, avx2::probe_exp_double);
#endif
  if (isa == Isa::baseline) with(baseline::probe_exp_float, baseline::probe_exp_double);
  return p;
}

template <class Real>
std::vector<Real> run_source(Isa isa, const std::vector<Real>& exponents,
                             const std::vector<Real>& weights, const std::vector<Real>& t) {
  std::vector<Real> out(t.size());
  const auto with = [&](auto f, auto d) {
    call<Real>(f, d, exponents.data(), weights.data(), static_cast<int>(exponents.size()), t.data(),
               out.data(), static_cast<int>(t.size()));
  };
#if defined(__x86_64__)
  if (isa == Isa::avx512) with(avx512::probe_source_float, avx512::probe_source_double);
  if (isa == Isa::avx2) with(avx2::probe_source_float, avx2::probe_source_double);
#endif
  if (isa == Isa::baseline) with(baseline::probe_source_float, baseline::probe_source_double);
  return out;
}

/// Error in units of the last place of the exact value.
template <class Real>
double ulps(Real actual, long double exact) {
  const Real rounded = std::fabs(static_cast<Real>(exact));
  const long double ulp = std::nextafter(rounded, std::numeric_limits<Real>::infinity()) - rounded;
  return static_cast<double>(std::fabs(static_cast<long double>(actual) - exact) / ulp);
}

/// psi - e^-tau by its Taylor series where the closed form cancels.
long double far_reference(long double t) {
  if (t >= 1) return -expm1l(-t) / t - expl(-t);
  long double sum = 0, term = t / 2;  // t^(k+1) (-1)^k / (k+2)!
  for (int k = 0; k < 40; ++k) {
    sum += (k + 1) * term;
    term *= -t / (k + 3);
  }
  return sum;
}
long double near_reference(long double t) {
  if (t >= 1) return 1 + expm1l(-t) / t;
  long double sum = 0, term = t / 2;
  for (int k = 0; k < 40; ++k) {
    sum += term;
    term *= -t / (k + 3);
  }
  return sum;
}

class KernelExp : public ::testing::TestWithParam<Isa> {
 protected:
  void SetUp() override {
    if (!is_supported(GetParam())) GTEST_SKIP() << "not supported by this processor";
  }
};

template <class Real>
void check_exponentials(Isa isa, double lowest, double highest) {
  std::vector<Real> x;
  for (int i = 0; i < 200000; ++i)
    x.push_back(static_cast<Real>(lowest + (highest - lowest) * i / 199999.0));
  for (double s = 1e-30; s < 1; s *= 1.001) {
    x.push_back(static_cast<Real>(s));
    x.push_back(static_cast<Real>(-s));
  }
  const auto p = run(isa, x);
  double worst_exp = 0, worst_expm1 = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    worst_exp = std::max(worst_exp, ulps(p.exp[i], expl(x[i])));
    worst_expm1 = std::max(worst_expm1, ulps(p.expm1[i], expm1l(x[i])));
  }
  std::printf("%s, %d bytes: exp %.2f ulp, expm1 %.2f ulp\n", std::string(name(isa)).c_str(),
              static_cast<int>(sizeof(Real)), worst_exp, worst_expm1);
  EXPECT_LE(worst_exp, 1.0);
  EXPECT_LE(worst_expm1, 2.0);
}

TEST_P(KernelExp, ExponentialsAreWithinTwoUlp) {
  check_exponentials<float>(GetParam(), -87.3, 88.0);
  check_exponentials<double>(GetParam(), -708.3, 709.0);
}

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

template <class Real>
void check_weights(Isa isa) {
  std::vector<Real> tau;
  for (double t = 1e-12; t < 1.1e6; t *= 1.0003) tau.push_back(static_cast<Real>(t));
  for (double t = 1.4; t < 1.6; t += 1e-5) tau.push_back(static_cast<Real>(t));
  const auto p = run(isa, tau);
  double worst[4] = {};
  for (std::size_t i = 0; i < tau.size(); ++i) {
    const long double t = tau[i];
    if (-t >= (sizeof(Real) == 4 ? -87.3L : -708.3L))
      worst[0] = std::max(worst[0], ulps(p.transmittance[i], expl(-t)));
    worst[1] = std::max(worst[1], ulps(p.emissivity[i], -expm1l(-t)));
    worst[2] = std::max(worst[2], ulps(p.far_weight[i], far_reference(t)));
    worst[3] = std::max(worst[3], ulps(p.near_weight[i], near_reference(t)));
    EXPECT_EQ(p.emissivity[i] <= 1 && p.transmittance[i] >= 0, true);
  }
  std::printf("%s, %d bytes: transmittance %.2f, emissivity %.2f, far %.2f, near %.2f ulp\n",
              std::string(name(isa)).c_str(), static_cast<int>(sizeof(Real)), worst[0], worst[1],
              worst[2], worst[3]);
  EXPECT_LE(worst[0], 1.0);
  EXPECT_LE(worst[1], 2.0);
  EXPECT_LE(worst[2], 4.0);
  EXPECT_LE(worst[3], 4.0);
}

TEST_P(KernelExp, LinearSourceWeightsFrom1em12To1e6) {
  check_weights<float>(GetParam());
  check_weights<double>(GetParam());
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

template <class Real>
void check_planck(Isa isa, double conditioning) {
  for (const double wavelength : {250e-9, 431e-9, 650e-9, 2e-6, 20e-6}) {
    const double c2 = constants::second_radiation / wavelength;
    const double w = constants::first_radiation / std::pow(wavelength, 5) * 1e-9;
    std::vector<Real> t;
    for (double k = 200; k <= 1e5; k *= 1.01) t.push_back(static_cast<Real>(k));
    const auto out = run_source<Real>(isa, {static_cast<Real>(c2)}, {static_cast<Real>(w)}, t);
    for (std::size_t i = 0; i < t.size(); ++i) {
      const long double x = static_cast<long double>(static_cast<Real>(c2)) / t[i];
      const long double exact = static_cast<long double>(static_cast<Real>(w)) / expm1l(x);
      const double eps = std::numeric_limits<Real>::epsilon();
      if (exact < std::numeric_limits<Real>::min()) {
        EXPECT_LT(out[i], std::numeric_limits<Real>::min());
        continue;
      }
      EXPECT_TRUE(test::relative(out[i], static_cast<double>(exact),
                                 conditioning * eps * (4 + static_cast<double>(x))))
          << wavelength << " m, " << t[i] << " K";
    }
  }
}

TEST_P(KernelExp, PlanckTermIsAccurateWhereverItCanBeRepresented) {
  check_planck<float>(GetParam(), 0.6);
  check_planck<double>(GetParam(), 0.6);
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

INSTANTIATE_TEST_SUITE_P(Isas, KernelExp, ::testing::Values(Isa::baseline, Isa::avx2, Isa::avx512),
                         [](const auto& i) { return std::string(name(i.param)); });

}  // namespace
}  // namespace plenoflame
