// Sums of very many samples, and pixels whose true value is zero.
#include <cmath>
#include <string>
#include <vector>

#include "plenoflame/film/film.h"
#include "plenoflame/media/layered_medium.h"
#include "plenoflame/render/render.h"
#include "render/tracer/pixel_sampler.h"
#include "stress/stress_table.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"
#include "support/isas.h"

namespace plenoflame::sums_stress_test {
namespace {

using test::StressCase;

constexpr const char* kArea = "Sums and dark pixels";

// 2e6 blocks of 512 samples, weights of 1 to 2 and radiances over eight decades, added as the
// renderer adds them. The products have 48 bits: a long double holds a block's sum exactly to
// 2^-64.
TEST(SumsStress, ABillionSamples) {
  StressCase sum(kArea, "sum of 1e9 samples in one pixel [relative]",
                 "long double, block times count", 1e-10);
  constexpr int kBlock = 512;
  constexpr double kBlocks = 2e6;
  std::vector<float> weight(kBlock), radiance(kBlock);
  long double block = 0;
  for (int i = 0; i < kBlock; ++i) {
    const auto at = static_cast<std::size_t>(i);
    weight[at] = 1 + static_cast<float>(i * 37 % 512) / 512;
    radiance[at] = std::pow(10.f, 8 * static_cast<float>(i * 101 % 512) / 512 - 4);
    block += static_cast<long double>(weight[at]) * static_cast<long double>(radiance[at]);
  }
  for (const Isa isa : {Isa::baseline, best_isa()}) {
    const auto kernels = backward_kernels<float>(isa);
    Film film({0, 0, 1, 1}, 1, 1);
    for (double b = 0; b < kBlocks; ++b)
      film.sum(0, 0, 0, 0) += kernels.sum(weight.data(), radiance.data(), kBlock);
    sum.add(static_cast<double>(film.sum(0, 0, 0, 0) / (block * kBlocks) - 1),
            std::string(name(isa)));
    // The picture says it in single precision: half a unit in the last place.
    film.add_samples(0, kBlock * kBlocks);
    const double mean = static_cast<double>(film.images(0).flux.at(0, 0));
    StressCase picture(kArea, "1e9 samples, mean as a picture says it [relative]",
                       "long double, block times count", 6.1e-8);
    picture.add(static_cast<double>(mean / (block / kBlock) - 1), std::string(name(isa)));
  }
}

// A pixel that gets few rays: up to 8 products are added in single precision, pairs first.
TEST(SumsStress, FewSamples) {
  StressCase sum(kArea, "sum of 8 samples in single precision [2^-24 relative]", "long double", 4);
  constexpr int kCount = 1 << 16;
  std::vector<float> weight(kCount + 8), radiance(kCount + 8);
  for (std::size_t i = 0; i < weight.size(); ++i) {
    weight[i] = 1 + static_cast<float>(i * 37 % 1021) / 1021;
    radiance[i] = std::pow(10.f, 8 * static_cast<float>(i * 101 % 1021) / 1021 - 4);
  }
  for (const Isa isa : test::supported_isas()) {
    const auto kernels = backward_kernels<float>(isa);
    std::vector<std::vector<float>> sums(4, std::vector<float>(kCount + 8));
    kernels.multiply(weight.data(), radiance.data(), kCount, sums[0].data());
    for (std::size_t k = 1; k <= kMostLog2Points; ++k)
      kernels.add_neighbours(sums[k - 1].data(), 1 << (k - 1), kCount, sums[k].data());
    for (std::size_t i = 0; i + 8 <= kCount; ++i) {
      long double exact = 0;
      for (std::size_t j = i; j < i + 8; ++j)
        exact += static_cast<long double>(weight[j]) * static_cast<long double>(radiance[j]);
      sum.add(static_cast<double>((sums[kMostLog2Points][i] / exact - 1) * 0x1p24L),
              std::string(name(isa)));
    }
  }
}

// Whole pictures: the same rays in single and in double precision. A ray that grazes the rim of a
// lens or a layer may fall to either side of it.
TEST(SumsStress, SingleAgainstDoublePrecision) {
  StressCase rms(kArea, "picture in single precision, RMS difference [mean flux]",
                 "double precision, baseline", 1e-3);
  StressCase total(kArea, "picture in single precision, total flux [relative]",
                   "double precision, baseline", 1e-5);
  for (const bool array : {true, false}) {
    const CompiledScene scene =
        compile(array ? test::paper_flame(60, 60) : test::bare_flame(60, 60, 2e-4));
    RenderSettings settings;
    settings.samples = 64;
    settings.isa = Isa::baseline;
    settings.precision = Precision::double_precision;
    const Image exact = render(scene, settings).light_field.channels[0].flux;
    settings.precision = Precision::single_precision;
    for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
      if (!is_supported(isa)) continue;
      settings.isa = isa;
      const Image image = render(scene, settings).light_field.channels[0].flux;
      double squares = 0, sum = 0, difference = 0;
      for (std::size_t i = 0; i < exact.pixels.size(); ++i) {
        const double d =
            static_cast<double>(image.pixels[i]) - static_cast<double>(exact.pixels[i]);
        squares += d * d;
        difference += d;
        sum += static_cast<double>(exact.pixels[i]);
      }
      const std::string where =
          std::string(array ? "array, " : "bare camera, ") + std::string(name(isa));
      rms.add(std::sqrt(squares * static_cast<double>(exact.pixels.size())) / sum, where);
      total.add(difference / sum, where);
    }
  }
}

double not_zero(const Image& image) {
  double count = 0;
  for (const float p : image.pixels) count += p == 0.f ? 0 : 1;
  return count;
}

// Pixels that cannot see the flame by a hundred pixels or more, with and without skipping, by both
// estimators; a flame that does not absorb; a flame that does not emit.
TEST(SumsStress, PixelsWhoseTrueValueIsZero) {
  StressCase pixels(kArea, "pixels not 0 whose true value is 0, or with an error [count]",
                    "geometry, kappa = 0, T = 0", 0);
  const CompiledScene scene = compile(test::paper_flame(3000, 3000));
  for (const Estimator estimator : {Estimator::backward, Estimator::forward})
    for (const bool skip : {true, false}) {
      RenderSettings settings;
      settings.estimator = estimator;
      settings.samples = estimator == Estimator::forward ? 20000 : 16;
      settings.skip = skip;
      settings.window = {200, 1400, 60, 60};
      const RenderResult result = render(scene, settings);
      pixels.add(not_zero(result.light_field.channels[0].flux) +
                     not_zero(result.light_field.channels[0].standard_error),
                 estimator == Estimator::forward ? "forward" : "backward");
      EXPECT_EQ(result.statistics.relative_error, 0);
      EXPECT_EQ(result.statistics.relative_error_bound, 0);
    }
  for (const bool cold : {true, false}) {
    Scene dark = test::paper_flame(64, 64);
    std::vector<EllipsoidLayer> layers{
        {{1, 0, 0}, {0.01, 0.02, 0.03}, cold ? 0.0 : 1800, cold ? 50.0 : 0.0}};
    const CompiledScene compiled =
        test::scene_of(dark.camera, make_layered_medium(layers, {}, {SourceFunction::total()}));
    for (const Estimator estimator : {Estimator::backward, Estimator::forward}) {
      RenderSettings settings;
      settings.estimator = estimator;
      settings.samples = estimator == Estimator::forward ? 20000 : 16;
      const RenderResult result = render(compiled, settings);
      pixels.add(not_zero(result.light_field.channels[0].flux), cold ? "T = 0" : "kappa = 0");
    }
  }
}

}  // namespace
}  // namespace plenoflame::sums_stress_test
