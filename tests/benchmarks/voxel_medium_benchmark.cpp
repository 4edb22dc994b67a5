// Rays per second and integration error of the voxel medium: 256^3 grids of the layered flame and
// of a smooth annular one, coherent rays from a pinhole 1 m away that all pass the flame's bounds.
// rel_rmse and max_error compare with adaptive quadrature of the same interpolated fields, relative
// to the largest radiance (rms_rel: relative to the rms radiance).
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "plenoflame/media/voxel_medium.h"

namespace plenoflame {
namespace {

constexpr int kSide = 256;
constexpr double kVoxel = 0.25e-3;

struct State {
  double temperature, absorption;
};

// docs/theory/emission.md: three ellipsoids, the innermost wins.
State layered(Vec3 p) {
  struct Layer {
    double a, b, z, temperature, absorption;
  };
  static const Layer layers[3] = {{4e-3, 12e-3, 14e-3, 1200, 1.0},
                                  {7e-3, 22e-3, 22e-3, 1650, 30},
                                  {10e-3, 30e-3, 29e-3, 1900, 1.5}};
  for (const Layer& l : layers) {
    const double x = p.x / l.a, y = p.y / l.a, z = (p.z - l.z) / l.b;
    if (x * x + y * y + z * z < 1) return {l.temperature, l.absorption};
  }
  return {300, 0};
}

// Annular soot field, hottest 1.5 mm outside of it.
State candle(Vec3 p) {
  const double r = std::hypot(p.x, p.y), h = p.z / 55e-3;
  if (h <= 0 || h >= 1) return {300, 0};
  const double radius = 4e-3 * std::sqrt(1 - h) * (1 + 2 * h) / 1.5, width = 1.2e-3;
  const double soot =
      std::exp(-std::pow((r - radius) / width, 2)) * std::pow(std::sin(3.1416 * h), 2);
  const double hot = std::exp(-std::pow((r - radius - 1.5e-3) / 4e-3, 2));
  const double absorption = 40 * soot;
  return {300 + 1500 * hot, absorption < 0.04 ? 0 : absorption};
}

std::unique_ptr<Medium> make(const std::function<State(Vec3)>& state,
                             std::vector<SourceFunction> channels, double tolerance) {
  VoxelField t, k;
  t.name = "temperature";
  k.name = "absorption";
  t.background = 300;
  AffineTransform transform;
  transform.linear = {{{{kVoxel, 0, 0}, {0, kVoxel, 0}, {0, 0, kVoxel}}}};
  transform.translation = {1 - 0.5 * (kSide - 1) * kVoxel, -0.5 * (kSide - 1) * kVoxel, -2e-3};
  t.index_to_world = k.index_to_world = transform;
  for (int bi = 0; bi < kSide; bi += 8)
    for (int bj = 0; bj < kSide; bj += 8)
      for (int bk = 0; bk < kSide; bk += 8) {
        std::vector<float> tv, kv;
        bool any = false;
        for (int v = 0; v < 512; ++v) {
          Vec3 p =
              transform.point({double(bi + v / 64), double(bj + v / 8 % 8), double(bk + v % 8)});
          p.x -= 1;
          const State s = state(p);
          tv.push_back(float(s.temperature));
          kv.push_back(float(s.absorption));
          any = any || s.absorption > 0 || s.temperature != 300;
        }
        if (!any) continue;
        t.brick_origins.push_back({bi, bj, bk});
        k.brick_origins.push_back({bi, bj, bk});
        t.values.insert(t.values.end(), tv.begin(), tv.end());
        k.values.insert(k.values.end(), kv.begin(), kv.end());
      }
  return make_voxel_medium(std::move(t), std::move(k), VoxelInterpolation::trilinear,
                           std::move(channels), {tolerance});
}

struct Rays {
  std::vector<Vec3> direction;
  std::vector<float> x, y, z, dx, dy, dz;
  Vec3 anchor;
};

// 4 x 4 tiles of rays 0.16 mm apart at the flame make the packets of 16.
Rays pinhole_rays(const Box& bounds) {
  Rays rays;
  rays.anchor = 0.5 * (bounds.lower + bounds.upper);
  const int columns = 128, rows = 384;
  const double near = bounds.lower.x;
  for (int tile = 0; tile < columns * rows / 16; ++tile)
    for (int i = 0; i < 16; ++i) {
      const int c = tile % (columns / 4) * 4 + i % 4, r = tile / (columns / 4) * 4 + i / 4;
      const Vec3 through{near,
                         bounds.lower.y + (c + 0.5) / columns * (bounds.upper.y - bounds.lower.y),
                         bounds.lower.z + (r + 0.5) / rows * (bounds.upper.z - bounds.lower.z)};
      const Vec3 d = normalize(through - Vec3{0, 0, 0.03});
      rays.direction.push_back(d);
    }
  for (const Vec3& d : rays.direction) {
    const Vec3 o{0, 0, 0.03};
    const double t = rays.anchor.x / d.x;
    const Vec3 p = o + t * d - rays.anchor;
    rays.x.push_back(float(p.x));
    rays.y.push_back(float(p.y));
    rays.z.push_back(float(p.z));
    rays.dx.push_back(float(d.x));
    rays.dy.push_back(float(d.y));
    rays.dz.push_back(float(d.z));
  }
  return rays;
}

// Adaptive 8-point Gauss quadrature between the medium's breakpoints.
double truth(const Medium& medium, const Ray& ray) {
  static const double x[4] = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674,
                              0.96028985649753623};
  static const double w[4] = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447,
                              0.10122853629037626};
  std::vector<double> t;
  medium.append_breakpoints(ray, t);
  std::sort(t.begin(), t.end());
  const auto gauss = [&](double a, double b, const auto& f) {
    double sum = 0;
    for (int i = 0; i < 4; ++i)
      sum += w[i] * (f(0.5 * ((a + b) - (b - a) * x[i])) + f(0.5 * ((a + b) + (b - a) * x[i])));
    return 0.5 * (b - a) * sum;
  };
  const auto kappa = [&](double s) { return medium.sample(ray.at(s)).absorption; };
  const std::function<double(double, double, double&, int)> panel =
      [&](double a, double b, double& tau, int depth) -> double {
    const auto piece = [&](double from, double to) {
      return gauss(from, to, [&](double s) {
        const MediumSample at = medium.sample(ray.at(s));
        return at.absorption == 0 ? 0.0
                                  : at.absorption * medium.source(0, at.temperature) *
                                        std::exp(-gauss(from, s, kappa));
      });
    };
    const double m = 0.5 * (a + b), half = gauss(a, m, kappa);
    const double one = piece(a, b), two = piece(a, m) + std::exp(-half) * piece(m, b);
    tau = half + gauss(m, b, kappa);
    if (depth > 12 || std::fabs(one - two) <= 1e-9 * std::fabs(two)) return two;
    double t0, t1;
    const double l0 = panel(a, m, t0, depth + 1), l1 = panel(m, b, t1, depth + 1);
    return l0 + std::exp(-t0) * l1;
  };
  double radiance = 0, passed = 0;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    if (!(t[i + 1] > t[i] + 1e-15)) continue;
    double tau;
    const double l = panel(t[i], t[i + 1], tau, 0);
    radiance += std::exp(-passed) * l;
    passed += tau;
  }
  return radiance;
}

struct Setup {
  std::unique_ptr<Medium> medium;
  Rays rays;
  std::vector<int> checked;
  std::vector<double> expected;
};

const Setup& setup(const std::string& flame, bool band, double tolerance) {
  static std::vector<std::pair<std::string, Setup>> made;
  const std::string key = flame + (band ? " band " : " total ") + std::to_string(1e9 * tolerance);
  for (const auto& [name, s] : made)
    if (name == key) return s;
  Setup s;
  s.medium =
      make(flame == "layered" ? layered : candle,
           {band ? SourceFunction::band(650e-9, 10e-9) : SourceFunction::total()}, tolerance);
  s.rays = pinhole_rays(s.medium->bounds());
  for (std::size_t i = 7; i < s.rays.x.size(); i += 197) {
    s.checked.push_back(int(i));
    s.expected.push_back(truth(*s.medium, {{0, 0, 0.03}, s.rays.direction[i]}));
  }
  made.emplace_back(key, std::move(s));
  return made.back().second;
}

void integrate(benchmark::State& state, const std::string& flame, bool band, Isa isa, bool skip,
               double tolerance) {
  if (!is_supported(isa)) {
    state.SkipWithError("not supported by this processor");
    return;
  }
  const Setup& s = setup(flame, band, tolerance);
  const int count = int(s.rays.x.size());
  std::vector<float> radiance(s.rays.x.size()), transmittance(s.rays.x.size());
  MediumOptions options;
  options.isa = isa;
  options.skip = skip;
  MediumCounters counters;
  for (auto _ : state) {
    counters = {};
    for (int first = 0; first < count; first += 512) {
      RayBatch<float> batch;
      batch.size = 512;
      batch.anchor = s.rays.anchor;
      batch.x = s.rays.x.data() + first;
      batch.y = s.rays.y.data() + first;
      batch.z = s.rays.z.data() + first;
      batch.dx = s.rays.dx.data() + first;
      batch.dy = s.rays.dy.data() + first;
      batch.dz = s.rays.dz.data() + first;
      s.medium->integrate(batch, options,
                          {radiance.data() + first, 512, transmittance.data() + first}, counters);
    }
    benchmark::DoNotOptimize(radiance.data());
  }
  double sum = 0, worst = 0, norm = 0, peak = 0;
  for (std::size_t i = 0; i < s.checked.size(); ++i) {
    const double error = radiance[std::size_t(s.checked[i])] - s.expected[i];
    sum += error * error;
    norm += s.expected[i] * s.expected[i];
    worst = std::max(worst, std::fabs(error));
    peak = std::max(peak, s.expected[i]);
  }
  state.SetItemsProcessed(state.iterations() * count);
  state.counters["rms_rel"] = std::sqrt(sum / norm);
  state.counters["max_error"] = worst / peak;
  state.counters["cells_per_ray"] = counters.cells / count;
  state.counters["constant_per_ray"] = counters.skipped_constant / count;
  state.counters["empty_per_ray"] = counters.skipped_empty / count;
  state.SetLabel(s.medium->description());
}

void add(const std::string& flame, bool band, Isa isa, bool skip, double tolerance,
         const std::string& variant) {
  const std::string title =
      "voxels/" + flame + (band ? "/band/" : "/total/") + std::string(name(isa)) + variant;
  benchmark::RegisterBenchmark(title.c_str(), [=](benchmark::State& state) {
    integrate(state, flame, band, isa, skip, tolerance);
  })->Unit(benchmark::kMillisecond);
}

const int registered = [] {
  const double usual = VoxelMediumOptions{}.tolerance;
  for (const std::string flame : {"layered", "candle"})
    for (const bool band : {true, false}) {
      for (const Isa isa : {Isa::avx512, Isa::avx2, Isa::baseline})
        add(flame, band, isa, true, usual, "");
      add(flame, band, best_isa(), false, usual, "/no_skip");
      for (const double tolerance : {0.0, 1e-5, 1e-4, 1e-3, 1e-2})
        add(flame, band, best_isa(), true, tolerance, "/tolerance:" + std::to_string(tolerance));
    }
  return 0;
}();

}  // namespace
}  // namespace plenoflame
