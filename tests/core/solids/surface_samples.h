#pragma once
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "plenoflame/solids/surface_scene.h"

/// Surfaces and random directions that the tests of surfaces share.
namespace plenoflame::test {

inline SolidSurfaceSpec shaped(SolidShape shape, double size) {
  SolidSurfaceSpec spec;
  spec.shape = shape;
  spec.radius = size;
  spec.height = 1.5 * size;
  spec.size = {size, 2 * size, 0.7 * size};
  spec.extent = {3 * size, 2 * size};
  return spec;
}

inline std::unique_ptr<SurfaceScene> scene_of(const std::vector<SolidSurfaceSpec>& surfaces,
                                              const std::string& folder = "") {
  return make_surface_scene(surfaces, folder, {SourceFunction::total()}, {});
}

/// A 64-bit linear congruential generator, its high bits stirred (PCG).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double operator()() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    const std::uint64_t word = ((state_ >> ((state_ >> 59) + 5)) ^ state_) * 12605985483714917081u;
    return (static_cast<double>(((word >> 43) ^ word) >> 11) + 0.5) * 0x1p-53;
  }
  /// Uniform over the sphere, by rejection.
  Vec3 direction() {
    for (;;) {
      const Vec3 v{2 * (*this)() - 1, 2 * (*this)() - 1, 2 * (*this)() - 1};
      const double square = dot(v, v);
      if (square > 1e-4 && square < 1) return (1 / std::sqrt(square)) * v;
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace plenoflame::test
