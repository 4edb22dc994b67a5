// How fast the error falls with the number of samples.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "plenoflame/render/render.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"

namespace plenoflame::test {
namespace {

/// Slope of log RMSE over lit pixels against log samples, least squares, double precision.
double slope(const CompiledScene& scene, PixelWindow window) {
  RenderSettings settings;
  settings.window = window;
  settings.precision = Precision::double_precision;
  settings.samples = 1 << 15;
  settings.seed = 99;
  const Image exact = render(scene, settings).light_field.channels[0].flux;
  float brightest = 0;
  for (const float p : exact.pixels) brightest = std::max(brightest, p);
  std::vector<double> x, y;
  for (int samples = 16; samples <= 1024; samples *= 4) {
    double squares = 0;
    int lit = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      settings.samples = samples;
      settings.seed = seed;
      const Image flux = render(scene, settings).light_field.channels[0].flux;
      for (std::size_t i = 0; i < flux.pixels.size(); ++i) {
        if (exact.pixels[i] < 0.01f * brightest) continue;
        const double d = static_cast<double>(flux.pixels[i]) - static_cast<double>(exact.pixels[i]);
        squares += d * d;
        ++lit;
      }
    }
    x.push_back(std::log(samples));
    y.push_back(0.5 * std::log(squares / lit));
  }
  double mx = 0, my = 0, xy = 0, xx = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mx += x[i] / static_cast<double>(x.size());
    my += y[i] / static_cast<double>(x.size());
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (x[i] - mx) * (y[i] - my);
    xx += (x[i] - mx) * (x[i] - mx);
  }
  ::testing::Test::RecordProperty("slope", std::to_string(xy / xx));
  return xy / xx;
}

TEST(Convergence, PaperFlameWithClippedApertures) {
  EXPECT_LT(slope(compile(paper_flame(300, 300)), {140, 140, 24, 24}), -0.65);
}

TEST(Convergence, WhereThePupilIsNotClipped) {
  EXPECT_LT(slope(compile(bare_flame(200, 170, 1e-4)), {90, 75, 20, 20}), -1.2);
}

}  // namespace
}  // namespace plenoflame::test
