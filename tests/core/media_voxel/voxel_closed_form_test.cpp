// Closed forms. These were seen to fail with: the gradient term dropped, a Gauss node moved by 1 %,
// the near and far weights swapped, an interval's length taken 1e-6 too long, or a wrong term in
// the series for thin intervals.
#include <gtest/gtest.h>

#include "plenoflame/base/constants.h"
#include "voxel_fixture.h"

namespace plenoflame::test::voxel_closed_form_test {
namespace {

constexpr double kSigmaOverPi = 5.670374419184429453e-8 / 3.14159265358979323846;

double total(double t) {
  return kSigmaOverPi * t * t * t * t;
}

// Both fields on [low, high)^3 of 1 mm voxels.
std::unique_ptr<Medium> medium_of(const SampleFunction& temperature, const SampleFunction& kappa,
                                  std::array<int, 3> high, VoxelInterpolation mode,
                                  const AffineTransform& transform = scaled(1e-3)) {
  return make_voxel_medium(make_field({0, 0, 0}, high, temperature, transform),
                           make_field({0, 0, 0}, high, kappa, transform), mode,
                           {SourceFunction::total()});
}

TEST(VoxelClosedForm, ConstantVoxelsAreExactSlabs) {
  // Voxels of 5 different slabs along x; the closed form is the sum over slabs.
  const double temperatures[5] = {1200, 300, 1900, 0, 1650};
  const double kappas[5] = {30, 1e-9, 1e5, 40, 1e-3};
  const auto medium = medium_of([&](int i, int, int) { return float(temperatures[i]); },
                                [&](int i, int, int) { return float(kappas[i]); }, {5, 16, 16},
                                VoxelInterpolation::constant);
  const Ray forward{{-1, 7.3e-3, 8.1e-3}, {1, 0, 0}}, backward{{1, 7.3e-3, 8.1e-3}, {-1, 0, 0}};
  const double slanted = 1 / std::sqrt(2.0);
  const Ray diagonal{{-1e-3, 4e-3, 8.1e-3}, {slanted, slanted, 0}};
  const Seen seen = see<double>(*medium, {forward, backward, diagonal}, with(Isa::baseline, false));
  for (int r = 0; r < 3; ++r) {
    double radiance = 0, tau = 0;
    for (int s = 0; s < 5; ++s) {
      const int i = r == 1 ? 4 - s : s;
      const double thickness = float(kappas[i]) * 1e-3 * (r == 2 ? 1 / slanted : 1);
      radiance += total(temperatures[i]) * std::exp(-tau) * -std::expm1(-thickness);
      tau += thickness;
    }
    EXPECT_TRUE(relative(seen.radiance[0][r], radiance, 1e-13)) << r;
    EXPECT_TRUE(relative(seen.transmittance[r], std::exp(-tau), 2e-13)) << r;
  }
}

TEST(VoxelClosedForm, IsothermalFollowsTheOpticalThickness) {
  // kappa linear along x and constant across: tau = (k0 + k1)/2 per cell, exactly.
  const auto kappa = [](int i, int, int) { return float(10 + 7 * i); };
  const auto medium = medium_of([](int, int, int) { return 1500.0f; }, kappa, {32, 16, 16},
                                VoxelInterpolation::trilinear);
  const Ray ray{{-0.5, 7.3e-3, 8.1e-3}, {1, 0, 0}};
  const Seen seen = see<double>(*medium, {ray}, with(Isa::baseline));
  double tau = 0.5e-3 * (kappa(0, 0, 0) + kappa(31, 0, 0));  // the cells that fall to 0 outside
  for (int i = 0; i + 1 < 32; ++i) tau += 0.5e-3 * (kappa(i, 0, 0) + kappa(i + 1, 0, 0));
  EXPECT_TRUE(relative(seen.transmittance[0], std::exp(-tau), 1e-13));
  // The end cells' temperature falls to 0: isothermal only from sample 0 to 31.
  const Seen inside = see<double>(*medium, {ray}, with(Isa::baseline), 0.5, 0.531);
  double inner = 0;
  for (int i = 0; i + 1 < 32; ++i) inner += 0.5e-3 * (kappa(i, 0, 0) + kappa(i + 1, 0, 0));
  EXPECT_TRUE(relative(inside.radiance[0][0], -std::expm1(-inner) * total(1500), 1e-12));
}

TEST(VoxelClosedForm, OpticalThicknessIsTheExactCubic) {
  // kappa = x y z at the samples is x y z between them as well; along (1,1,1)/sqrt3 from (a,b,c)
  // tau is the integral of a cubic.
  const auto medium = medium_of([](int, int, int) { return 1500.0f; },
                                [](int i, int j, int k) { return float(i * j * k); }, {24, 24, 24},
                                VoxelInterpolation::trilinear);
  const double s = 1 / std::sqrt(3.0);
  const double a = 1.3, b = 2.6, c = 0.4;  // start, in voxels
  const double length = 19;                // along each axis
  const Ray ray{{a * 1e-3, b * 1e-3, c * 1e-3}, {s, s, s}};
  const double e1 = a + b + c, e2 = a * b + b * c + c * a, e3 = a * b * c;
  const double integral = std::pow(length, 4) / 4 + e1 * std::pow(length, 3) / 3 +
                          e2 * length * length / 2 + e3 * length;
  const double tau = integral * 1e-3 / s;
  // Segments of the ray: the whole one is opaque, so scale by cutting it in the thin beginning.
  const double t_far = length * 1e-3 / s;
  const Seen seen = see<double>(*medium, {ray}, with(Isa::baseline, false), 0, t_far);
  EXPECT_TRUE(relative(-std::log(seen.transmittance[0]), tau, 1e-12));
  EXPECT_TRUE(relative(seen.radiance[0][0], -std::expm1(-tau) * total(1500), 1e-12));
}

TEST(VoxelClosedForm, AnyOpticalThickness) {
  // One isothermal slab from 1e-12 to 1e6 per cell, both precisions.
  for (double per_cell = 1e-12; per_cell < 2e6; per_cell *= 10) {
    const float kappa = static_cast<float>(per_cell * 1e3);
    const auto medium =
        medium_of([](int, int, int) { return 1700.0f; }, [&](int, int, int) { return kappa; },
                  {16, 16, 16}, VoxelInterpolation::constant);
    const Ray ray{{-0.2, 7.3e-3, 8.1e-3}, {1, 0, 0}};
    const double tau = 16e-3 * double(kappa);
    for (const bool skip : {true, false}) {
      const Seen seen = see<double>(*medium, {ray}, with(Isa::baseline, skip));
      EXPECT_TRUE(
          relative(seen.radiance[0][0], -std::expm1(-tau) * total(1700), skip ? 1.1e-7 : 1e-13))
          << tau;
      EXPECT_TRUE(tau > 700
                      ? seen.transmittance[0] < 1e-7
                      : relative(seen.transmittance[0], std::exp(-tau), 1e-12 + 1e-13 * tau) ||
                            (skip && seen.transmittance[0] < 1e-7))
          << tau;
      for (const Isa isa : supported_isas()) {
        const Seen single = see<float>(*medium, {ray}, with(isa, skip));
        EXPECT_TRUE(relative(single.radiance[0][0], -std::expm1(-tau) * total(1700), 2e-6)) << tau;
      }
    }
  }
}

TEST(VoxelClosedForm, LinearSourceInOpticalThickness) {
  // kappa constant and T^4 linear at two neighbouring samples only holds for the total source when
  // T is linear; so compare with the integral of sigma T^4/pi e^-tau, T = T0 + g x, by its
  // recurrence: I_n = integral of x^n e^-kx.
  const double kappa = 800;
  const auto medium = medium_of([](int i, int, int) { return float(1000 + 25 * i); },
                                [&](int, int, int) { return float(kappa); }, {33, 8, 8},
                                VoxelInterpolation::trilinear);
  const double length = 24e-3, gradient = 25e3, start = 1000 + 25 * 4;
  double moments[5];
  moments[0] = -std::expm1(-kappa * length) / kappa;
  for (int n = 1; n < 5; ++n)
    moments[n] = (n * moments[n - 1] - std::pow(length, n) * std::exp(-kappa * length)) / kappa;
  const double binomial[5] = {1, 4, 6, 4, 1};
  double radiance = 0;
  for (int n = 0; n < 5; ++n)
    radiance += kappa * kSigmaOverPi * binomial[n] * std::pow(start, 4 - n) *
                std::pow(gradient, n) * moments[n];
  const Ray ray{{4e-3, 3.5e-3, 4e-3}, {1, 0, 0}};
  const Seen seen = see<double>(*medium, {ray}, with(Isa::baseline, false), 0, length);
  // 24 cells of tau 0.8, S'' = 12 sigma/pi T^2 (dT/dtau)^2: fourth-order remainder.
  EXPECT_TRUE(relative(seen.radiance[0][0], radiance, 2e-5));
}

}  // namespace
}  // namespace plenoflame::test::voxel_closed_form_test
