#include "lightfield/view_resampling.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

namespace plenoflame {
namespace {

const double kCos30 = std::sqrt(0.75);

/// Mean of the known values with these weights; NaN when they have not half of the weight.
class KnownMean {
 public:
  void add(double weight, double value) {
    if (weight == 0 || std::isnan(value)) return;
    total_ += weight * value;
    weight_ += weight;
  }
  double result() const {
    return weight_ >= 0.5 ? total_ / weight_ : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  double total_ = 0, weight_ = 0;
};

}  // namespace

LensSamples::LensSamples(const ArraySpec& array, const std::vector<LensIndex>& lenses)
    : array_(array), lattice_(array) {
  if (lenses.empty()) return;
  int q1 = lenses.front().q, r1 = lenses.front().r;
  q0_ = q1;
  r0_ = r1;
  for (const LensIndex lens : lenses) {
    q0_ = std::min(q0_, lens.q);
    q1 = std::max(q1, lens.q);
    r0_ = std::min(r0_, lens.r);
    r1 = std::max(r1, lens.r);
  }
  q_count_ = q1 - q0_ + 1;
  r_count_ = r1 - r0_ + 1;
  values_.assign(static_cast<std::size_t>(q_count_) * static_cast<std::size_t>(r_count_),
                 std::numeric_limits<float>::quiet_NaN());
}

double LensSamples::get(int q, int r) const {
  if (q < q0_ || r < r0_ || q >= q0_ + q_count_ || r >= r0_ + r_count_)
    return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(values_[index({q, r})]);
}

double LensSamples::barycentric(double q, double r) const {
  const double q_floor = std::floor(q), r_floor = std::floor(r);
  const int i = static_cast<int>(q_floor), j = static_cast<int>(r_floor);
  const double s = q - q_floor, t = r - r_floor;
  KnownMean mean;
  if (array_.lattice == Lattice::square) {
    mean.add((1 - s) * (1 - t), get(i, j));
    mean.add(s * (1 - t), get(i + 1, j));
    mean.add((1 - s) * t, get(i, j + 1));
    mean.add(s * t, get(i + 1, j + 1));
  } else if (s + t <= 1) {  // the short diagonal cuts a cell into two equilateral triangles
    mean.add(1 - s - t, get(i, j));
    mean.add(s, get(i + 1, j));
    mean.add(t, get(i, j + 1));
  } else {
    mean.add(s + t - 1, get(i + 1, j + 1));
    mean.add(1 - t, get(i + 1, j));
    mean.add(1 - s, get(i, j + 1));
  }
  return mean.result();
}

double LensSamples::along_row(int r, double x) const {
  const double q = x - 0.5 * r, q_floor = std::floor(q);
  const int i = static_cast<int>(q_floor);
  KnownMean mean;
  mean.add(1 - (q - q_floor), get(i, r));
  mean.add(q - q_floor, get(i + 1, r));
  return mean.result();
}

double LensSamples::paper_kernel(int r, double x, bool tenth) const {
  // Row i - 1 of the picture, the one above, is row r + 1 of the array. Camera y points down, but
  // the image on the sensor is upside down.
  KnownMean mean;
  const double shift = tenth ? 0.5 : kCos30;
  const double side = tenth ? 0.25 : 0.5 * (1 - kCos30);
  if (!tenth) mean.add(2 * kCos30 - 1, along_row(r, x));
  for (const int row : {r, r + 1})
    for (const double sign : {-1.0, 1.0}) mean.add(side, along_row(row, x + sign * shift));
  return mean.result();
}

double LensSamples::value(Vec2 point, ViewResampling resampling) const {
  if (resampling == ViewResampling::nearest) {
    const LensIndex lens = lattice_.nearest(point);
    return get(lens.q, lens.r);
  }
  const Vec2 p = point - array_.offset;
  const double c = std::cos(array_.rotation), s = std::sin(array_.rotation);
  const double pitch_y = is_regular(array_) ? array_.pitch : array_.pitch_y;
  const double x = (c * p.x + s * p.y) / array_.pitch, y = (c * p.y - s * p.x) / pitch_y;
  const bool hexagonal = array_.lattice == Lattice::hexagonal;
  const double r = hexagonal ? y / kCos30 : y;
  if (resampling == ViewResampling::barycentric) return barycentric(hexagonal ? x - 0.5 * r : x, r);
  const double r_floor = std::floor(r);
  const int row = static_cast<int>(r_floor);
  const bool tenth = resampling == ViewResampling::paper10;
  KnownMean mean;
  mean.add(1 - (r - r_floor), paper_kernel(row, x, tenth));
  mean.add(r - r_floor, paper_kernel(row + 1, x, tenth));
  return mean.result();
}

}  // namespace plenoflame
