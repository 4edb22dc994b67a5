#include "lightfield/refocus_sums.h"

#include <algorithm>

namespace plenoflame {

RefocusBand::Row& RefocusBand::row_at(int row) {
  Row& found = rows_[static_cast<std::size_t>(row + 1)];
  if (found.cells.empty()) {
    found.cells.resize(static_cast<std::size_t>(width_) + 2);
    if (with_square_) found.square.resize(found.cells.size());
  }
  return found;
}

void RefocusBand::add(int column, int row, std::size_t count, const KernelSamples& samples) {
  int current = -2;  // row of the picture that `upper` is
  Row *upper = nullptr, *lower = nullptr;
  for (std::size_t k = 0; k < count; ++k) {
    const double w = static_cast<double>(samples.white[k]);
    const int i = column + samples.column[k], j = row + samples.row[k];
    if (!(w > 0) || i < -1 || j < -1 || i >= width_ || j >= height_) continue;
    if (j != current) {
      upper = &row_at(j);
      lower = &row_at(j + 1);
      current = j;
    }
    const double a = static_cast<double>(samples.right[k]),
                 b = static_cast<double>(samples.down[k]);
    const auto left = static_cast<std::size_t>(i + 1);
    const double l = static_cast<double>(samples.light[k]);
    const auto spread = [&](Row& to, double share) {
      Cell* cells = &to.cells[left];
      const double right = a * share, rest = share - right;
      cells[0].light += rest * l;
      cells[0].white += rest * w;
      cells[1].light += right * l;
      cells[1].white += right * w;
      if (with_square_) {
        to.square[left] += rest * l * l / w;
        to.square[left + 1] += right * l * l / w;
      }
    };
    spread(*upper, 1 - b);
    spread(*lower, b);
  }
}

void RefocusBand::add_to(RefocusSums& sums) const {
  for (int row = 0; row < height_; ++row) {
    const Row& from = rows_[static_cast<std::size_t>(row + 1)];
    if (from.cells.empty()) continue;
    for (int column = 0; column < width_; ++column) {
      const auto cell = static_cast<std::size_t>(column + 1);
      const std::size_t to = sums.index(column, row);
      sums.light[to] += from.cells[cell].light;
      sums.white[to] += from.cells[cell].white;
      if (with_square_) sums.square[to] += from.square[cell];
    }
  }
}

void fill_gaps(RefocusSums& sums) {
  if (sums.width < 2 || sums.height < 2) return;
  double largest = 0;
  for (const double w : sums.white) largest = std::max(largest, w);
  const double least = 1e-3 * largest;
  if (std::none_of(sums.white.begin(), sums.white.end(), [&](double w) { return w < least; }))
    return;
  RefocusSums coarse((sums.width + 1) / 2, (sums.height + 1) / 2);
  for (int row = 0; row < sums.height; ++row)
    for (int column = 0; column < sums.width; ++column) {
      const std::size_t from = sums.index(column, row), to = coarse.index(column / 2, row / 2);
      coarse.light[to] += sums.light[from];
      coarse.white[to] += sums.white[from];
    }
  fill_gaps(coarse);
  for (int row = 0; row < sums.height; ++row)
    for (int column = 0; column < sums.width; ++column) {
      const std::size_t to = sums.index(column, row), from = coarse.index(column / 2, row / 2);
      if (sums.white[to] >= least || coarse.white[from] <= 0) continue;
      const double missing = least - sums.white[to];
      sums.light[to] += missing * coarse.light[from] / coarse.white[from];
      sums.white[to] = least;
    }
}

}  // namespace plenoflame
