#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/media/medium.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame::desktop {

/// The light of a scene's flames as eyes see it, at the points of a lattice along the world's axes.
struct EyeFlame {
  struct Point {
    float x = 0, y = 0, z = 0;  ///< emission in CIE X, Y, Z [W/(m^3 sr)]
    float absorption = 0;       ///< of that light [1/m]
  };
  Vec3 origin;  ///< [m] world; the first point
  Vec3 step;    ///< [m] between points
  std::array<int, 3> count{};
  std::vector<Point> points;  ///< x fastest
  /// Luminance Y [W/(m^2 sr)] of the bright parts, seen along an axis; 0: it gives no light.
  double bright = 0;
  Box box() const;
};

/// @param longest points along the longest side
/// @param known media of the scene's flames before their brightness (CompiledScene::loaded); those
/// that suit the eye, too, are not loaded once more
/// @return null when there are no flames  @throws InputError, FileError, Cancelled
std::shared_ptr<const EyeFlame> eye_flame(
    const Scene& scene, int longest, const Execution& execution,
    const std::vector<std::shared_ptr<const Medium>>& known = {});

/// A rectangle that is seen from a point: the pixels that are drawn of it.
struct EyeWindow {
  Vec3 eye;
  Vec3 corner;        ///< upper left corner of the rectangle
  Vec3 across, down;  ///< [m] along its whole sides
  int width = 0, height = 0;
  Box kept;  ///< [m] what is outside of it is cut away
};

/// The light that reaches the eye through the middle of each pixel.
struct EyeLight {
  int width = 0, height = 0;
  struct Pixel {
    float x = 0, y = 0, z = 0;  ///< CIE X, Y, Z [W/(m^2 sr)]
    float passed = 1;           ///< share of the light from behind the flame
  };
  std::vector<Pixel> pixels;
};
/// @throws Cancelled
EyeLight eye_light(const EyeFlame& flame, const EyeWindow& window, const Execution& execution);

/// Red, green, blue and opacity in sRGB, 8 bits each, rows from the top. Light that is brighter
/// than the screen goes towards white, with a little glare around it.
/// @param exposure [stops] beside the automatic one  @param glare its radius [pixel]
std::vector<std::uint8_t> eye_picture(EyeLight light, double bright, double exposure, int glare);

}  // namespace plenoflame::desktop
