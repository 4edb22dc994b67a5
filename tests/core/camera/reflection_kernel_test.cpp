// The vector kernels' transmission of a surface, in real numbers, against that by complex
// amplitudes.
#include <gtest/gtest.h>

#include <cmath>

#include "optics/reflection.h"
#include "optics/reflection_kernel.h"
#include "support/approx.h"

namespace plenoflame::reflection_kernel_test {
namespace {

using test::relative;

template <class Real>
double kernel_transmission(const Coating& c, double cos_in) {
  const double sine = c.before / c.behind * std::sqrt(1 - cos_in * cos_in);
  return static_cast<double>(scalar::transmission<Real>(
      {static_cast<Real>(c.before), static_cast<Real>(c.layer), static_cast<Real>(c.behind),
       static_cast<Real>(c.phase)},
      static_cast<Real>(cos_in), static_cast<Real>(std::sqrt(1 - sine * sine))));
}

// All angles up to grazing, into glass and out of it, bare and with layers of any thickness.
TEST(ReflectionKernel, AgreesWithComplexAmplitudes) {
  int checked = 0;
  for (const Coating& coating :
       {Coating{1, 1, 1.5, 0}, Coating{1.7, 1.7, 1, 0}, Coating{1.5, 1.5, 1.8, 0},
        Coating{1, 1.38, 1.5, 1}, Coating{1, 1.38, 1.9, 0.37}, Coating{1.6, 1.38, 1, 1.3},
        Coating{1.6, 2.3, 1, 2.9}, Coating{1, 2.3, 1.5, 17.4}})
    for (double angle = 0; angle < 1.5; angle += 0.05) {
      const double cosine = std::cos(angle);
      // Short of total reflection, which the kernels are not asked for.
      if (coating.before / coating.behind * std::sin(angle) > 0.995) continue;
      const double expected = surface_transmission(coating, cosine);
      EXPECT_TRUE(relative(kernel_transmission<double>(coating, cosine), expected, 1e-9))
          << coating.before << " " << coating.layer << " " << coating.behind << " " << angle;
      EXPECT_TRUE(relative(kernel_transmission<float>(coating, cosine), expected, 2e-4));
      ++checked;
    }
  EXPECT_GT(checked, 150);
}

}  // namespace
}  // namespace plenoflame::reflection_kernel_test
