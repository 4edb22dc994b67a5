#pragma once
#include <array>
#include <vector>

#include "core/media_voxel/voxel_fixture.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/spectral.h"

/// A flame whose light is a line's, in proportion to the samples of a grid: the linear problem's.
namespace plenoflame::test {

struct GlowingGrid {
  std::array<int, 3> count{};
  AffineTransform map;
  std::vector<double> emission, absorption;  ///< last axis fastest
};

inline FlameSpec glowing_flame(double wavelength = 431e-9) {
  FlameSpec flame;
  flame.kind = FlameKind::vdb;
  flame.file = "glow.vdb";
  flame.lines = {{LineKind::custom, wavelength, 0, {"glow"}}};
  return flame;
}

inline MediumLoader glowing_loader(const GlowingGrid& g) {
  return [g](const FlameSpec& flame, const std::string&,
             const std::vector<SourceFunction>& channels, const Execution&) {
    const auto field = [&](const std::vector<double>& samples) {
      return make_field(
          {0, 0, 0}, g.count,
          [&](int i, int j, int k) {
            return static_cast<float>(
                samples[static_cast<std::size_t>((i * g.count[1] + j) * g.count[2] + k)]);
          },
          g.map);
    };
    VoxelMediumOptions options;
    options.extras = {{field(g.emission)}, line_weights(flame, channels)};
    VoxelField cold = field(std::vector<double>(g.emission.size(), 0.0));
    cold.background = 1;
    return make_voxel_medium(cold, field(g.absorption), VoxelInterpolation::trilinear, channels,
                             options);
  };
}

}  // namespace plenoflame::test
