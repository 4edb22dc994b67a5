// The vector kernels of rays through walls of glass, against rays that are traced one by one.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "plenoflame/base/constants.h"
#include "plenoflame/optics/window_set.h"
#include "plenoflame/scene/compile.h"
#include "render/transport/medium_behind_windows.h"
#include "support/approx.h"
#include "support/isas.h"
#include "support/small_scene.h"

namespace plenoflame::test::window_wall_test {
namespace {

constexpr double kRight = 0.5 * constants::pi;
const Vec3 kMiddle{1, 0.001, 0};  ///< of the medium

/// A medium whose radiance is what line it was asked about: place and direction nearest to a point.
class Lines : public Medium {
 public:
  int channel_count() const override { return 6; }
  Box bounds() const override {
    return {kMiddle - Vec3{0.004, 0.004, 0.004}, kMiddle + Vec3{0.004, 0.004, 0.004}};
  }
  double feature_size() const override { return 1e-3; }
  void integrate(const RayBatch<float>& rays, const MediumOptions&, RadianceBatch<float> out,
                 MediumCounters&) const override {
    tell(rays, out);
  }
  void integrate(const RayBatch<double>& rays, const MediumOptions&, RadianceBatch<double> out,
                 MediumCounters&) const override {
    tell(rays, out);
  }
  MediumSample sample(Vec3) const override { return {}; }
  double source(int, double) const override { return 0; }
  void append_breakpoints(const Ray&, std::vector<double>&) const override {}
  std::string description() const override { return "lines"; }

 private:
  template <class Real>
  static void tell(const RayBatch<Real>& rays, RadianceBatch<Real> out) {
    const Real* const from[6] = {rays.x, rays.y, rays.z, rays.dx, rays.dy, rays.dz};
    for (int c = 0; c < 6; ++c)
      for (int i = 0; i < rays.size; ++i) out.radiance[c * out.stride + i] = from[c][i];
    for (int i = 0; i < rays.size; ++i) out.transmittance[i] = 1;
  }
};

WindowSpec plate(Vec3 rotation, bool round) {
  WindowSpec window;
  window.position = {0.6, 0, 0};
  window.rotation = rotation;
  window.thickness = 0.02;
  if (round)
    window.diameter = 0.04;
  else
    window.extent = {0.05, 0.03};
  window.index = 1.7;
  window.absorption = 7;
  window.fresnel = true;
  return window;
}

WindowSpec wedge() {
  WindowSpec window = plate({0.1, -kRight + 0.2, 0.3}, true);
  window.shape = WindowShape::wedge;
  window.angle = 0.02;
  return window;
}

WindowSpec tube() {
  WindowSpec window;
  window.shape = WindowShape::tube;
  window.position = {1, 0, -0.02};
  window.rotation = {0.1, 0.05, 0};
  window.radius = 0.012;
  window.thickness = 0.002;
  window.height = 0.04;
  window.index = 1.46;
  window.fresnel = true;
  return window;
}

/// Rays from a camera at the origin to the surroundings of the medium, as a block has them.
template <class Real>
struct Rays {
  static constexpr int kCount = 1024;
  std::vector<Real> values = std::vector<Real>(6 * kCount + 16);
  RayBatch<Real> batch;
  std::vector<Ray> world;
  Rays() {
    Real* base = values.data();
    while (reinterpret_cast<std::uintptr_t>(base) % 64 != 0) ++base;
    double u[4] = {};
    for (int i = 0; i < kCount; ++i) {
      constexpr double kStep[4] = {0.8566748838545029, 0.733891856627126, 0.6287067210378087,
                                   0.5385972572236101};
      for (std::size_t d = 0; d < 4; ++d) u[d] = std::fmod(u[d] + kStep[d], 1.0);
      const Vec3 from{0.02, 0.03 * (u[0] - 0.5), 0.03 * (u[1] - 0.5)};
      const Vec3 to = kMiddle + Vec3{0, 0.04 * (u[2] - 0.5), 0.04 * (u[3] - 0.5)};
      const Vec3 d = normalize(to - from), o = to - kMiddle;
      const double each[6] = {o.x, o.y, o.z, d.x, d.y, d.z};
      for (int k = 0; k < 6; ++k) base[k * kCount + i] = static_cast<Real>(each[k]);
      world.push_back({from, d});
    }
    batch.size = kCount;
    batch.anchor = kMiddle;
    batch.x = base, batch.y = base + kCount, batch.z = base + 2 * kCount;
    batch.dx = base + 3 * kCount, batch.dy = base + 4 * kCount, batch.dz = base + 5 * kCount;
  }
};

/// @param tolerance of directions and, in metres, of places
template <class Real>
void expect_the_same_lines(const std::vector<WindowSpec>& windows, Isa isa, double tolerance) {
  Scene plain = small_scene(singlet(), {});
  plain.windows = windows;
  CompiledScene scene = compile(plain);
  scene.medium = std::make_shared<Lines>();
  const auto medium = MediumBehindWindows::make(scene);
  ASSERT_TRUE(medium);
  const Rays<Real> rays;
  constexpr int kCount = Rays<Real>::kCount;
  std::vector<Real> radiance(6 * kCount), transmittance(kCount);
  MediumOptions options;
  options.isa = isa;
  MediumCounters counters;
  medium->integrate(rays.batch, options, {radiance.data(), kCount, transmittance.data()}, counters);
  int bent = 0;
  for (int i = 0; i < kCount; ++i) {
    WindowPath path;
    scene.windows->trace(rays.world[static_cast<std::size_t>(i)], path);
    const auto told = [&](int c) {
      return static_cast<double>(radiance[static_cast<std::size_t>(c * kCount + i)]);
    };
    const double through = length(Vec3{told(3), told(4), told(5)});
    // The stretch that comes nearest to the medium's middle.
    const AirSegment* nearest = nullptr;
    double distance = 0.004;
    for (const AirSegment& stretch : path.segments) {
      const Vec3 o = stretch.ray.origin - kMiddle, d = stretch.ray.direction;
      const double t = -dot(o, d);
      if (t < 0 || t > stretch.far || !(length(o + t * d) < distance)) continue;
      nearest = &stretch;
      distance = length(o + t * d);
    }
    if (!nearest) continue;  // it does not meet the medium
    ++bent;
    const Vec3 o = nearest->ray.origin - kMiddle, d = nearest->ray.direction;
    const Vec3 at = o - dot(o, d) * d;
    EXPECT_TRUE(relative(through, nearest->throughput, 4 * tolerance)) << i;
    EXPECT_LT(length((1 / through) * Vec3{told(0), told(1), told(2)} - at), tolerance) << i;
    EXPECT_LT(length((1 / through) * Vec3{told(3), told(4), told(5)} - d), tolerance) << i;
  }
  EXPECT_GT(bent, 20);
}

TEST(WindowWalls, KernelsGoTheWaysOfSingleRays) {
  const std::vector<std::vector<WindowSpec>> all{{plate({0, kRight, 0}, true)},
                                                 {plate({0.2, -kRight + 0.3, 0.1}, false)},
                                                 {wedge()},
                                                 {tube()},
                                                 {wedge(), tube()}};
  for (const std::vector<WindowSpec>& windows : all)
    for (const Isa isa : supported_isas()) {
      SCOPED_TRACE(plenoflame::name(isa));
      expect_the_same_lines<double>(windows, isa, 1e-12);
      expect_the_same_lines<float>(windows, isa, 2e-6);
    }
}

// Crossings that the walls' order does not tell are left to rays that are traced one by one.
TEST(WindowWalls, OtherArrangementsAreNotTaken) {
  const auto taken = [](const std::vector<WindowSpec>& windows) {
    Scene plain = small_scene(singlet(), {});
    plain.windows = windows;
    CompiledScene scene = compile(plain);
    scene.medium = std::make_shared<Lines>();
    return MediumBehindWindows::make(scene) != nullptr;
  };
  EXPECT_TRUE(taken({tube()}));
  WindowSpec before = tube();
  before.position.x = 0.5;
  EXPECT_FALSE(taken({before})) << "a tube in front of the flame";
  WindowSpec beside = plate({0, 0, 0}, true);
  beside.position = {1, 0, -0.06};
  EXPECT_FALSE(taken({beside})) << "a plate below the flame";
  WindowSpec behind = plate({0, kRight, 0}, true);
  behind.position.x = 1.2;
  EXPECT_TRUE(taken({behind}));
}

}  // namespace
}  // namespace plenoflame::test::window_wall_test
