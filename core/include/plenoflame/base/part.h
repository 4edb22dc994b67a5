#pragma once
#include <string>

namespace plenoflame {

/// One of several parts of a piece of work, such as the tasks of a job array. A fixed rule tells
/// which items belong to a part, so all parts together make the whole on any machines.
struct Part {
  int number = 1;  ///< 1 to count
  int count = 1;

  bool is_whole() const { return count == 1; }
  friend bool operator==(const Part&, const Part&) = default;
};

inline constexpr int kMostParts = 1000000;

/// "2/4".
std::string to_string(const Part& part);

/// @throws UsageError for what is not of the form K/N with 1 <= K <= N <= kMostParts
Part part_from(const std::string& text);

/// The part that a tile belongs to, 0 based. Neighbours, which cost about the same, go to different
/// parts; no part has over one tile more than another.
/// @param across tiles side by side
int part_of_tile(int tile, int across, int parts);

}  // namespace plenoflame
