// The roots that kernels take without a division, against those of the standard library in extended
// precision.
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "plenoflame/base/isa.h"
#include "support/approx.h"
#include "support/isas.h"

namespace plenoflame {

#define PLENOFLAME_ROOT_PROBES                                 \
  void probe_roots(const float*, int, float*, float*, float*); \
  void probe_roots(const double*, int, double*, double*, double*);
namespace baseline {
PLENOFLAME_ROOT_PROBES
}
#if defined(__x86_64__)
namespace avx2 {
PLENOFLAME_ROOT_PROBES
}
namespace avx512 {
PLENOFLAME_ROOT_PROBES
}
#endif

namespace test {
namespace {

template <class Real>
struct Roots {
  std::vector<Real> inverse, near, rough;
};

template <class Real>
Roots<Real> roots_of([[maybe_unused]] Isa isa, const std::vector<Real>& in) {
  Roots<Real> out;
  for (std::vector<Real>* values : {&out.inverse, &out.near, &out.rough}) values->resize(in.size());
  const int size = static_cast<int>(in.size());
  using Kernel = void (*)(const Real*, int, Real*, Real*, Real*);
  Kernel kernel = baseline::probe_roots;
#if defined(__x86_64__)
  if (isa == Isa::avx512) kernel = avx512::probe_roots;
  if (isa == Isa::avx2) kernel = avx2::probe_roots;
#endif
  kernel(in.data(), size, out.inverse.data(), out.near.data(), out.rough.data());
  return out;
}

/// Steps through two octaves, which is what the errors repeat in, and through all of the range.
template <class Real>
std::vector<Real> places() {
  std::vector<Real> x;
  constexpr int kSteps = 100000;
  for (int i = 0; i < kSteps; ++i) x.push_back(static_cast<Real>(1 + 3.0 * i / kSteps));
  for (double exponent = -37; exponent < 38; exponent += 0.01)
    x.push_back(static_cast<Real>(std::pow(10, exponent)));
  return x;
}

template <class Real>
void check_roots(double inverse_tolerance) {
  const std::vector<Real> x = places<Real>();
  for (const Isa isa : supported_isas()) {
    const Roots<Real> roots = roots_of(isa, x);
    double worst_near = 0, worst_rough = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const long double root = std::sqrt(static_cast<long double>(x[i]));
      ASSERT_TRUE(relative(static_cast<double>(roots.inverse[i] * root), 1, inverse_tolerance))
          << x[i];
      const auto error = [&](Real value) {
        return static_cast<double>(std::fabs(static_cast<long double>(value) / root - 1));
      };
      worst_near = std::fmax(worst_near, error(roots.near[i]));
      worst_rough = std::fmax(worst_rough, error(roots.rough[i]));
    }
    // As good as they are said to be, and not better: else their place would be another one's.
    EXPECT_LT(worst_near, 6.6e-4);
    EXPECT_GT(worst_near, 6e-4);
    EXPECT_LT(worst_rough, 0.0355);
    EXPECT_GT(worst_rough, 0.03);
    const Roots<Real> of_nothing = roots_of(isa, std::vector<Real>(16, 0));
    for (std::size_t i = 0; i < 16; ++i) {
      EXPECT_TRUE(std::isfinite(of_nothing.inverse[i]));
      EXPECT_EQ(of_nothing.near[i], 0);
      EXPECT_TRUE(std::isfinite(of_nothing.rough[i]));
    }
  }
}

TEST(KernelRoots, AreAsGoodAsTheySay) {
  check_roots<float>(2e-7);
  check_roots<double>(4 * std::numeric_limits<double>::epsilon());
}

// Roots that are only to be near are the same for both precisions: they draw the same rays.
TEST(KernelRoots, AreTheSameInBothPrecisions) {
  const std::vector<float> x = places<float>();
  const Roots<float> single = roots_of(Isa::baseline, x);
  for (const Isa isa : supported_isas()) {
    const Roots<double> both = roots_of(isa, std::vector<double>(x.begin(), x.end()));
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_TRUE(relative(both.near[i], static_cast<double>(single.near[i]), 3e-7));
      ASSERT_EQ(both.rough[i], static_cast<double>(single.rough[i]));
    }
  }
}

}  // namespace
}  // namespace test
}  // namespace plenoflame
