#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "plenoflame/render/compiled_camera.h"
#include "render/compiled/moment_walk.h"

namespace plenoflame {

/// A ray of a bundle: place at the middle of the region and slope, in the camera's axes.
struct BundleRay {
  std::array<float, 4> place{};  ///< u, v [m], slopes
  float weight = 0;              ///< [m^2 sr]
};

/// Polynomials in a bundle's own coordinates: place and slope, turned and scaled so that the
/// bundle's spread is 1 along each of them, the widest first. All of degree 1, products of degree 2
/// of the widest coordinates only.
class BundlePolynomials {
 public:
  /// @param level 1 to kCompileLevels   @param reach [m] by which slopes become lengths
  BundlePolynomials(std::span<const BundleRay> bundle, int level, double reach);

  std::size_t size() const { return size_; }
  /// The coordinate along which the bundle is widest, in standard deviations.
  double widest(const std::array<float, 4>& place) const {
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k)
      sum += rows_[0][k] * (static_cast<double>(place[k]) - mean_[k]);
    return sum;
  }
  /// @param values receives size() numbers, the first is 1
  void evaluate(const std::array<float, 4>& place, double* values) const;

 private:
  std::size_t rank_ = 0, squares_ = 0, size_ = 1;  ///< coordinates of degree 1 and 2
  std::array<double, 4> mean_{};
  std::array<std::array<double, 4>, 4> rows_{};  ///< one a coordinate
};

/// Finds rules of few rays for bundles of many: cells of a bundle, each by a walk that keeps its
/// moments. One for each worker.
class BundleReducer {
 public:
  BundleReducer(int level, double reach, std::size_t walked_per_polynomial)
      : level_(level), reach_(reach), walked_per_polynomial_(walked_per_polynomial) {}

  /// @return rays of the bundle with weights such that the sums of the polynomials are, in
  /// each of its cells, the cell's; all of one that has hardly more rays than polynomials
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
  std::vector<std::uint32_t> bins_, order_;  ///< rays that the walk is made on
  std::vector<double> values_, weights_;     ///< of them
};

}  // namespace plenoflame
