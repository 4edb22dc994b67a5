#pragma once
#include <cstddef>
#include <vector>

#include "plenoflame/lightfield/views.h"

namespace plenoflame {

/// One sample per microlens, by lens index; NaN: unknown.
class LensSamples {
 public:
  LensSamples(const ArraySpec& array, const std::vector<LensIndex>& lenses);
  float& at(LensIndex lens) { return values_[index(lens)]; }
  /// The picture at a point of the array's plane, camera x, y [m]; NaN: unknown.
  double value(Vec2 point, ViewResampling resampling) const;

 private:
  std::size_t index(LensIndex lens) const {
    return static_cast<std::size_t>(lens.r - r0_) * static_cast<std::size_t>(q_count_) +
           static_cast<std::size_t>(lens.q - q0_);
  }
  double get(int q, int r) const;
  double barycentric(double q, double r) const;
  double along_row(int r, double x) const;
  double paper_kernel(int r, double x, bool tenth) const;

  ArraySpec array_;
  MicrolensLattice lattice_;
  int q0_ = 0, r0_ = 0, q_count_ = 0, r_count_ = 0;
  std::vector<float> values_;
};

}  // namespace plenoflame
