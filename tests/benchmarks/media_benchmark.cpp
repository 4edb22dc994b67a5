// Layered flame and exponentials, per instruction set. "per_ray" and "per_value" are times of one.
#include <benchmark/benchmark.h>

#include <random>
#include <vector>

#include "plenoflame/base/isa.h"
#include "plenoflame/media/layered_medium.h"

namespace plenoflame {

#define PLENOFLAME_DECLARE_PROBE(isa)                                                  \
  namespace isa {                                                                      \
  void bench_exp(const float*, int, float*);                                           \
  void bench_attenuation(const float*, int, float*, float*);                           \
  void bench_linear_transfer(const float*, int, float*, float*, float*);               \
  void probe_source_float(const float*, const float*, int, const float*, float*, int); \
  }
PLENOFLAME_DECLARE_PROBE(baseline)
#if defined(__x86_64__)
PLENOFLAME_DECLARE_PROBE(avx2)
PLENOFLAME_DECLARE_PROBE(avx512)
#endif

namespace {

constexpr int kSize = 1024;

template <class Function>
void on_isa(benchmark::State& state, Isa isa, Function function) {
  if (!is_supported(isa)) {
    state.SkipWithError("not supported by this processor");
    return;
  }
  function();
  state.SetLabel(std::string(name(isa)));
  state.counters["per_value"] = benchmark::Counter(
      kSize, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

struct Values {
  alignas(64) float in[kSize], a[kSize], b[kSize], c[kSize];
  explicit Values(float low, float high) {
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> u(low, high);
    for (float& v : in) v = u(engine);
  }
};

#if defined(__x86_64__)
#define PLENOFLAME_CALL(isa, function, ...)           \
  (isa == Isa::avx512 ? avx512::function(__VA_ARGS__) \
   : isa == Isa::avx2 ? avx2::function(__VA_ARGS__)   \
                      : baseline::function(__VA_ARGS__))
#else
#define PLENOFLAME_CALL(isa, function, ...) baseline::function(__VA_ARGS__)
#endif

void exponential(benchmark::State& state) {
  const auto isa = static_cast<Isa>(state.range(0));
  on_isa(state, isa, [&] {
    Values v(-20, 0);
    for (auto _ : state) {
      PLENOFLAME_CALL(isa, bench_exp, v.in, kSize, v.a);
      benchmark::ClobberMemory();
    }
  });
}
void attenuation(benchmark::State& state) {
  const auto isa = static_cast<Isa>(state.range(0));
  on_isa(state, isa, [&] {
    Values v(0, 5);
    for (auto _ : state) {
      PLENOFLAME_CALL(isa, bench_attenuation, v.in, kSize, v.a, v.b);
      benchmark::ClobberMemory();
    }
  });
}
void linear_transfer(benchmark::State& state) {
  const auto isa = static_cast<Isa>(state.range(0));
  on_isa(state, isa, [&] {
    Values v(0, 5);
    for (auto _ : state) {
      PLENOFLAME_CALL(isa, bench_linear_transfer, v.in, kSize, v.a, v.b, v.c);
      benchmark::ClobberMemory();
    }
  });
}
void planck_node(benchmark::State& state) {
  const auto isa = static_cast<Isa>(state.range(0));
  on_isa(state, isa, [&] {
    Values v(800, 2500);
    const float exponent = 22135.0f, weight = 1e7f;
    for (auto _ : state) {
      PLENOFLAME_CALL(isa, probe_source_float, &exponent, &weight, 1, v.in, v.a, kSize);
      benchmark::ClobberMemory();
    }
  });
}

/// Rays of a camera 1 m away over the default flame of three layers. @param overlapping adds a
/// fourth layer in such a place that the layers no longer nest.
void layered(benchmark::State& state) {
  const auto isa = static_cast<Isa>(state.range(0));
  const bool overlapping = state.range(1) != 0;
  const auto channel_count = static_cast<std::size_t>(state.range(2));
  std::vector<EllipsoidLayer> layers{{{0, 0, 0.014}, {0.004, 0.004, 0.012}, 1200, 1.0},
                                     {{0, 0, 0.022}, {0.007, 0.007, 0.022}, 1650, 30.0},
                                     {{0, 0, 0.029}, {0.010, 0.010, 0.030}, 1900, 1.5}};
  if (overlapping) layers[0].centre = {0.002, 0.005, 0.014};
  std::vector<SourceFunction> channels(channel_count, SourceFunction::total());
  const auto medium = make_layered_medium(layers, {}, channels);

  alignas(64) static float ray[6][kSize], transmittance[kSize], radiance[4 * kSize];
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < kSize; ++i) {
    const Vec3 d = normalize({1, 0.06 * u(engine), 0.06 * u(engine)});
    const float values[6] = {0,
                             static_cast<float>(0.01 * u(engine)),
                             static_cast<float>(0.03 * u(engine)),
                             static_cast<float>(d.x),
                             static_cast<float>(d.y),
                             static_cast<float>(d.z)};
    for (int c = 0; c < 6; ++c) ray[c][i] = values[c];
  }
  const RayBatch<float> rays{kSize,  {0, 0, 0.029}, ray[0], ray[1],  ray[2],
                             ray[3], ray[4],        ray[5], nullptr, nullptr};
  MediumOptions options;
  options.isa = isa;
  MediumCounters counters;
  on_isa(state, isa, [&] {
    for (auto _ : state) {
      medium->integrate(rays, options, {radiance, kSize, transmittance}, counters);
      benchmark::ClobberMemory();
    }
  });
}

BENCHMARK(exponential)->DenseRange(0, 2);
BENCHMARK(attenuation)->DenseRange(0, 2);
BENCHMARK(linear_transfer)->DenseRange(0, 2);
BENCHMARK(planck_node)->DenseRange(0, 2);
BENCHMARK(layered)
    ->ArgNames({"isa", "overlapping", "channels"})
    ->ArgsProduct({{0, 1, 2}, {0, 1}, {1, 3}});

}  // namespace
}  // namespace plenoflame
