#pragma once
#include <optional>
#include <string>
#include <vector>
#include "plenoflame/scene/flame_spec.h"

namespace plenoflame {

/// The course of a flame over time. A CSV file holds times and any of its position's components,
/// its scale and its brightness, which are linear between rows.
///
///     time [ms], x [mm], z [mm], brightness
///     0,         0,      -29,    1
///     10,        2.5,    -29,    0.8
///
/// The first line names the columns. It has the units of times and lengths in brackets, parentheses
/// or behind an underscore (time_ms). Columns are separated by commas, semicolons or tabs; # begins
/// a comment, and empty lines are skipped.
class TimeTable {
 public:
  /// @throws FileError when it cannot be read; InputError "file:line:column: ..." for wrong
  ///         contents
  ///
  /// A header is wrong if it is missing, has unknown, repeated or too few columns, or no unit. A
  /// row is wrong with another number of cells or a cell that is no finite number. Times must
  /// ascend, scales must be positive, and brightness must not be negative.
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
