#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "plenoflame/render/compiled_camera.h"
#include "render/compiled/moment_walk.h"

namespace plenoflame {

/// A ray of a bundle: place in the plane through the middle of the region, and slope, in the
/// camera's axes.
struct BundleRay {
  std::array<float, 4> place{};  ///< u, v [m], slopes
  float weight = 0;              ///< [m^2 sr]
};

/// Polynomials in a bundle's own coordinates. These are place and slope, rotated and scaled so that
/// the spread of the bundle is 1 along each, the widest first. All polynomials of degree 1 are
/// included. Products of degree 2 are limited to the widest coordinates.
class BundlePolynomials {
 public:
  /// @param level 1 to kCompileLevels @param reach [m] factor that turns slopes into lengths
  BundlePolynomials(std::span<const BundleRay> bundle, int level, double reach);

  std::size_t size() const { return size_; }
  /// The coordinate along which the bundle is widest, in standard deviations.
  double widest(const std::array<float, 4>& place) const {
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k)
      sum += rows_[0][k] * (static_cast<double>(place[k]) - mean_[k]);
    return sum;
  }
  /// @param values receives size() numbers; the first is 1
  void evaluate(const std::array<float, 4>& place, double* values) const;

 private:
  std::size_t rank_ = 0, squares_ = 0, size_ = 1;  ///< coordinates of degree 1 and 2
  std::array<double, 4> mean_{};
  std::array<std::array<double, 4>, 4> rows_{};  ///< one row per coordinate
};

/// Finds rules of few rays for bundles of many. In each cell of a bundle, a walk keeps the moments.
/// One reducer for each worker.
class BundleReducer {
 public:
  BundleReducer(int level, double reach, std::size_t walked_per_polynomial)
      : level_(level), reach_(reach), walked_per_polynomial_(walked_per_polynomial) {}

  /// @return rays of the bundle, with weights that keep the sums of the polynomials in each cell. A
  /// cell with hardly more rays than polynomials keeps all of its rays.
  std::vector<BundleRay> reduce(std::span<const BundleRay> bundle, std::uint64_t seed);

 private:
  void reduce_cell(std::span<BundleRay> cell, int halvings, WalkRandom& random,
                   std::vector<BundleRay>& rule);
  std::vector<BundleRay> reduce_whole(std::span<const BundleRay> bundle, WalkRandom& random);
  void order_along(const BundlePolynomials& polynomials, std::span<const BundleRay> bundle);
  void evaluate(const BundlePolynomials& polynomials, std::span<const BundleRay> bundle);
  void take_every(std::size_t step, WalkRandom& random);
  bool calibrate(const BundlePolynomials& polynomials, std::span<const BundleRay> bundle);

  int level_;
  double reach_;
  std::size_t walked_per_polynomial_;
  std::vector<std::uint32_t> bins_, order_;  ///< rays on which the walk runs
  std::vector<double> values_, weights_;     ///< values and weights of these rays
};

}  // namespace plenoflame
