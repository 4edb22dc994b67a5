#pragma once
#include <string>

namespace plenoflame {

/// The change of a flame with time. Times count from the begin of the first frame. SceneTimeline in
/// timeline.h turns a scene and a time into a constant scene.
struct FlameTimeSpec {
  /// [1/s] vdb: FlameSpec::file is the name of a series of files, with # for the digits of their
  /// numbers. Each file holds from its own time until that of the next. 0: a single file.
  double frame_rate = 0;
  int first_frame = -1;    ///< number of the file at time 0; -1: the lowest that there is
  std::string table = {};  ///< CSV file, relative to the scene file; empty: none (time_table.h)
  bool is_series() const { return frame_rate > 0; }
  bool present() const { return is_series() || !table.empty(); }
  friend bool operator==(const FlameTimeSpec&, const FlameTimeSpec&) = default;
};

}  // namespace plenoflame
