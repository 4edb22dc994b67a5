// The light from behind the flames that chief rays carry.
#include <gtest/gtest.h>

#include <cmath>

#include "plenoflame/render/ray_paths.h"
#include "plenoflame/scene/compile.h"
#include "support/approx.h"
#include "support/small_scene.h"

namespace plenoflame::test::chief_rays_test {
namespace {

// Cold gas that absorbs in proportion to 1 / wavelength, before a sky: of each colour e^-tau of its
// own arrives. Fails when all are dimmed as the first.
TEST(ChiefRays, LightBehindFlamesIsDimmedInItsOwnColour) {
  Scene scene = small_scene(singlet(), large_array(Lattice::square, LensModel::real));
  scene.flames[0].layers = {{"cold", {0, 0, 0.012}, {0.04, 0.04, 0.04}, 10, 20}};
  scene.flames[0].spectrum.kind = SpectrumKind::power;
  scene.flames[0].spectrum.exponent = 1;
  scene.channels = {{"red", ChannelKind::band, 650e-9, 1e-10},
                    {"blue", ChannelKind::band, 450e-9, 1e-10}};
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 300;
  scene.lights = {sky};
  const CompiledScene compiled = compile(scene);
  RayPaths paths = empty_ray_paths(compiled);
  add_chief_rays(compiled, paths);
  ASSERT_GT(paths.rays.size(), 10u);
  for (std::size_t i = 0; i < paths.rays.size(); ++i) {
    const double thickness = paths.rays[i].optical_thickness;
    EXPECT_GT(thickness, 0.5);
    const std::vector<double>& sky_of = compiled.lights.environment;
    EXPECT_TRUE(relative(paths.radiance_of(i, 0), sky_of[0] * std::exp(-thickness), 1e-9));
    EXPECT_TRUE(
        relative(paths.radiance_of(i, 1), sky_of[1] * std::exp(-thickness * 650 / 450), 1e-6));
  }
}

}  // namespace
}  // namespace plenoflame::test::chief_rays_test
