// The linear problem against the renderer: A x is the picture of the emission grid x.
#include "plenoflame/inverse/emission_operator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/inverse/glowing_grid.h"
#include "core/inverse/random_vectors.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::test::emission_operator_test {
namespace {

constexpr std::array<int, 3> kCount{9, 10, 14};

AffineTransform lattice_map() {
  return scaled(1.5e-3, {1 - 6e-3, -6.5e-3, -9e-3});
}

/// Samples that single precision holds exactly.
GlowingGrid grids(float thickest) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> share(0, 1);
  GlowingGrid g{kCount, lattice_map(), {}, {}};
  for (int n = 0; n < kCount[0] * kCount[1] * kCount[2]; ++n) {
    g.emission.push_back(static_cast<double>(100 * share(random)));
    g.absorption.push_back(static_cast<double>(thickest * (0.05F + share(random))));
  }
  return g;
}

Scene glowing_scene(bool with_array) {
  ArraySpec array;
  if (with_array) array = large_array(Lattice::hexagonal, LensModel::real);
  Scene scene = small_scene(singlet(), array);
  scene.camera.sensor = {24, 24, 0.4e-3};
  scene.flames = {glowing_flame()};
  scene.channels = {{"430nm", ChannelKind::band, 430e-9, 20e-9}};
  return scene;
}

struct Problem {
  CompiledScene scene;
  std::unique_ptr<Unknowns> unknowns;
  CameraRays rays;
  GlowingGrid g;
  EmissionProblem problem() const {
    return {&rays, unknowns.get(), RowModel::emission, g.absorption};
  }
};

Problem problem_of(const Scene& scene, float thickest, int threads = 2, int bin = 1) {
  const GlowingGrid g = grids(thickest);
  Problem p{compile(scene, glowing_loader(g)), nullptr, {}, g};
  p.unknowns = make_voxel_unknowns({kCount, lattice_map(), VoxelInterpolation::trilinear});
  Execution execution;
  execution.threads = threads;
  CameraRaySettings settings;
  settings.samples = 8;
  settings.bin = bin;
  p.rays = draw_camera_rays({{&p.scene, {}}}, p.unknowns->bounds(), settings, execution);
  return p;
}

Problem make_problem(bool with_array, float thickest, int threads = 2, int bin = 1) {
  return problem_of(glowing_scene(with_array), thickest, threads, bin);
}

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

RenderSettings exact_settings() {
  RenderSettings settings;
  settings.samples = 8;
  settings.skip = false;
  settings.control_variate = false;
  settings.precision = Precision::double_precision;
  return settings;
}

/// Every pixel of the picture: the same rays and the same quadrature, added up in another order.
void expect_picture(const Problem& p, const RenderResult& picture) {
  const Image& flux = picture.light_field.channels[0].flux;
  const auto a = make_emission_operator(p.problem(), {});
  std::vector<double> b(a->rows());
  a->apply(p.g.emission, b);
  double lit = 0, sum = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const CameraRays::Row& row = p.rays.rows[i];
    const double expected = static_cast<double>(flux.at(row.column, row.row));
    EXPECT_TRUE(relative(b[i], expected, 1e-6)) << row.column << ", " << row.row;
    sum += b[i];
    lit += expected > 0;
  }
  EXPECT_GT(lit, 50);
  EXPECT_TRUE(relative(sum, picture.statistics.flux, 1e-6));
}
void expect_picture(const Problem& p) {
  expect_picture(p, render(p.scene, exact_settings()));
}

// Clear and absorbing, with and without microlenses. Fails when rays lose the lens' etendue, or
// when the absorption in front is left out.
TEST(EmissionOperator, RowsTimesSamplesAreTheRenderedPicture) {
  for (const bool with_array : {true, false})
    for (const float thickest : {0.0F, 150.0F}) expect_picture(make_problem(with_array, thickest));
}

/// A third of the stop is behind a filter that takes half of the line's light, a third behind one
/// that takes all.
Scene filtered_scene() {
  Scene scene = glowing_scene(true);
  PupilFilterSpec half{"half"}, dark{"dark"};
  half.extent = dark.extent = 2 * std::acos(-1.0) / 3;
  dark.angle = half.extent;
  half.transmission = "420 nm 0.4, 442 nm 0.6";
  dark.transmission = "500 nm 1, 600 nm 1";
  scene.camera.pupil_filters = {half, dark};
  return scene;
}

TEST(EmissionOperator, FiltersInThePupilWeighTheRays) {
  expect_picture(problem_of(filtered_scene(), 150));
}

// With glasses that disperse the line has rays of its own in the picture, while the matrix takes
// those of the channel's middle as well: another sample of the same light.
TEST(EmissionOperator, FiltersInThePupilOfADispersiveLens) {
  Scene scene = filtered_scene();
  scene.camera.lens.surfaces[0].glass = "N-BK7";
  scene.channels.push_back({"600nm", ChannelKind::band, 600e-9, 20e-9});
  const Problem p = problem_of(scene, 150);
  ASSERT_GT(p.scene.paths().size(), 1U);
  RenderSettings settings;
  settings.samples = 64;
  const Image picture = render(p.scene, settings).light_field.channels[0].flux;
  std::vector<double> b(p.rays.rows.size());
  make_emission_operator(p.problem(), {})->apply(p.g.emission, b);
  double sum = 0, expected = 0;
  for (const double flux : b) sum += flux;
  for (const float flux : picture.pixels) expected += static_cast<double>(flux);
  EXPECT_TRUE(relative(sum, expected, 0.02));
}

TEST(EmissionOperator, TransposeIsExact) {
  for (const float thickest : {0.0F, 150.0F}) {
    const Problem p = make_problem(true, thickest);
    const auto a = make_emission_operator(p.problem(), {});
    const std::vector<double> x = random_vector(a->columns(), 1), y = random_vector(a->rows(), 2);
    std::vector<double> ax(a->rows()), aty(a->columns());
    a->apply(x, ax);
    a->apply_transpose(y, aty);
    double size = 0;
    for (std::size_t i = 0; i < y.size(); ++i) size += std::fabs(y[i] * ax[i]);
    EXPECT_TRUE(within(product(x, aty), product(ax, y), 1e-12, size));
  }
}

// The stored matrix has the same rows in single precision, and all is the same to the bit for one
// thread and for two.
TEST(EmissionOperator, StoredAndFollowedAgreeForAnyNumberOfThreads) {
  const Problem p = make_problem(true, 150, 2), q = make_problem(true, 150, 1);
  ASSERT_EQ(p.rays.rays.size(), q.rays.rays.size());
  Execution one, two;
  one.threads = 1;
  two.threads = 2;
  const CsrMatrix<float> a = make_emission_matrix(p.problem(), two),
                         b = make_emission_matrix(q.problem(), one);
  EXPECT_TRUE(std::ranges::equal(a.values(), b.values()));
  EXPECT_TRUE(std::ranges::equal(a.column_indices(), b.column_indices()));
  EXPECT_TRUE(std::ranges::equal(a.row_starts(), b.row_starts()));
  const auto followed = make_emission_operator(p.problem(), two);
  const auto again = make_emission_operator(q.problem(), one);
  std::vector<double> x = random_vector(followed->columns(), 4);
  for (double& value : x) value = std::fabs(value);
  std::vector<double> y(followed->rows()), z(followed->rows());
  followed->apply(x, y);
  again->apply(x, z);
  EXPECT_EQ(y, z);
  std::vector<double> s(x.size()), t(x.size());
  followed->apply_transpose(y, s);
  again->apply_transpose(y, t);
  EXPECT_EQ(s, t);
  const auto stored = make_csr_operator(a, two);
  stored->apply(x, z);
  for (std::size_t row = 0; row < y.size(); ++row) EXPECT_TRUE(relative(z[row], y[row], 1e-6));
  const double estimate = static_cast<double>(estimated_entries(p.problem()));
  EXPECT_TRUE(relative(estimate, static_cast<double>(a.entries()), 0.2));
}

/// Two cameras whose rows are pixels, blocks or cells of micro-images, in several pieces each.
struct Rows {
  int bin, cells, samples, pixels;
};
class DrawnAgain : public testing::TestWithParam<Rows> {};

// Rays that each product draws again are those that are kept: both products and the matrix are the
// same to the bit, for any number of threads, and no ray is held. Fails when the rays of a row come
// in another order from a part of the window than from all of it.
TEST_P(DrawnAgain, HasTheBitsOfKeptRaysAndHoldsNone) {
  Scene scene = glowing_scene(true), side = scene;
  const int pixels = GetParam().pixels;
  scene.camera.sensor = {pixels, pixels + 9, 9.6e-3 / pixels};
  side.camera.sensor = scene.camera.sensor;
  side.camera.position = {1, -1, 0};
  side.camera.look_direction = {0, 1, 0};
  const GlowingGrid g = grids(150);
  const CompiledScene first = compile(scene, glowing_loader(g)),
                      second = compile(side, glowing_loader(g));
  const auto unknowns = make_voxel_unknowns({kCount, lattice_map(), VoxelInterpolation::trilinear});
  CameraRaySettings settings;
  settings.bin = GetParam().bin;
  settings.cells = GetParam().cells;
  settings.samples = GetParam().samples;
  const std::vector<CameraView> views{{&first, {}}, {&second, {5, 3, pixels - 6, pixels}}};
  Execution one, three;
  one.threads = 1;
  three.threads = 3;
  const CameraRays kept = draw_camera_rays(views, unknowns->bounds(), settings, three);
  settings.keep = false;
  const CameraRays drawn = draw_camera_rays(views, unknowns->bounds(), settings, three);
  ASSERT_GT(kept.rays.size(), 10000U);
  EXPECT_EQ(drawn.rays.capacity(), 0U);
  EXPECT_EQ(drawn.ray_count(), kept.rays.size());
  ASSERT_EQ(drawn.rows.size(), kept.rows.size());
  ASSERT_GT(drawn.source->pieces.count(), 3U);
  for (std::size_t row = 0; row < kept.rows.size(); ++row) {
    EXPECT_EQ(drawn.rows[row].column, kept.rows[row].column);
    EXPECT_EQ(drawn.rows[row].row, kept.rows[row].row);
    EXPECT_EQ(drawn.end_of(row), kept.end_of(row));
  }
  const EmissionProblem of_kept{&kept, unknowns.get(), RowModel::emission, g.absorption},
      of_drawn{&drawn, unknowns.get(), RowModel::emission, g.absorption};
  const auto a = make_emission_operator(of_kept, three);
  const std::vector<double> x = random_vector(a->columns(), 1), y = random_vector(a->rows(), 2);
  const std::vector<double> ax = *a * x, aty = transposed_times(*a, y);
  const CsrMatrix<float> matrix = make_emission_matrix(of_kept, three);
  const auto replicates = replicate_fluxes(of_kept, x, three);
  std::vector<Execution> executions{three};
  if (GetParam().samples == 4) executions.push_back(one);
  for (const Execution& execution : executions) {
    const auto b = make_emission_operator(of_drawn, execution);
    EXPECT_EQ(ax, *b * x);
    EXPECT_EQ(aty, transposed_times(*b, y));
    const CsrMatrix<float> again = make_emission_matrix(of_drawn, execution);
    EXPECT_TRUE(std::ranges::equal(matrix.values(), again.values()));
    EXPECT_TRUE(std::ranges::equal(matrix.column_indices(), again.column_indices()));
    EXPECT_TRUE(std::ranges::equal(matrix.row_starts(), again.row_starts()));
    EXPECT_EQ(replicates, replicate_fluxes(of_drawn, x, execution));
  }
  EXPECT_EQ(estimated_entries(of_kept), estimated_entries(of_drawn));
}
INSTANTIATE_TEST_SUITE_P(Rows, DrawnAgain,
                         testing::Values(Rows{1, 0, 4, 48}, Rows{3, 0, 4, 72}, Rows{1, 1, 8, 72},
                                         Rows{1, 3, 8, 56}, Rows{1, 0, 2048, 16}),
                         [](const auto& rows) {
                           return "bin" + std::to_string(rows.param.bin) + "cells" +
                                  std::to_string(rows.param.cells) + "rays" +
                                  std::to_string(rows.param.samples);
                         });

// Rays have the weight of their channel behind the filters. Fails when the rays that are drawn
// again are those of the first channel.
TEST(EmissionOperator, DrawnRaysAreThoseOfTheirChannel) {
  Scene scene = filtered_scene();
  scene.camera.sensor = {48, 48, 0.2e-3};
  scene.channels.push_back({"550nm", ChannelKind::band, 550e-9, 20e-9});
  const Problem p = problem_of(scene, 150);
  std::vector<std::vector<double>> products;
  for (const int channel : {0, 1}) {
    CameraRaySettings settings;
    settings.channel = channel;
    for (const bool keep : {true, false}) {
      settings.keep = keep;
      const CameraRays rays = draw_camera_rays({{&p.scene, {}}}, p.unknowns->bounds(), settings);
      EXPECT_EQ(rays.rays.empty(), !keep);
      const auto a =
          make_emission_operator({&rays, p.unknowns.get(), RowModel::emission, p.g.absorption}, {});
      products.push_back(transposed_times(*a, std::vector<double>(a->rows(), 1.0)));
    }
  }
  EXPECT_EQ(products[0], products[1]);
  EXPECT_EQ(products[2], products[3]);
  EXPECT_NE(products[0], products[2]);
}

// Sixteen times the rays are held as the same bytes, and pieces become smaller in rows, not larger
// in rays: a product draws a piece at a time for each thread.
TEST(EmissionOperator, DrawnRaysTakeNoMemory) {
  Scene scene = glowing_scene(true);
  scene.camera.sensor = {24, 24, 0.4e-3};
  const GlowingGrid g = grids(150);
  const CompiledScene compiled = compile(scene, glowing_loader(g));
  const auto unknowns = make_voxel_unknowns({kCount, lattice_map(), VoxelInterpolation::trilinear});
  const auto drawn_with = [&](int samples) {
    CameraRaySettings settings;
    settings.samples = samples;
    return rays_of_form(OperatorForm::drawn, {{&compiled, {}}}, unknowns->bounds(), settings);
  };
  const auto rays_of_piece = [](const CameraRays& rays) {
    std::size_t most = 0;
    for (std::size_t p = 0; p < rays.source->pieces.count(); ++p) {
      std::size_t own = 0;
      for (const std::size_t row : rays.source->pieces.of(p))
        own += rays.end_of(row) - rays.rows[row].begin;
      most = std::max(most, own);
    }
    return most;
  };
  const CameraRays few = drawn_with(512), many = drawn_with(8192);
  EXPECT_GT(many.ray_count(), 12 * few.ray_count());
  EXPECT_LT(many.rows.size(), 1.2 * static_cast<double>(few.rows.size()));
  EXPECT_EQ(few.rays.capacity() + many.rays.capacity(), 0U);
  EXPECT_GT(many.ray_count(), std::size_t{4} << 18);
  EXPECT_LE(rays_of_piece(few), std::size_t{1} << 18);
  EXPECT_LE(rays_of_piece(many), std::size_t{1} << 18);
}

// The entries that are told before rays are drawn: no more than there are, and not much less, for
// rows of each kind. Fails when sampled rows have fewer rays than all of them will have, or others'
// rays.
TEST(EmissionOperator, EntriesAreToldBeforeRaysAreDrawn) {
  for (const auto& [bin, cells] : {std::pair(1, 0), std::pair(3, 0), std::pair(1, 3)}) {
    Scene scene = glowing_scene(true);
    scene.camera.sensor = {36, 41, 9.6e-3 / 36};
    const GlowingGrid g = grids(150);
    const CompiledScene compiled = compile(scene, glowing_loader(g));
    const auto unknowns =
        make_voxel_unknowns({kCount, lattice_map(), VoxelInterpolation::trilinear});
    const std::vector<CameraView> views{{&compiled, {}}, {&compiled, {5, 3, 30, 36}}};
    CameraRaySettings settings;
    settings.bin = bin;
    settings.cells = cells;
    EmissionProblem problem{nullptr, unknowns.get(), RowModel::emission, g.absorption};
    EXPECT_EQ(least_entries(problem, views, {.samples = 7}, {}), 0);
    settings.samples = 16;
    const double least = least_entries(problem, views, settings, {});
    const CameraRays rays = draw_camera_rays(views, unknowns->bounds(), settings);
    EXPECT_TRUE(relative(estimated_rays(views, unknowns->bounds(), settings),
                         static_cast<double>(rays.ray_count()), 0.1));
    problem.rays = &rays;
    const auto entries = static_cast<double>(make_emission_matrix(problem, {}).entries());
    EXPECT_LE(least, entries) << bin << " " << cells;
    EXPECT_GT(least, 0.7 * entries) << bin << " " << cells;
  }
}

// A block of pixels is the sum of its pixels.
TEST(EmissionOperator, BlocksAreSumsOfPixels) {
  const Problem pixels = make_problem(true, 150), blocks = make_problem(true, 150, 2, 3);
  const auto a = make_emission_operator(pixels.problem(), {});
  const auto b = make_emission_operator(blocks.problem(), {});
  std::vector<double> single(a->rows()), sums(b->rows());
  a->apply(pixels.g.emission, single);
  b->apply(pixels.g.emission, sums);
  EXPECT_LT(sums.size(), single.size() / 4);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    double expected = 0;
    for (std::size_t j = 0; j < single.size(); ++j)
      if (pixels.rays.rows[j].column / 3 == blocks.rays.rows[i].column / 3 &&
          pixels.rays.rows[j].row / 3 == blocks.rays.rows[i].row / 3)
        expected += single[j];
    EXPECT_TRUE(relative(sums[i], expected, 1e-12));
  }
}

TEST(EmissionOperator, RefusesWhatDoesNotFit) {
  const Problem p = make_problem(false, 0);
  EmissionProblem wrong = p.problem();
  wrong.absorption = {1, 2};
  EXPECT_THROW(make_emission_operator(wrong, {}), UsageError);
  wrong.absorption = {};
  wrong.model = RowModel::source;
  EXPECT_THROW(make_emission_matrix(wrong, {}), UsageError);
}

}  // namespace
}  // namespace plenoflame::test::emission_operator_test
