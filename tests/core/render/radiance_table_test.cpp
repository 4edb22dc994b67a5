// The table of radiance as a control variate: against the same rays, all integrated.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/media_voxel/voxel_fixture.h"
#include "plenoflame/render/render.h"
#include "plenoflame/sampling/sobol.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"

namespace plenoflame::test::radiance_table_test {
namespace {

/// A cloud of voxels, 1 m in front of the camera: Gaussian, a little beside the axis,
/// with an edge where it is cut off; or noise.
std::unique_ptr<Medium> cloud(bool noise, int channels, double voxel) {
  const int half = 24;
  AffineTransform place = scaled(voxel, {1, -6 * voxel, voxel});
  place.linear = rotation_xyz({0.3, -0.2, 0.5}) * place.linear;
  const auto hash = [](int i, int j, int k) {
    return static_cast<float>(
               mix64(static_cast<std::uint64_t>(i * 73856093 ^ j * 19349663 ^ k * 83492791)) >>
               40) *
           0x1p-24f;
  };
  const auto absorption = [=](int i, int j, int k) -> float {
    const float r2 = static_cast<float>(i * i + j * j + k * k);
    if (r2 > half * half) return 0.f;
    return noise ? 400 * hash(i, j, k) : 300 * std::exp(-r2 / 250);
  };
  const auto temperature = [=](int i, int j, int k) -> float {
    return noise ? 1000 + 900 * hash(k, i, j) : 1500 + 10 * static_cast<float>(j);
  };
  std::vector<SourceFunction> sources{SourceFunction::total()};
  if (channels > 1) sources.push_back(SourceFunction::band(650e-9, 10e-9));
  return make_voxel_medium(
      make_field({-half, -half, -half}, {half + 1, half + 1, half + 1}, temperature, place, 1200),
      make_field({-half, -half, -half}, {half + 1, half + 1, half + 1}, absorption, place),
      VoxelInterpolation::trilinear, std::move(sources));
}

CompiledScene cloud_scene(bool noise = false, int channels = 1, double voxel = 1e-4,
                          int columns = 90, int rows = 80) {
  CompiledScene scene = scene_of(paper_flame(columns, rows).camera, cloud(noise, channels, voxel));
  if (channels > 1) {
    scene.scene.channels.push_back(scene.scene.channels.front());
    scene.scene.channels.back().name = "red";
  }
  return scene;
}

struct Difference {
  double flux = 0, sum = 0, standard_error = 0, rms = 0;
};

/// The difference of images of the same rays: the scatter of the corrections is left.
Difference difference(const Image& a, const Image& b) {
  Difference d;
  double squares = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const double x = static_cast<double>(a.pixels[i]) - static_cast<double>(b.pixels[i]);
    d.sum += x;
    squares += x * x;
    d.flux += static_cast<double>(b.pixels[i]);
  }
  d.standard_error = std::sqrt(squares);
  d.rms = std::sqrt(squares / static_cast<double>(a.pixels.size()));
  return d;
}

TEST(RadianceTable, UnbiasedAndFarBelowTheImagesNoise) {
  const CompiledScene scene = cloud_scene(false, 2);
  RenderSettings settings;
  settings.samples = 64;
  for (const Isa isa : supported_isas()) {
    settings.isa = isa;
    settings.control_variate = true;
    const RenderResult with = render(scene, settings);
    settings.control_variate = false;
    const RenderResult without = render(scene, settings);
    EXPECT_EQ(with.statistics.rays, without.statistics.rays);
    EXPECT_EQ(without.statistics.table.looked_up, 0);
    // Most rays are spared the medium, and what it computes falls with them.
    EXPECT_GT(with.statistics.table.looked_up, 0.5 * with.statistics.rays_reached);
    EXPECT_GT(with.statistics.table.corrected, 0.02 * with.statistics.rays_reached);
    EXPECT_LT(with.statistics.medium.rays - with.statistics.table.nodes,
              0.5 * without.statistics.medium.rays);
    for (std::size_t c = 0; c < 2; ++c) {
      const Image& image = with.light_field.channels[c].flux;
      const Image& exact = without.light_field.channels[c].flux;
      const Image& error = without.light_field.channels[c].standard_error;
      const Difference d = difference(image, exact);
      EXPECT_GT(d.flux, 0);
      EXPECT_GT(d.standard_error, 0);
      EXPECT_LT(std::fabs(d.sum), 4 * d.standard_error) << "channel " << c;
      double noise = 0;
      for (const float e : error.pixels) noise += static_cast<double>(e) * static_cast<double>(e);
      noise = std::sqrt(noise / static_cast<double>(error.pixels.size()));
      EXPECT_LT(d.rms, 0.1 * noise) << "channel " << c;
    }
  }
}

/// The mean of what the table changes in eight runs, in units of its own scatter.
void expect_no_bias(const CompiledScene& scene, int samples, double largest_error) {
  RenderSettings settings;
  settings.samples = samples;
  double sum = 0, squares = 0;
  const int runs = 8;
  for (int seed = 1; seed <= runs; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed);
    settings.control_variate = true;
    const RenderResult with = render(scene, settings);
    EXPECT_GT(with.statistics.table.looked_up, 0);
    settings.control_variate = false;
    const double z = with.statistics.flux / render(scene, settings).statistics.flux - 1;
    sum += z;
    squares += z * z;
  }
  const double mean = sum / runs;
  const double error = std::sqrt(std::max(0.0, squares / runs - mean * mean) / (runs - 1));
  EXPECT_LT(std::fabs(mean), 4.5 * error);
  EXPECT_LT(error, largest_error);  // and it is known well enough for that to say something
}

TEST(RadianceTable, CorrectionsDecideAboutTheMean) {
  expect_no_bias(cloud_scene(), 64, 1e-4);
}

// With fewer rays than one correction stands for, only some pixels have one.
TEST(RadianceTable, CorrectionsOfSomePixelsDecideAboutTheMean) {
  expect_no_bias(cloud_scene(false, 1, 4e-4, 400, 300), 8, 3e-5);
}

TEST(RadianceTable, SameBitsForThreadsAndWindows) {
  const CompiledScene scene = cloud_scene();
  RenderSettings settings;
  settings.samples = 64;
  const RenderResult whole = render(scene, settings, one_thread());
  EXPECT_GT(whole.statistics.table.looked_up, 0);
  for (const int count : {2, 7})
    EXPECT_EQ(render(scene, settings, threads(count)).light_field.channels[0].flux.pixels,
              whole.light_field.channels[0].flux.pixels);
  settings.window = {30, 21, 33, 40};
  const Image part = render(scene, settings, one_thread()).light_field.channels[0].flux;
  for (int row = 0; row < 40; ++row)
    for (int column = 0; column < 33; ++column)
      ASSERT_EQ(part.at(column, row), whole.light_field.channels[0].flux.at(30 + column, 21 + row));
}

TEST(RadianceTable, NoiseIsIntegratedRayByRayAndNothingIsNegative) {
  const CompiledScene scene = cloud_scene(true);
  RenderSettings settings;
  settings.samples = 64;
  const RenderResult with = render(scene, settings);
  EXPECT_GT(with.statistics.table.rough, 0);
  settings.control_variate = false;
  const RenderResult without = render(scene, settings);
  for (const float p : with.light_field.channels[0].flux.pixels) EXPECT_GE(p, 0.f);
  const Difference d =
      difference(with.light_field.channels[0].flux, without.light_field.channels[0].flux);
  EXPECT_LT(std::fabs(d.sum), 4 * d.standard_error);
}

TEST(RadianceTable, NotWhereItDoesNotPay) {
  RenderSettings settings;
  settings.samples = 32;
  const CompiledScene layers = compile(paper_flame(60, 60));
  EXPECT_EQ(render(layers, settings).statistics.table.nodes,
            0);  // rays cost as little as the table
  const CompiledScene scene = cloud_scene();
  settings.precision = Precision::double_precision;
  EXPECT_EQ(render(scene, settings).statistics.table.nodes, 0);
  settings.precision = Precision::automatic;
  settings.samples = 8;
  EXPECT_EQ(render(scene, settings).statistics.table.nodes, 0);  // fewer rays than it has nodes
}

/// Sums of a pixel over the points of a randomisation that are exactly 0 with a table, though the
/// same rays see light: more than the table's single precision can tell from none beside the
/// brightest sum, as a ray that grazes the cloud does not.
double cut_to_nothing(const RenderResult& with, const RenderResult& without) {
  const PixelWindow window = with.film.window();
  double count = 0, brightest = 0;
  for (int row = window.y; row < window.y + window.height; ++row)
    for (int column = window.x; column < window.x + window.width; ++column)
      for (int replicate = 0; replicate < with.film.replicates(); ++replicate)
        brightest = std::max(brightest, without.film.sum(0, replicate, column, row));
  constexpr double kSingle = 0x1p-20;  // a sum of 32 rounded numbers
  for (int row = window.y; row < window.y + window.height; ++row)
    for (int column = window.x; column < window.x + window.width; ++column)
      for (int replicate = 0; replicate < with.film.replicates(); ++replicate) {
        const double sum = with.film.sum(0, replicate, column, row);
        EXPECT_GE(sum, 0);
        count += sum == 0 && without.film.sum(0, replicate, column, row) > kSingle * brightest;
      }
  return count;
}

// Sums below 0, where the table says too much and single rays correct it, are cut off: that adds
// light, and the statistics bound how much.
TEST(RadianceTable, WhatIsCutOffBelowZeroIsBounded) {
  const CompiledScene scene = cloud_scene(true, 1, 4e-4, 400, 300);
  RenderSettings settings;
  settings.samples = 8;
  double added = 0, squares = 0, bound = 0, clamped = 0, cut_off = 0;
  constexpr int kRuns = 8;
  for (int run = 0; run < kRuns; ++run) {
    settings.seed = static_cast<std::uint64_t>(100 + run);
    settings.control_variate = true;
    const RenderResult with = render(scene, settings);
    settings.control_variate = false;
    const RenderResult without = render(scene, settings);
    const Difference d =
        difference(with.light_field.channels[0].flux, without.light_field.channels[0].flux);
    added += d.sum / d.flux;
    squares += d.sum / d.flux * (d.sum / d.flux);
    bound += with.statistics.table.clamped_sum / with.statistics.table.total;
    clamped += with.statistics.table.clamped;
    cut_off += cut_to_nothing(with, without);
  }
  // Sums that would be negative are 0, no more: but for pixels that see the flame through another
  // microlens, too, every one of these sums is found in the picture.
  EXPECT_LE(cut_off, clamped);
  EXPECT_GT(cut_off, 0.5 * clamped);
  EXPECT_GT(clamped, 0);
  EXPECT_GT(bound, 0);
  EXPECT_LT(bound / kRuns, 1e-4);
  // Standard error of the mean, were there no bias.
  const double error = std::sqrt(squares) / kRuns;
  EXPECT_LT(added / kRuns, bound / kRuns + 4 * error);
}

}  // namespace
}  // namespace plenoflame::test::radiance_table_test
