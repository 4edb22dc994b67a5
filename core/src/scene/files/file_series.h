#pragma once
#include <string>
#include <vector>

namespace plenoflame {

/// Files with numbers in their names, "run_####.vdb": each # stands for a digit, and numbers with
/// fewer digits are padded with zeros. The folder is read once.
class FileSeries {
 public:
  /// @param pattern relative to `folder`, or absolute; with one run of # in the name of the file
  /// @param first number of the series' first file; -1: the lowest that there is
  /// @throws InputError for a pattern without # or with several runs of them, and when no file
  /// matches; FileError when the folder cannot be read
  FileSeries(std::string pattern, const std::string& folder, int first);

  const std::string& pattern() const { return pattern_; }
  int first() const { return first_; }  ///< number
  int last() const { return last_; }    ///< the highest number that there is
  int size() const { return last_ - first_ + 1; }
  /// Numbers from first() to last() of which there is no file, ascending.
  const std::vector<int>& missing() const { return missing_; }
  bool is_missing(int number) const;
  /// The file as the pattern names it: "run_0007.vdb".
  std::string name(int number) const;

  /// Tells whether a name has # in it, and how many in the longest run.
  static int digits_of(const std::string& pattern);

 private:
  std::string pattern_, before_, after_;
  std::size_t digits_ = 0;
  int first_ = 0, last_ = -1;
  std::vector<int> missing_;
};

}  // namespace plenoflame
