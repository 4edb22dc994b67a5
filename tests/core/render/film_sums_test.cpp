// The film adds each ray of a block once, to the ray's own randomisation.
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "plenoflame/scene/compile.h"
#include "render/estimators/film_sums.h"
#include "render/sampling/backward_tile.h"
#include "render/transport/radiance_integrator.h"
#include "render/transport/scene_medium.h"
#include "support/approx.h"
#include "support/flame_scenes.h"
#include "support/isas.h"

namespace plenoflame::test::film_sums_test {
namespace {

/// Adds up, one after the other, the rays of a tracer.
template <class Real>
class Adder : public RayConsumer<Real> {
 public:
  Adder(const BackwardPlan<Real>& plan, Film& film)
      : replicates_(film.replicates()), integrator_(plan), sums_(plan, film) {}
  void begin_tile(int index, const PixelWindow& tile) override { sums_.begin_tile(index, tile); }
  void traced(const TracedRays<Real>& rays) override {
    integrator_.integrate(rays);
    sums_.add(rays, integrator_.radiance());
    for (const PixelRays& pixel : rays.pixels) add(pixel, rays.block.weight);
  }

  struct Pixel {
    long double total = 0;
    std::vector<long double> sums;
  };
  std::map<std::pair<int, int>, Pixel> pixels;
  std::map<int, int> counts;  ///< of rays that came together

 private:
  void add(const PixelRays& rays, const Real* weight) {
    Pixel& pixel = pixels[{rays.column, rays.row}];
    pixel.sums.resize(static_cast<std::size_t>(replicates_));
    ++counts[rays.count];
    for (int i = 0; i < rays.count; ++i) {
      const long double term = static_cast<long double>(rays.scale) *
                               static_cast<long double>(weight[rays.first + i]) *
                               static_cast<long double>(integrator_.radiance()[rays.first + i]);
      pixel.total += term;
      pixel.sums.at(static_cast<std::size_t>((rays.offset + i) / rays.points)) += term;
    }
  }

  int replicates_;
  RadianceIntegrator<Real> integrator_;
  FilmSums<Real> sums_;
};

/// @return how many rays came together, how often
template <class Real>
std::map<int, int> expect_film_holds_rays(const CompiledScene& scene, Isa isa, int samples,
                                          int replicates) {
  RenderSettings settings;
  settings.samples = samples;
  settings.replicates = replicates;
  settings.isa = isa;
  const SceneMedium medium(scene);
  const PointRange range{0, samples / replicates};
  const BackwardPlan<Real> plan =
      make_pass_plan<Real>(scene, medium.get(), settings, range, nullptr, nullptr);
  Film film({20, 24, 24, 20}, 1, replicates);
  Adder<Real> adder(plan, film);
  TileTracer<Real> tracer(plan, adder);
  tracer.trace(0, film.tile(0));
  int lit = 0;
  for (const auto& [place, pixel] : adder.pixels) {
    for (int r = 0; r < replicates; ++r)
      EXPECT_TRUE(within(film.sum(0, r, place.first, place.second),
                         static_cast<double>(pixel.sums[static_cast<std::size_t>(r)]),
                         4 * static_cast<double>(std::numeric_limits<Real>::epsilon()),
                         static_cast<double>(pixel.total)))
          << samples << " samples";
    lit += pixel.total > 0 ? 1 : 0;
  }
  EXPECT_GT(lit, 200);
  return adder.counts;
}

// Randomisations of 1, 2, 4, 8 and 16 points, of numbers that are no powers of two, and pixels that
// no block holds.
template <class Real>
void check_film_sums() {
  const CompiledScene scene = compile(paper_flame(64, 64, 0.001));
  for (const Isa isa : supported_isas()) {
    for (const int samples : {4, 8, 16, 32, 64, 12, 20, 44})
      EXPECT_GT(expect_film_holds_rays<Real>(scene, isa, samples, 4)[samples], 50);
    EXPECT_GT(expect_film_holds_rays<Real>(scene, isa, 24, 8)[24], 50);
    EXPECT_GT(expect_film_holds_rays<Real>(scene, isa, kBlockRays + 8, 4)[8], 50);
  }
}

TEST(FilmSums, EachRayIsAddedOnceToItsOwnRandomisation) {
  check_film_sums<double>();
  check_film_sums<float>();
}

}  // namespace
}  // namespace plenoflame::test::film_sums_test
