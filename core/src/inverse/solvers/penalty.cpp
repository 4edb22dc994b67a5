#include "plenoflame/inverse/penalty.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr std::size_t kMostTerms = 4;

/// Rows of at most four entries.
class DifferenceOperator final : public LinearOperator {
 public:
  explicit DifferenceOperator(std::size_t columns) : columns_(columns) {}

  struct Term {
    std::size_t column;
    double value;
  };
  /// @param terms at most kMostTerms
  void add_row(std::span<const Term> terms) {
    for (std::size_t k = 0; k < kMostTerms; ++k) {
      const Term term = k < terms.size() ? terms[k] : Term{terms[0].column, 0};
      column_.push_back(static_cast<std::uint32_t>(term.column));
      value_.push_back(term.value);
    }
  }

  std::size_t rows() const override { return value_.size() / kMostTerms; }
  std::size_t columns() const override { return columns_; }
  void apply(std::span<const double> x, std::span<double> y) const override {
    for (std::size_t row = 0, k = 0; row < y.size(); ++row, k += kMostTerms)
      y[row] = value_[k] * x[column_[k]] + value_[k + 1] * x[column_[k + 1]] +
               value_[k + 2] * x[column_[k + 2]] + value_[k + 3] * x[column_[k + 3]];
  }
  void apply_transpose(std::span<const double> y, std::span<double> x) const override {
    std::fill(x.begin(), x.end(), 0.0);
    for (std::size_t k = 0; k < value_.size(); ++k) x[column_[k]] += value_[k] * y[k / kMostTerms];
  }
  double squared_norm(std::span<const double> weights) const override {
    double sum = 0;
    for (std::size_t k = 0; k < value_.size(); ++k) {
      const double w = weights.empty() ? 1 : weights[k / kMostTerms];
      sum += w * w * value_[k] * value_[k];
    }
    return sum;
  }

 private:
  std::size_t columns_;
  std::vector<std::uint32_t> column_;
  std::vector<double> value_;
};

std::size_t size_of(const PenaltyGrid& grid) {
  std::size_t size = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (grid.shape[a] < 1) throw InputError("a penalty needs at least one sample along each axis");
    if (!(grid.spacing[a] > 0) || !(grid.strength[a] >= 0))
      throw InputError("a penalty needs spacings above 0 and strengths of at least 0");
    size *= static_cast<std::size_t>(grid.shape[a]);
  }
  if (!grid.mask.empty() && grid.mask.size() != size)
    throw InputError("the penalty's mask has " + std::to_string(grid.mask.size()) +
                     " entries for " + std::to_string(size) + " unknowns");
  return size;
}

/// Steps along the axes from one sample to the next, in numbers of unknowns.
std::array<std::size_t, 3> strides(const PenaltyGrid& grid) {
  const auto n1 = static_cast<std::size_t>(grid.shape[1]),
             n2 = static_cast<std::size_t>(grid.shape[2]);
  return {n1 * n2, n2, 1};
}

/// The smallest spacing of the axes that have one.
double least_spacing(const PenaltyGrid& grid) {
  double least = 0;
  for (std::size_t a = 0; a < 3; ++a)
    if (grid.shape[a] > 1 && (least == 0 || grid.spacing[a] < least)) least = grid.spacing[a];
  return least;
}

/// The factor of a second difference along an axis.
double axis_scale(const PenaltyGrid& grid, std::size_t axis) {
  return grid.strength[axis] * std::pow(least_spacing(grid) / grid.spacing[axis], 2);
}

/// Calls use(unknown, index along the axes) for every unknown.
template <class Use>
void for_each(const PenaltyGrid& grid, const Use& use) {
  std::size_t unknown = 0;
  for (int i = 0; i < grid.shape[0]; ++i)
    for (int j = 0; j < grid.shape[1]; ++j)
      for (int k = 0; k < grid.shape[2]; ++k) use(unknown++, std::array<int, 3>{i, j, k});
}

/// Rows of second differences. A place that no unknown has, or whose unknown takes no part, is
/// empty or ends the differences.
class SecondDifferences {
 public:
  explicit SecondDifferences(const PenaltyGrid& grid) : grid_(grid), stride_(strides(grid)) {}

  /// The difference of an unknown and its neighbours along an axis.
  void add_along(const std::array<int, 3>& at, std::size_t axis, DifferenceOperator& to) const {
    const double scale = axis_scale(grid_, axis);
    std::vector<DifferenceOperator::Term> row{{number(at), -2 * scale}};
    for (const int side : {-1, 1}) {
      std::array<int, 3> neighbour = at;
      neighbour[axis] += side;
      if (axis == 0 && grid_.begins_at_centre) neighbour[0] = std::abs(neighbour[0]);
      if (takes_part(neighbour))
        row.push_back({number(neighbour), scale});
      else if (!grid_.empty_outside)
        return;
    }
    to.add_row(row);
  }

  /// Across two axes: of each square of four places of which this is the first to take part. The
  /// curvature of a field holds it twice.
  void add_across(const std::array<int, 3>& at, const std::array<std::size_t, 2>& axes,
                  DifferenceOperator& to) const {
    const auto [a, b] = axes;
    if (grid_.shape[b] < 2 || grid_.strength[b] == 0) return;
    const double scale = std::sqrt(2 * axis_scale(grid_, a) * axis_scale(grid_, b));
    for (const int back_a : {0, 1})
      for (const int back_b : {0, 1}) {
        std::array<int, 3> first = at;
        first[a] -= back_a;
        first[b] -= back_b;
        // On the other side of the centre is the same square again.
        if (a == 0 && grid_.begins_at_centre && first[0] < 0) continue;
        std::vector<DifferenceOperator::Term> row;
        bool whole = true;
        for (const int step_a : {0, 1})
          for (const int step_b : {0, 1}) {
            std::array<int, 3> corner = first;
            corner[a] += step_a;
            corner[b] += step_b;
            if (takes_part(corner))
              row.push_back({number(corner), step_a == step_b ? scale : -scale});
            else
              whole = false;
          }
        if (row.front().column == number(at) && (whole || grid_.empty_outside)) to.add_row(row);
      }
  }

 private:
  std::size_t number(const std::array<int, 3>& at) const {
    std::size_t unknown = 0;
    for (std::size_t a = 0; a < 3; ++a) unknown += static_cast<std::size_t>(at[a]) * stride_[a];
    return unknown;
  }
  bool takes_part(const std::array<int, 3>& at) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (at[a] < 0 || at[a] >= grid_.shape[a]) return false;
    return grid_.mask.empty() || grid_.mask[number(at)] != 0;
  }

  const PenaltyGrid& grid_;
  std::array<std::size_t, 3> stride_;
};

}  // namespace

std::unique_ptr<LinearOperator> make_penalty(const PenaltyGrid& grid) {
  auto result = std::make_unique<DifferenceOperator>(size_of(grid));
  const SecondDifferences second(grid);
  for_each(grid, [&](std::size_t unknown, const std::array<int, 3>& at) {
    if (!grid.mask.empty() && grid.mask[unknown] == 0) return;
    for (std::size_t a = 0; a < 3; ++a) {
      if (grid.shape[a] < 2 || grid.strength[a] == 0) continue;
      second.add_along(at, a, *result);
      for (std::size_t other = a + 1; other < 3; ++other)
        second.add_across(at, {a, other}, *result);
    }
  });
  return result;
}

double reference_penalty(const PenaltyGrid& grid) {
  constexpr double kPart = 0.1;  // of the longest side, over which a slope changes by 1
  const std::size_t size = size_of(grid);
  double longest = 0;
  for (std::size_t a = 0; a < 3; ++a)
    if (grid.shape[a] > 1) longest = std::max(longest, grid.shape[a] * grid.spacing[a]);
  if (!(longest > 0)) throw InputError("the penalty has no rows: the grid has one sample only");
  const auto taking_part =
      grid.mask.empty()
          ? static_cast<double>(size)
          : static_cast<double>(size) - static_cast<double>(std::ranges::count(grid.mask, char{0}));
  if (!(taking_part > 0)) throw InputError("the penalty has no rows: no unknown takes part");
  return taking_part * std::pow(least_spacing(grid) / (kPart * longest), 4);
}

double penalty_unit(const LinearOperator& a, std::span<const double> weights,
                    std::span<const double> uniform, double reference) {
  const std::vector<double> image = a * uniform;
  double sum = 0;
  for (std::size_t i = 0; i < image.size(); ++i)
    sum += std::pow(weights.empty() ? image[i] : weights[i] * image[i], 2);
  return sum / reference;
}

}  // namespace plenoflame
