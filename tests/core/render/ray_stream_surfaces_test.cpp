// The stream of rays in scenes with solid surfaces, surroundings, smoke and wide channels.
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "core/render/stream_picture.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/small_scene.h"

namespace plenoflame::test::ray_stream_surfaces_test {
namespace {

Scene three_types() {
  return small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
}

SolidSurfaceSpec hot_wall(double z) {
  SolidSurfaceSpec wall;
  wall.shape = SolidShape::plane;
  wall.name = "wall";
  wall.position = {z, 0, 0};
  wall.rotation = {0, std::acos(-1.0) / 2, 0};
  wall.material.kind = MaterialKind::blackbody;
  wall.material.temperature = 1500;
  return wall;
}

Scene with_wall(double x) {
  Scene scene = three_types();
  scene.surfaces = {hot_wall(x)};
  return scene;
}

Scene with_lit_wall() {
  Scene scene = with_wall(1.2);
  scene.surfaces[0].material.kind = MaterialKind::lambertian;
  LightSpec sky;
  sky.kind = LightKind::environment;
  sky.radiance = 3;
  scene.lights = {sky};
  return scene;
}

Scene smoke() {
  Scene scene = with_lit_wall();
  scene.flames[0].scattering.albedo = 0.6;
  return scene;
}

Scene wide_channels() {
  Scene scene = three_types();
  scene.flames[0].spectrum.kind = SpectrumKind::soot;
  scene.flames[0].spectrum.reference = 650e-9;
  scene.channels.clear();
  for (const char* response : {"nikon_d5100_red", "nikon_d5100_green"}) {
    ChannelSpec channel;
    channel.kind = ChannelKind::named;
    channel.name = channel.response = response;
    scene.channels.push_back(channel);
  }
  return scene;
}

RenderSettings settings_of(Precision precision) {
  RenderSettings settings;
  settings.window = {10, 8, 40, 42};
  settings.samples = 16;
  settings.precision = precision;
  settings.control_variate = false;
  return settings;
}

template <class Real>
void expect_picture(const Scene& scene, const std::string& name) {
  const CompiledScene compiled = compile(scene);
  const bool is_single = std::is_same_v<Real, float>;
  const RenderSettings settings =
      settings_of(is_single ? Precision::single_precision : Precision::double_precision);
  const LightField field = render(compiled, settings, threads(2)).light_field;
  const StreamPicture<Real> picture(compiled, settings, threads(2), RayStreamContent::radiance);
  const double tolerance = is_single ? 1e-5 : 2 * std::numeric_limits<float>::epsilon();
  for (std::size_t c = 0; c < field.channels.size(); ++c) {
    double total = 0;
    for (std::size_t i = 0; i < field.channels[c].flux.pixels.size(); ++i) {
      const double sum = picture.flux(c)[i];
      ASSERT_TRUE(relative(sum, static_cast<double>(field.channels[c].flux.pixels[i]), tolerance))
          << name << ", pixel " << i;
      total += sum;
    }
    EXPECT_GT(total, 0) << name;
  }
}

TEST(RayStreamSurfaces, RadianceOfTheStreamIsThePictures) {
  expect_picture<double>(with_wall(1.2), "hot wall");
  expect_picture<float>(with_wall(1.0), "hot wall in the flame");
  expect_picture<double>(with_lit_wall(), "lit wall");
  expect_picture<float>(with_lit_wall(), "lit wall");
  expect_picture<double>(smoke(), "smoke");
  expect_picture<float>(wide_channels(), "wide channels");
  expect_picture<double>(wide_channels(), "wide channels");
}

// A wall across the axis: every ray that leaves the camera ends in its plane, with either content,
// and the flames behind it are not seen.
TEST(RayStreamSurfaces, LightIsCollectedUpToTheFirstSurface) {
  const CompiledScene scene = compile(with_wall(1.0));
  RenderSettings settings = settings_of(Precision::double_precision);
  settings.samples = 4;
  for (const RayStreamContent content : {RayStreamContent::rays, RayStreamContent::radiance}) {
    int reached = 0;
    const RayBlockConsumer<double> look = [&](const RayBlock<double>& block, int) {
      for (int i = 0; i < block.size; ++i) {
        if (!(block.etendue[static_cast<std::size_t>(i)] > 0)) continue;
        const RayBatch<double>& r = block.rays;
        const double x = r.anchor.x + r.x[i] + r.t_far[i] * r.dx[i];
        ASSERT_TRUE(relative(x, 1.0, 1e-12));
        ASSERT_LT(r.t_near[i], r.t_far[i]);
        ++reached;
      }
    };
    stream_rays<double>(scene, settings, one_thread(), look, content);
    EXPECT_GT(reached, 1000);
  }
}

// Under a sky of 1 W/(m^2 sr) alone a pixel's flux is its etendue.
TEST(RayStreamSurfaces, UnderAnEvenSkyFluxIsEtendue) {
  Scene scene = three_types();
  scene.flames.clear();
  CompiledScene compiled = compile(scene);
  compiled.lights.environment = {1};
  const RenderSettings settings = settings_of(Precision::double_precision);
  const Image flux = render(compiled, settings, threads(2)).light_field.channels[0].flux;
  std::vector<double> etendue(flux.pixels.size());
  const PixelWindow& window = settings.window;
  const RayBlockConsumer<double> add = [&](const RayBlock<double>& block, int) {
    for (std::size_t i = 0; i < block.etendue.size(); ++i)
      etendue[static_cast<std::size_t>((block.rows[i] - window.y) * window.width +
                                       block.columns[i] - window.x)] += block.etendue[i];
  };
  stream_rays<double>(compiled, settings, threads(2), add);
  for (std::size_t i = 0; i < etendue.size(); ++i)
    ASSERT_TRUE(relative(etendue[i], static_cast<double>(flux.pixels[i]), 2e-7));
}

}  // namespace
}  // namespace plenoflame::test::ray_stream_surfaces_test
