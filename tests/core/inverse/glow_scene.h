#pragma once
#include <cmath>

#include "plenoflame/inverse/unknowns.h"
#include "support/small_scene.h"

/// A ring of light before a small camera with microlenses: what reconstructions are tested with.
namespace plenoflame::test {

/// A sensor of 10 mm x 15 mm, in one channel. @param columns of its pixels, an even number
inline Scene glow_scene(int columns) {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  scene.camera.sensor = {columns, columns * 3 / 2, 10e-3 / columns};
  scene.channels = {{"650nm", ChannelKind::band, 650e-9, 10e-9}};
  return scene;
}

/// Rings 1 m in front of the camera, around the whole of the light.
inline RingGrid glow_rings() {
  RingGrid grid;
  grid.base = {1, 0, -9e-3};
  grid.radial_step = 0.5e-3;
  grid.height_step = 1.5e-3;
  grid.rings = 9;
  grid.heights = 13;
  return grid;
}

/// [W/(m^3 sr)] The ring of light, which fades towards the ends.
inline double glow_at(Vec3 p) {
  const double r = std::hypot(p.x - 1, p.y) / 4e-3, z = p.z / 6e-3;
  return 1000 * std::exp(-4 * (r - 0.5) * (r - 0.5) - z * z) * (r < 1 ? 1 - r * r : 0);
}

}  // namespace plenoflame::test
