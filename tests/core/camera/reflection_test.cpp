#include "optics/reflection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plenoflame/render/ray_paths.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/small_scene.h"
#include "support/uniform_medium.h"

namespace plenoflame::reflection_test {
namespace {

using test::relative;

TEST(Reflection, ClosedForms) {
  // At right angles ((n - 1) / (n + 1))^2.
  EXPECT_TRUE(relative(surface_transmission({1, 1, 1.5, 0}, 1), 0.96, 1e-14));
  EXPECT_TRUE(relative(surface_transmission({1.5, 1.5, 1, 0}, 1), 0.96, 1e-14));
  // At Brewster's angle only the perpendicular part is reflected, ((n^2 - 1) / (n^2 + 1))^2 of it.
  const double perpendicular = std::pow(1.25 / 3.25, 2);
  EXPECT_TRUE(relative(surface_transmission({1, 1, 1.5, 0}, 1 / std::sqrt(1 + 2.25)),
                       1 - 0.5 * perpendicular, 1e-14));
  // Both ways alike.
  const double sine = 0.6;
  EXPECT_TRUE(relative(
      surface_transmission({1, 1, 1.7, 0}, std::sqrt(1 - sine * sine)),
      surface_transmission({1.7, 1.7, 1, 0}, std::sqrt(1 - sine * sine / (1.7 * 1.7))), 1e-13));
  // A quarter wave of sqrt(n) reflects nothing, half a wave is not there.
  EXPECT_TRUE(relative(surface_transmission({1, std::sqrt(1.5), 1.5, 1}, 1), 1, 1e-14));
  EXPECT_TRUE(relative(surface_transmission({1, 1.38, 1.5, 2}, 1), 0.96, 1e-13));
  // MgF2 on glass at its wavelength: ((n_c^2 - n) / (n_c^2 + n))^2.
  const double rest = std::pow((1.38 * 1.38 - 1.5) / (1.38 * 1.38 + 1.5), 2);
  EXPECT_TRUE(relative(surface_transmission({1, 1.38, 1.5, 1}, 1), 1 - rest, 1e-13));
}

double flux_with(const TransmissionSpec& transmission, bool array, double stop,
                 Precision precision = Precision::automatic) {
  CameraSpec camera;
  camera.lens = test::singlet();
  camera.lens.surfaces[2].diameter = stop;
  if (array) camera.array = test::large_array(Lattice::square, LensModel::real);
  camera.sensor = {6, 6, 0.05e-3};
  camera.focus.object_distance = 1;
  camera.focus.conjugate = array ? "array" : "sensor";
  camera.transmission = transmission;
  const CompiledScene scene = test::scene_of(camera, std::make_unique<test::UniformMedium>());
  RenderSettings settings;
  settings.precision = precision;
  return render(scene, settings, test::one_thread()).statistics.flux;
}

// The paper's singlet, stopped down: (1 - 0.04)^2 = 0.9216; with the microlenses of index 1.5 to
// the fourth power. Nearly perpendicular incidence differs in the fourth order.
TEST(Reflection, OfACamera) {
  TransmissionSpec fresnel;
  fresnel.fresnel = true;
  for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
    const double bare = flux_with({}, false, 4e-3, precision);
    EXPECT_TRUE(relative(flux_with(fresnel, false, 4e-3, precision) / bare, 0.9216, 3e-6));
    TransmissionSpec coated = fresnel;
    coated.coating_index = 1.38;
    const double rest = std::pow((1.38 * 1.38 - 1.5) / (1.38 * 1.38 + 1.5), 2);
    EXPECT_TRUE(
        relative(flux_with(coated, false, 4e-3, precision) / bare, (1 - rest) * (1 - rest), 3e-5));
    TransmissionSpec cover;
    cover.cover_index = 1.5;
    EXPECT_TRUE(relative(flux_with(cover, false, 4e-3, precision) / bare, 0.9216, 3e-6));
  }
  const double bare = flux_with({}, true, 4e-3);
  EXPECT_TRUE(relative(flux_with(fresnel, true, 4e-3) / bare, 0.9216 * 0.9216, 2e-3));
}

/// A camera that looks through a wide lens and steep microlenses.
CompiledScene wide_camera(const TransmissionSpec& transmission) {
  CameraSpec camera;
  camera.lens = test::singlet();
  camera.array = test::large_array(Lattice::square, LensModel::real);
  camera.sensor = {40, 40, 0.2e-3};
  camera.focus.object_distance = 1;
  camera.focus.conjugate = "array";
  camera.transmission = transmission;
  camera.wavelength = 650e-9;
  return test::scene_of(camera, std::make_unique<test::UniformMedium>());
}

const std::vector<Pixel> kPixels{{0, 0}, {3, 20}, {20, 19}, {39, 38}};

RayPaths rays_of(const CompiledScene& scene) {
  RenderSettings settings;
  settings.samples = 64;
  RayPaths paths = empty_ray_paths(scene);
  add_pixel_rays(scene, settings, kPixels, test::one_thread(), paths);
  return paths;
}

/// The pixels' flux by the vector kernels, which the paths share no losses with.
void expect_flux_of_rays(const CompiledScene& scene, const RayPaths& paths) {
  for (const Pixel pixel : kPixels) {
    double sum = 0;
    for (std::size_t i = 0; i < paths.rays.size(); ++i)
      if (paths.rays[i].column == pixel.column && paths.rays[i].row == pixel.row)
        sum += paths.rays[i].weight * paths.radiance_of(i, 0);
    EXPECT_GT(sum, 0);
    for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
      RenderSettings settings;
      settings.samples = 64;
      settings.precision = precision;
      settings.window = {pixel.column, pixel.row, 1, 1};
      EXPECT_TRUE(relative(render(scene, settings, test::one_thread()).statistics.flux, sum,
                           precision == Precision::double_precision ? 2e-7 : 2e-5));
    }
  }
}

Vec3 direction_from(const RayPaths& paths, std::size_t vertex) {
  return normalize(paths.vertices[vertex + 1].position - paths.vertices[vertex].position);
}

/// Angle of incidence in front of a refraction, by how much the ray turns there.
double cosine_before(Vec3 in, Vec3 out, double before, double behind) {
  const double sine = length(cross(in, out)), cosine = dot(in, out);
  return 1 / std::hypot(1.0, behind * sine / (behind * cosine - before));
}

// Rays of a whole image, steep ones at the corners: the weight of each against the product of what
// every surface on its way lets through, by complex amplitudes and the angles that its vertices
// show. Fails when the kernels take the angle of the wrong side, or leave out a surface.
TEST(Reflection, OfEveryRay) {
  TransmissionSpec fresnel, coated, covered;
  fresnel.fresnel = coated.fresnel = true;
  coated.coating_index = 1.38;
  coated.coating_wavelength = 500e-9;
  covered.cover_index = 1.6;
  const RayPaths bare = rays_of(wide_camera({}));
  double steepest = 1;
  for (const TransmissionSpec& losses : {fresnel, coated, covered}) {
    const CompiledScene scene = wide_camera(losses);
    const CameraSpec& spec = scene.camera.spec();
    const RayPaths paths = rays_of(scene);
    expect_flux_of_rays(scene, paths);
    ASSERT_EQ(paths.rays.size(), bare.rays.size());
    int reached = 0;
    for (std::size_t i = 0; i < paths.rays.size(); ++i) {
      const RayPath& ray = paths.rays[i];
      if (ray.status.status != RayStatus::reached) continue;
      ++reached;
      const Vec3 first = direction_from(paths, ray.first);
      // The optical axis is the world's x.
      double expected =
          losses.cover_index > 0 ? plate_transmission(losses.cover_index, first.x) : 1;
      for (std::size_t k = ray.first + 1; losses.fresnel && k + 1 < ray.first + ray.count; ++k) {
        const double before = paths.vertices[k - 1].index, behind = paths.vertices[k].index;
        if (paths.vertices[k].surface < 0 || before == behind) continue;
        const double cosine =
            cosine_before(direction_from(paths, k - 1), direction_from(paths, k), before, behind);
        steepest = std::min(steepest, cosine);
        // Layers are on the main lens, whose surfaces come first from the scene.
        const bool layer = losses.coating_index > 0 && paths.vertices[k].surface < 3;
        expected *= surface_transmission(
            layer ? coating_of({losses.coating_index, losses.coating_wavelength, spec.wavelength},
                               before, behind)
                  : Coating{before, before, behind, 0},
            cosine);
      }
      EXPECT_TRUE(relative(ray.weight / bare.rays[i].weight, expected, 1e-7)) << i;
    }
    EXPECT_GT(reached, 100);
  }
  EXPECT_LT(steepest, 0.9);
}

}  // namespace
}  // namespace plenoflame::reflection_test
