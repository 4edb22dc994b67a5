#pragma once
#include <optional>
#include <string>
#include <vector>
#include "plenoflame/scene/flame_spec.h"

namespace plenoflame {

/// The course of a flame over time: a CSV file of times and any of its position's components, its
/// scale and its brightness, which vary along straight lines between rows.
///
///     time [ms], x [mm], z [mm], brightness
///     0,         0,      -29,    1
///     10,        2.5,    -29,    0.8
///
/// The first line names the columns, with the units of times and lengths in brackets, parentheses
/// or behind an underscore (time_ms). Columns are separated by commas, semicolons or tabs; what
/// follows a #, and lines with nothing else, are left out.
class TimeTable {
 public:
  /// @throws FileError when it cannot be read; InputError "file:line:column: ..." for a header that
  /// is missing or has unknown, repeated or too few columns or no unit, a row with another number
  /// of cells, a cell that is no finite number, times that do not ascend, scales that are not
  /// positive, negative brightness
  explicit TimeTable(const std::string& path);

  double first_time() const { return times_.front(); }                  ///< [s]
  double last_time() const { return times_.back(); }                    ///< [s]
  const std::vector<std::string>& columns() const { return columns_; }  ///< without the time
  std::size_t rows() const { return times_.size(); }

  /// The flame at a time, which is kept within first_time() to last_time() [s].
  FlameSpec at(double time, FlameSpec flame) const;

 private:
  std::vector<std::string> columns_;
  std::vector<double> times_;                ///< [s] ascending
  std::vector<std::vector<double>> values_;  ///< of each row, of each column, SI
};

}  // namespace plenoflame
