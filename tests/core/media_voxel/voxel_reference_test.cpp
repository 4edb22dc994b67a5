// Against the adaptive integrator of voxel_fixture.h, which shares no code with the medium.
#include <gtest/gtest.h>

#include "voxel_fixture.h"

namespace plenoflame::test::voxel_reference_test {
namespace {

constexpr double kWavelength = 650e-9, kWidth = 10e-9;

// Smooth fields: a Gaussian blob of absorption with a hot rim, `n` samples over 16 mm.
struct Blob {
  double spacing;
  float temperature(int i, int j, int k) const {
    return static_cast<float>(1500 + 300 * std::exp(-square(i, j, k) / 18e-6));
  }
  float absorption(int i, int j, int k) const {
    const double r2 = square(i, j, k);
    return r2 > 49e-6 ? 0.0f : static_cast<float>(120 * std::exp(-r2 / 10e-6));
  }
  double square(int i, int j, int k) const {
    const double x = (i + 0.3) * spacing - 8e-3, y = (j + 0.1) * spacing - 8e-3,
                 z = (k - 0.2) * spacing - 8e-3;
    return x * x + 1.3 * y * y + z * z;
  }
};

struct Fields {
  VoxelField temperature, absorption;
  std::unique_ptr<Medium> medium(VoxelInterpolation mode,
                                 std::vector<SourceFunction> channels) const {
    return make_voxel_medium(temperature, absorption, mode, std::move(channels));
  }
};

Fields blob_fields(int n, const AffineTransform& transform) {
  const Blob blob{16e-3 / n};
  return {make_field(
              {-2, -2, -2}, {n + 2, n + 2, n + 2},
              [&](int i, int j, int k) { return blob.temperature(i, j, k); }, transform, 300),
          make_field(
              {0, 0, 0}, {n, n, n}, [&](int i, int j, int k) { return blob.absorption(i, j, k); },
              transform)};
}

AffineTransform placed(Vec3 angles, Vec3 spacing, Vec3 translation) {
  AffineTransform t;
  t.linear =
      rotation_xyz(angles) * Mat3{{{{spacing.x, 0, 0}, {0, spacing.y, 0}, {0, 0, spacing.z}}}};
  t.translation = translation;
  return t;
}

// Rays given by two index coordinates that they pass.
Ray ray_through(const AffineTransform& transform, Vec3 a, Vec3 b, double back) {
  const Vec3 p = transform.point(a), d = normalize(transform.point(b) - p);
  return {p - back * d, d};
}

TEST(VoxelReference, SmoothFieldsTrilinear) {
  const auto transform = scaled(1e-3);
  const Fields f = blob_fields(16, transform);
  const auto medium = f.medium(VoxelInterpolation::trilinear,
                               {SourceFunction::total(), SourceFunction::band(kWavelength, 1e-12)});
  const std::vector<Ray> rays{ray_through(transform, {-3, 4.2, 5.1}, {19, 9.3, 8.7}, 0.1),
                              ray_through(transform, {8, 8, 30}, {8.1, 7.7, 3}, 0.2),
                              ray_through(transform, {13, 2, 5}, {1, 12, 11}, 0.3)};
  const Seen seen = see<double>(*medium, rays, with(Isa::baseline));
  const Source line = line_source(kWavelength, 1e-12);
  for (std::size_t r = 0; r < rays.size(); ++r) {
    const auto total =
        integrate_voxels({f.temperature, f.absorption, VoxelInterpolation::trilinear}, rays[r],
                         {0, 1}, total_source);
    const auto band = integrate_voxels({f.temperature, f.absorption, VoxelInterpolation::trilinear},
                                       rays[r], {0, 1}, line);
    EXPECT_TRUE(relative(-std::log(seen.transmittance[r]), double(total.optical_thickness), 1e-12));
    // The error that two nodes per cell leave on this coarse grid, less for T^4 than for the steep
    // band.
    EXPECT_TRUE(relative(seen.radiance[0][r], double(total.radiance), 6e-6)) << r;
    EXPECT_TRUE(relative(seen.radiance[1][r], double(band.radiance), 4e-5)) << r;
  }
}

TEST(VoxelReference, FourthOrderInTheCellSize) {
  // The same trilinear fields (an n^3 grid) on grids refined 2 and 4 times, which changes the cells
  // but not the fields: the error must fall 16 times each. Thick and thin.
  for (const double strength : {1.0, 30.0}) {
    const int n = 8;
    const auto coarse_t = [](double x, double y, double z) {
      return 1300 + 40 * x + 25 * y - 30 * z + 3 * x * y;
    };
    const auto coarse_k = [&](double x, double y, double z) {
      return strength * (1 + x * (n - x) * 0.7 + 0.3 * y * z);
    };
    double errors[3];
    for (int refine = 1, e = 0; e < 3; refine *= 2, ++e) {
      // x (n - x) is not trilinear, but both fields are smooth: the reference uses each own grid.
      const auto transform = scaled(1e-3 / refine);
      const auto box = std::array<int, 3>{n * refine + 1, n * refine + 1, n * refine + 1};
      const Fields f{
          make_field(
              {0, 0, 0}, box,
              [&](int i, int j, int k) {
                return float(coarse_t(double(i) / refine, double(j) / refine, double(k) / refine));
              },
              transform, 1300),
          make_field(
              {0, 0, 0}, box,
              [&](int i, int j, int k) {
                return float(coarse_k(double(i) / refine, double(j) / refine, double(k) / refine));
              },
              transform)};
      const auto medium =
          f.medium(VoxelInterpolation::trilinear, {SourceFunction::band(kWavelength, 1e-12)});
      errors[e] = 0;
      for (int r = 0; r < 8; ++r) {
        const Ray ray =
            ray_through(transform, {0.01 * refine, (1.1 + 0.7 * r) * refine, 3.3 * refine},
                        {(n - 0.02) * refine, (6.7 - 0.6 * r) * refine, 5.1 * refine}, 0);
        const double length = (n - 0.1) * 1e-3;
        const Seen seen = see<double>(*medium, {ray}, with(Isa::baseline, false), 0, length);
        const auto exact =
            integrate_voxels({f.temperature, f.absorption, VoxelInterpolation::trilinear}, ray,
                             {0, length}, line_source(kWavelength, 1e-12));
        errors[e] += std::fabs(seen.radiance[0][0] / double(exact.radiance) - 1);
      }
    }
    EXPECT_GT(std::log2(errors[0] / errors[1]), 3.6) << strength << " " << errors[0];
    EXPECT_GT(std::log2(errors[1] / errors[2]), 3.6) << strength << " " << errors[1];
  }
}

TEST(VoxelReference, RotatedStretchedAndFarAway) {
  const Vec3 angles{0.3, -0.7, 1.1};
  const std::vector<AffineTransform> transforms{
      placed(angles, {1e-3, 1e-3, 1e-3}, {0.1, 0.2, -0.3}),
      placed({0, 0, 0.78539816339744830962}, {1e-3, 2e-3, 0.5e-3}, {5, -7, 2}),
      placed(angles, {1e-3, 1e-6, 1e-3}, {}),  // aspect 1e-3
      placed(angles, {1e-6, 1e-3, 1e-3}, {1, 1, 1}),
      placed(angles, {1, 1e-3, 1e-3}, {}),                   // aspect 1e3
      placed(angles, {1e-3, 1e-3, 1e-3}, {1e3, -1e3, 1e3}),  // 1e6 voxels away
  };
  for (const auto& transform : transforms) {
    const Fields f = blob_fields(16, transform);
    const auto medium = f.medium(VoxelInterpolation::trilinear, {SourceFunction::total()});
    for (int r = 0; r < 6; ++r) {
      const Ray ray = ray_through(transform, {-1, 3.2 + r, 5.1}, {17, 11.3 - r, 7.7}, 0);
      const Vec3 anchor = transform.point({8, 8, 8});
      const double scale = length(transform.point({17, 11.3 - r, 7.7}) - ray.origin);
      const auto exact =
          integrate_voxels({f.temperature, f.absorption, VoxelInterpolation::trilinear}, ray,
                           {0, scale}, total_source);
      const Seen seen = see<double>(*medium, {ray}, with(Isa::baseline), 0, scale, anchor);
      // Two nodes per cell: cells are up to 1 m long, and opaque, where the aspect is 1000.
      const double truncation = scale > 1 ? 5e-4 : 6e-6;
      EXPECT_TRUE(relative(seen.radiance[0][0], double(exact.radiance), truncation)) << r;
      // Optical thickness is exact: at 1e6 voxels from the origin a double holds 1e-10 of a voxel.
      const double tau = double(exact.optical_thickness);
      if (tau < 16) {
        EXPECT_TRUE(relative(-std::log(seen.transmittance[0]), tau, 1e-9)) << r;
      }
      for (const Isa isa : supported_isas()) {
        const Seen single = see<float>(*medium, {ray}, with(isa), 0, scale, anchor);
        EXPECT_TRUE(relative(single.radiance[0][0], seen.radiance[0][0], 1e-5)) << r;
        if (tau < 16) {
          EXPECT_TRUE(relative(-std::log(single.transmittance[0]), tau, 1e-5)) << r;
        }
      }
    }
  }
}

TEST(VoxelReference, FacesEdgesCornersAndZeroComponents) {
  const auto transform = scaled(1e-3);
  const Fields f = blob_fields(16, transform);
  const auto medium = f.medium(VoxelInterpolation::trilinear, {SourceFunction::total()});
  const std::vector<Ray> rays{
      ray_through(transform, {-3, 8, 5.5}, {20, 8, 5.5}, 0),  // in a brick face
      ray_through(transform, {-3, 8, 8}, {20, 8, 8}, 0),      // along a brick edge
      ray_through(transform, {20, 8, 8}, {-3, 8, 8}, 0),
      ray_through(transform, {7, -3, 9}, {7, 20, 9}, 0),  // along a cell edge
      ray_through(transform, {6.5, 7.25, -3}, {6.5, 7.25, 20}, 0),
      ray_through(transform, {-2, -2, -2}, {18, 18, 18}, 0),  // through corners
      ray_through(transform, {18, 18, 18}, {-2, -2, -2}, 0),
      ray_through(transform, {-2, 18, 8}, {18, -2, 8}, 0),  // through edges, in a face
      ray_through(transform, {-1, 8, 8.0000001}, {17, 8.0000001, 8}, 0),
      ray_through(transform, {8, 8, 8}, {8, 8, 9}, 0),          // starts at a corner
      ray_through(transform, {7.3, 6.1, 8.7}, {9, 3, 8.7}, 0),  // starts inside a cell
      ray_through(transform, {7.3, 6.1, 8.7}, {9, 3, 8.7}, 0.05),
  };
  const Seen seen = see<double>(*medium, rays, with(Isa::baseline), 0, 1);
  for (std::size_t r = 0; r < rays.size(); ++r) {
    const auto exact =
        integrate_voxels({f.temperature, f.absorption, VoxelInterpolation::trilinear}, rays[r],
                         {0, 1}, total_source);
    // Two nodes per cell; a diagonal crosses cells over 1.7 spacings, where the fields are cubic.
    EXPECT_TRUE(
        relative(seen.radiance[0][r], double(exact.radiance), r == 5 || r == 6 ? 2e-4 : 3e-5))
        << r;
    EXPECT_TRUE(relative(seen.transmittance[r], std::exp(-double(exact.optical_thickness)), 1e-12))
        << r;
    for (const Isa isa : supported_isas()) {
      const Seen single = see<float>(*medium, {rays[r]}, with(isa), 0, 1, {8e-3, 8e-3, 8e-3});
      EXPECT_TRUE(relative(single.radiance[0][0], seen.radiance[0][r], 3e-6)) << r;
    }
  }
}

TEST(VoxelReference, ConstantModeMatchesEveryVoxel) {
  const auto transform = placed({0.4, 0.2, -0.9}, {1e-3, 0.7e-3, 1.3e-3}, {0.01, 0, 0.02});
  const Fields f = blob_fields(16, transform);
  const auto medium = f.medium(VoxelInterpolation::constant, {SourceFunction::total()});
  for (int r = 0; r < 6; ++r) {
    const Ray ray = ray_through(transform, {-3, 2.2 + r, 5.1}, {19, 11.3 - r, 8.7}, 0.1);
    const auto exact = integrate_voxels({f.temperature, f.absorption, VoxelInterpolation::constant},
                                        ray, {0, 1}, total_source);
    const Seen seen = see<double>(*medium, {ray}, with(Isa::baseline));
    EXPECT_TRUE(relative(seen.radiance[0][0], double(exact.radiance), 1e-11)) << r;
  }
}

TEST(VoxelReference, DifferentTransforms) {
  // Temperature on a lattice that is rotated and coarser.
  const auto coarse = placed({0.2, 0.5, -0.3}, {1.7e-3, 1.4e-3, 1.9e-3}, {-6e-3, -4e-3, -3e-3});
  const auto fine = scaled(1e-3);
  for (const auto mode : {VoxelInterpolation::trilinear, VoxelInterpolation::constant}) {
    Fields f = blob_fields(16, fine);
    f.temperature = make_field(
        {-5, -5, -5}, {20, 20, 20},
        [](int i, int j, int k) { return float(1400 + 11 * i - 7 * j + 5 * k + (i * j) % 7); },
        coarse, 300);
    const auto medium = f.medium(mode, {SourceFunction::total()});
    for (int r = 0; r < 6; ++r) {
      const Ray ray = ray_through(fine, {-3, 2.2 + r, 5.1}, {19, 11.3 - r, 8.7}, 0.1);
      const auto exact =
          integrate_voxels({f.temperature, f.absorption, mode}, ray, {0, 1}, total_source);
      const Seen seen = see<double>(*medium, {ray}, with(Isa::baseline));
      EXPECT_TRUE(relative(seen.radiance[0][0], double(exact.radiance), 2e-6)) << r;
      EXPECT_TRUE(
          relative(seen.transmittance[0], std::exp(-double(exact.optical_thickness)), 1e-12));
      for (const Isa isa : supported_isas()) {
        const Seen single = see<float>(*medium, {ray}, with(isa), -1, 1, {8e-3, 8e-3, 8e-3});
        EXPECT_TRUE(relative(single.radiance[0][0], double(exact.radiance), 2e-5)) << r;
      }
    }
  }
}

TEST(VoxelReference, SameLatticeWrittenDifferently) {
  // The temperature's samples counted from elsewhere: the same world points, the same result; and
  // a lattice turned by a quarter (its own lattice for the medium) as well.
  const auto transform = placed({0.1, 0.2, 0.3}, {1e-3, 1e-3, 1e-3}, {});
  const Fields f = blob_fields(16, transform);
  const Blob blob{1e-3};
  AffineTransform shifted = transform, turned = transform;
  shifted.translation = transform.point({-5, 3, 17});
  const Mat3 quarter{{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}}};  // (i, j) -> (-j, i)
  turned.linear = transform.linear * quarter;
  Fields moved = f, rotated = f;
  moved.temperature = make_field(
      {3, -5, -19}, {23, 15, 1},
      [&](int i, int j, int k) { return blob.temperature(i - 5, j + 3, k + 17); }, shifted, 300);
  rotated.temperature = make_field(
      {-2, -17, -2}, {18, 3, 18}, [&](int i, int j, int k) { return blob.temperature(-j, i, k); },
      turned, 300);
  const auto same = f.medium(VoxelInterpolation::trilinear, {SourceFunction::total()});
  const auto one = moved.medium(VoxelInterpolation::trilinear, {SourceFunction::total()});
  const auto two = rotated.medium(VoxelInterpolation::trilinear, {SourceFunction::total()});
  for (int r = 0; r < 6; ++r) {
    const Ray ray = ray_through(transform, {-1, 3.2 + r, 5.1}, {17, 11.3 - r, 7.7}, 0);
    const double expected = see<double>(*same, {ray}, with(Isa::baseline)).radiance[0][0];
    EXPECT_GT(expected, 0);
    EXPECT_TRUE(
        relative(see<double>(*one, {ray}, with(Isa::baseline)).radiance[0][0], expected, 1e-12));
    EXPECT_TRUE(
        relative(see<double>(*two, {ray}, with(Isa::baseline)).radiance[0][0], expected, 1e-10));
  }
}

TEST(VoxelReference, RandomVoxels) {
  // Uncorrelated samples, some 0, absorption over 12 decades: fields as rough as they can be. The
  // thickness is exact; the radiance lies between the extremes of the source function, and is
  // close where cells are thin.
  std::mt19937 random(20240611);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 20; ++trial) {
    const auto transform =
        placed({6 * uniform(random), 6 * uniform(random), 6 * uniform(random)},
               {1e-3 * (0.3 + uniform(random)), 1e-3, 1e-3 * (0.3 + uniform(random))},
               {uniform(random), uniform(random), uniform(random)});
    const bool wild = trial % 2;
    const Fields f{
        make_field(
            {0, 0, 0}, {20, 20, 20},
            [&](int, int, int) {
              return wild && uniform(random) < 0.2
                         ? 0.0f
                         : float(2000 - (wild ? 2000 : 500) * uniform(random));
            },
            transform, 0),
        make_field(
            {0, 0, 0}, {20, 20, 20},
            [&](int, int, int) {
              if (uniform(random) < 0.4) return 0.0f;
              return float(wild ? std::pow(10.0, 12 * uniform(random) - 5) : 20 * uniform(random));
            },
            transform)};
    const auto medium = f.medium(VoxelInterpolation::trilinear, {SourceFunction::total()});
    for (int r = 0; r < 8; ++r) {
      const Vec3 a{24 * uniform(random) - 2, 24 * uniform(random) - 2, 24 * uniform(random) - 2};
      const Vec3 b{24 * uniform(random) - 2, 24 * uniform(random) - 2, 24 * uniform(random) - 2};
      const Ray ray = ray_through(transform, a, b, 0.05 * uniform(random));
      const Vec3 anchor = transform.point({10, 10, 10});
      const Seen seen = see<double>(*medium, {ray}, with(Isa::baseline), 0, 0.1, anchor);
      EXPECT_GE(seen.radiance[0][0], 0);
      EXPECT_LE(seen.radiance[0][0], double(total_source(2000)));
      EXPECT_GE(seen.transmittance[0], 0);
      for (const Isa isa : supported_isas()) {
        const Seen single = see<float>(*medium, {ray}, with(isa), 0, 0.1, anchor);
        EXPECT_GE(single.radiance[0][0], 0);
        EXPECT_LE(single.radiance[0][0], 1.00001 * double(total_source(2000)));
        if (!wild) {
          EXPECT_TRUE(within(single.radiance[0][0], seen.radiance[0][0], 1e-4,
                             double(total_source(2000)) * (1 - seen.transmittance[0])));
        }
      }
      if (wild) continue;
      const auto exact =
          integrate_voxels({f.temperature, f.absorption, VoxelInterpolation::trilinear}, ray,
                           {0, 0.1}, total_source);
      EXPECT_TRUE(
          relative(seen.transmittance[0], std::exp(-double(exact.optical_thickness)), 1e-11));
      if (exact.radiance > 0) {
        EXPECT_TRUE(relative(seen.radiance[0][0], double(exact.radiance), 0.03));
      } else {
        EXPECT_EQ(seen.radiance[0][0], 0);
      }
    }
  }
}

}  // namespace
}  // namespace plenoflame::test::voxel_reference_test
