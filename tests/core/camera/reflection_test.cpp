#include "optics/reflection.h"

#include <cmath>

#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/small_scene.h"
#include "support/uniform_medium.h"

namespace plenoflame {
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

}  // namespace
}  // namespace plenoflame
