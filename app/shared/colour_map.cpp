#include "colour_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace plenoflame {
namespace {

constexpr std::size_t kStops = 17;
using Stops = std::array<std::array<unsigned char, 3>, kStops>;

// Perceptually uniform maps at equal steps, linear between. viridis and inferno: S. van der Walt
// and N. Smith, in the public domain (CC0). cividis: Nunez, Anderton and Renslow, PLoS ONE 13
// (2018) e0199239, made to look the same with and without red-green blindness.
constexpr Stops kViridis{{{68, 1, 84},
                          {72, 24, 106},
                          {71, 45, 123},
                          {66, 64, 134},
                          {59, 82, 139},
                          {51, 99, 141},
                          {44, 114, 142},
                          {38, 130, 142},
                          {33, 145, 140},
                          {31, 160, 136},
                          {40, 174, 128},
                          {63, 188, 115},
                          {94, 201, 98},
                          {132, 212, 75},
                          {173, 220, 48},
                          {216, 226, 25},
                          {253, 231, 37}}};
constexpr Stops kCividis{{{0, 34, 78},
                          {0, 46, 106},
                          {26, 56, 111},
                          {50, 67, 109},
                          {67, 78, 108},
                          {83, 90, 109},
                          {97, 101, 111},
                          {111, 112, 115},
                          {125, 124, 120},
                          {140, 136, 120},
                          {155, 148, 118},
                          {171, 160, 114},
                          {188, 174, 108},
                          {205, 187, 99},
                          {222, 201, 88},
                          {240, 216, 70},
                          {254, 232, 56}}};
constexpr Stops kInferno{{{0, 0, 4},
                          {11, 7, 36},
                          {33, 12, 74},
                          {61, 9, 101},
                          {87, 16, 110},
                          {113, 25, 110},
                          {138, 34, 106},
                          {163, 44, 97},
                          {188, 55, 84},
                          {210, 70, 68},
                          {228, 90, 49},
                          {241, 115, 29},
                          {249, 142, 9},
                          {252, 172, 17},
                          {249, 203, 53},
                          {242, 234, 105},
                          {252, 255, 164}}};
// Blue over white to red-brown, for values with a sign.
constexpr std::array<std::array<unsigned char, 3>, 5> kDiverging{
    {{33, 80, 158}, {135, 174, 214}, {245, 245, 245}, {226, 158, 110}, {158, 66, 20}}};

template <std::size_t N>
Rgb between(const std::array<std::array<unsigned char, 3>, N>& stops, double t) {
  const double place = t * static_cast<double>(N - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), N - 2);
  const double f = place - static_cast<double>(i);
  const auto mix = [&](std::size_t k) {
    return static_cast<unsigned char>(std::lround((1 - f) * stops[i][k] + f * stops[i + 1][k]));
  };
  return {mix(0), mix(1), mix(2)};
}

}  // namespace

Rgb colour(ColourMap map, double t) {
  t = std::isnan(t) ? 0 : std::clamp(t, 0.0, 1.0);
  switch (map) {
    case ColourMap::viridis:
      return between(kViridis, t);
    case ColourMap::cividis:
      return between(kCividis, t);
    case ColourMap::inferno:
      return between(kInferno, t);
    case ColourMap::diverging:
      return between(kDiverging, t);
    case ColourMap::grey:
      break;
  }
  const auto grey = static_cast<unsigned char>(std::lround(255 * t));
  return {grey, grey, grey};
}

Rgb flame_colour(ColourMap map, double t) {
  return colour(map, map == ColourMap::inferno ? 0.4 + 0.6 * t : t);
}

}  // namespace plenoflame
