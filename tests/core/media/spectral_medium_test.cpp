// Media whose absorption depends on the channel, against grey ones of the same absorption.
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/media/layered_medium.h"
#include "plenoflame/media/voxel_medium.h"
#include "ray_list.h"
#include "support/approx.h"

namespace plenoflame::spectral_medium_test {
namespace {

using test::relative;

const std::vector<double> kFactors{1, 0.62, 1.9};

std::vector<SourceFunction> channels() {
  return {SourceFunction::band(650e-9, 10e-9), SourceFunction::band(850e-9, 40e-9),
          SourceFunction::band(450e-9, 50e-9)};
}

std::vector<EllipsoidLayer> layers(double factor, bool nested) {
  return {{{0, 0, 0.001}, {4e-3, 3e-3, 5e-3}, 1300, 40 * factor},
          {{0, 0.5e-3, 0}, {7e-3, 6e-3, 8e-3}, 1650, 90 * factor},
          {{nested ? 0 : 4e-3, 0, 0}, {10e-3, 10e-3, nested ? 10e-3 : 3e-3}, 1900, 15 * factor}};
}

VoxelField field(bool temperature, double factor) {
  VoxelField f;
  f.name = temperature ? "temperature" : "absorption";
  f.index_to_world.linear = {{Vec3{1e-3, 0, 0}, Vec3{0, 1e-3, 0}, Vec3{0, 0, 1e-3}}};
  f.background = temperature ? 300 : 0;
  for (const int corner : {-8, 0})
    for (const int other : {-8, 0}) f.brick_origins.push_back({corner, other, -8});
  for (const auto& origin : f.brick_origins)
    for (int i = 0; i < 512; ++i) {
      const double x = origin[0] + i / 64, y = origin[1] + i / 8 % 8, z = origin[2] + i % 8;
      const double r2 = (x * x + y * y + (z + 4) * (z + 4)) / 40;
      const double value = temperature ? 1000 + 800 * std::exp(-r2)
                                       : factor * 120 * std::exp(-2 * r2) * (r2 < 1 ? 1 : 0);
      f.values.push_back(static_cast<float>(value));
    }
  return f;
}

template <class Real>
test::RayList<Real> rays() {
  test::RayList<Real> list;
  for (int i = 0; i < 41; ++i) {
    const double a = 0.37 * i, b = 4e-3 * std::sin(1.3 * i);
    list.add({-0.5 * std::cos(a) - b * std::sin(a), -0.5 * std::sin(a) + b * std::cos(a), -2e-3},
             normalize({std::cos(a), std::sin(a), 0.004 * std::cos(2.1 * i)}));
  }
  return list;
}

/// Radiance and transmittance of every channel, those of a medium that is not grey.
template <class Real>
struct Seen {
  std::vector<Real> radiance, transmittance;
  Seen(const test::RayList<Real>& list, const Medium& medium) {
    const auto n = static_cast<int>(list.size());
    const int padded = (n + kRayPadding - 1) / kRayPadding * kRayPadding;
    const int count = medium.channel_count();
    radiance.resize(static_cast<std::size_t>(padded * count));
    transmittance.resize(radiance.size());
    std::vector<std::vector<Real>> columns(6, std::vector<Real>(static_cast<std::size_t>(padded)));
    for (int i = 0; i < padded; ++i) {
      const Ray ray = list.ray(static_cast<std::size_t>(std::min(i, n - 1)));
      const double values[6] = {ray.origin.x,    ray.origin.y,    ray.origin.z,
                                ray.direction.x, ray.direction.y, ray.direction.z};
      for (std::size_t k = 0; k < 6; ++k)
        columns[k][static_cast<std::size_t>(i)] = static_cast<Real>(values[k]);
    }
    RayBatch<Real> batch;
    batch.size = padded;
    batch.x = columns[0].data(), batch.y = columns[1].data(), batch.z = columns[2].data();
    batch.dx = columns[3].data(), batch.dy = columns[4].data(), batch.dz = columns[5].data();
    MediumCounters counters;
    medium.integrate(batch, {}, {radiance.data(), padded, transmittance.data(), padded}, counters);
  }
};

template <class Real, class Make>
void expect_channels_of_grey_media(Make make, double tolerance) {
  const auto list = rays<Real>();
  const auto all = make(1.0, channels(), kFactors);
  EXPECT_FALSE(all->is_grey());
  const Seen<Real> seen(list, *all);
  const std::size_t stride = seen.radiance.size() / 3;
  double lit = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto one = make(kFactors[c], {channels()[c]}, std::vector<double>{});
    EXPECT_TRUE(one->is_grey());
    const auto expected = list.integrate(*one);
    for (std::size_t i = 0; i < list.size(); ++i) {
      const auto e = static_cast<double>(expected.radiance[0][i]);
      lit += e > 0 ? 1 : 0;
      EXPECT_TRUE(relative(seen.radiance[c * stride + i], e, tolerance)) << c << " " << i;
      EXPECT_TRUE(
          relative(seen.transmittance[c * stride + i], expected.transmittance[i], tolerance))
          << c << " " << i;
    }
    // At a point, and by the reference integrator.
    double emission[3], absorption[3], alone[1];
    const Vec3 place{1e-3, 0.3e-3, -3e-3};
    all->coefficients(place, emission);
    all->absorptions(place, absorption);
    EXPECT_TRUE(relative(absorption[c], one->coefficients(place, alone), 1e-6));
    EXPECT_TRUE(relative(emission[c], alone[0], 1e-6));
  }
  EXPECT_GT(lit, 60);
  const auto first = seen.radiance.begin();
  const auto brightest = static_cast<std::size_t>(
      std::max_element(first, first + static_cast<std::ptrdiff_t>(list.size())) - first);
  const auto reference = integrate_reference(*all, list.ray(brightest), -1, 1);
  // Voxels are coarse here: their quadrature is of fourth order.
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_TRUE(relative(seen.radiance[c * stride + brightest], reference[c], 1e-3)) << c;
}

TEST(SpectralMedium, LayersNestedAndOverlapping) {
  for (const bool nested : {true, false}) {
    const auto make = [&](double factor, std::vector<SourceFunction> sources,
                          std::vector<double> factors) {
      return make_layered_medium(layers(factor, nested), {}, std::move(sources),
                                 std::move(factors));
    };
    expect_channels_of_grey_media<double>(make, 1e-12);
    expect_channels_of_grey_media<float>(make, 2e-5);
  }
}

TEST(SpectralMedium, Voxels) {
  const auto make = [&](double factor, std::vector<SourceFunction> sources,
                        std::vector<double> factors) {
    // One interval per cell: the channels of one medium share their steps.
    return make_voxel_medium(field(true, 1), field(false, factor), VoxelInterpolation::trilinear,
                             std::move(sources),
                             {.tolerance = 0, .absorption_factors = std::move(factors)});
  };
  expect_channels_of_grey_media<double>(make, 1e-6);  // samples are in single precision
  expect_channels_of_grey_media<float>(make, 3e-5);
}

TEST(SpectralMedium, OneGreyFlameInFrontOfOneThatIsNot) {
  const auto make = [&](double factor, std::vector<SourceFunction> sources,
                        std::vector<double> factors) {
    std::vector<std::shared_ptr<const Medium>> media;
    media.push_back(make_layered_medium(layers(factor, true), {}, sources, std::move(factors)));
    // It overlaps the outermost layer on some of the rays.
    media.push_back(make_layered_medium({{{8e-3, 0, -4e-3}, {4e-3, 4e-3, 4e-3}, 1500, 60}}, {},
                                        std::move(sources)));
    return make_composite_medium(std::move(media));
  };
  const auto list = rays<double>();
  const auto all = make(1.0, channels(), kFactors);
  const Seen<double> seen(list, *all);
  const std::size_t stride = seen.radiance.size() / 3;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto expected = list.integrate(*make(kFactors[c], {channels()[c]}, {}));
    for (std::size_t i = 0; i < list.size(); ++i) {
      EXPECT_TRUE(relative(seen.radiance[c * stride + i], expected.radiance[0][i], 1e-9));
      EXPECT_TRUE(relative(seen.transmittance[c * stride + i], expected.transmittance[i], 1e-9));
    }
  }
}

TEST(SpectralMedium, RefusesFactorsThatAreNone) {
  const auto made = [](std::vector<double> factors) {
    return make_layered_medium(layers(1, true), {}, channels(), std::move(factors));
  };
  EXPECT_THROW(made({1, 2}), InputError);
  EXPECT_THROW(made({1, 2, -1}), InputError);
  EXPECT_THROW(made({1, 2, std::nan("")}), InputError);
  EXPECT_TRUE(made({1, 1, 1})->is_grey());
}

}  // namespace
}  // namespace plenoflame::spectral_medium_test
