#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "plenoflame/inverse/thermal_model.h"
#include "plenoflame/sampling/noise.h"
#include "support/approx.h"

/// Parts that the cases of the validation page have in common: rays that are given, not drawn; a
/// ring flame as fine as is wanted; and figures that tools/validation_page.py finds in the test's
/// output.
namespace plenoflame::test {

/// Notes a figure of the page: the test's properties hold "case: expected; found".
inline void note(const std::string& what, double expected, double found) {
  char text[96];
  std::snprintf(text, sizeof text, "%.6e %.6e", expected, found);
  testing::Test::RecordProperty(what, text);
}

/// One wavelength [m], monochromatic: S is Planck's function [W/(m^3 sr)].
inline SourceFunction planck(double wavelength) {
  constexpr double kC1 = 2 * 6.62607015e-34 * 299792458.0 * 299792458.0,
                   kC2 = 6.62607015e-34 * 299792458.0 / 1.380649e-23;
  return SourceFunction::node({kC2 / wavelength, kC1 / std::pow(wavelength, 5)}, wavelength, 1);
}

/// Every ray a row of its own, with weight 1: fluxes are radiances.
inline CameraRays rows_of(const std::vector<Ray>& rays) {
  CameraRays all;
  for (const Ray& ray : rays) {
    all.rows.push_back({0, 0, 0, all.rays.size()});
    all.rays.push_back({ray.origin, ray.direction, 1, 1e30, 0});
  }
  return all;
}

/// Rings of one height, the last of them beyond `radius`, which is in the middle of a step.
inline RingGrid fine_rings(double radius, int rings) {
  RingGrid grid;
  grid.rings = rings;
  grid.heights = 1;
  grid.radial_step = radius / (rings - 1.5);
  grid.height_step = radius;
  return grid;
}

/// Radiances of rays at height 0 through a round flame.
inline std::vector<double> chords(const RingGrid& grid,
                                  const std::function<double(double)>& temperature, double kappa,
                                  const SourceFunction& source, const CameraRays& rays) {
  const auto unknowns = make_ring_unknowns(grid);
  ThermalModel model;
  model.unknowns = unknowns.get();
  model.channels = {{&rays, source, 1}};
  // Beyond the edge nothing absorbs, and the temperature goes on: the edge is one of kappa alone.
  model.absorption.assign(unknowns->size(), kappa);
  model.absorption.back() = 0;
  std::vector<double> t;
  for (int i = 0; i < grid.rings; ++i) t.push_back(temperature(i * grid.radial_step));
  return thermal_fluxes(model, t);
}

/// Case B at a height: a cylinder with a hot ring [K]; r in m.
inline double hot_ring(double r, double z) {
  constexpr double kRadius = 20e-3, kHeight = 200e-3, m = 3, n = 0.9;
  const double q = m * (r * r / (kRadius * kRadius) + z * z / (kHeight * kHeight)) - n;
  return 900 + 1200 * std::exp(-q * q);
}

/// Noise of so many decibels: 20 log10(rms of b over lit pixels / sigma).
inline double sigma_of(const std::vector<double>& b, double decibels) {
  double largest = 0, sum = 0, lit = 0;
  for (const double value : b) largest = std::max(largest, value);
  for (const double value : b)
    if (value > 1e-6 * largest) sum += value * value, ++lit;
  return std::sqrt(sum / lit) / std::pow(10, decibels / 20);
}

}  // namespace plenoflame::test
