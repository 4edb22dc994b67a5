#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "plenoflame/scene/scene_file.h"

/// Scenes whose flames change with time. Functions that use a scene treat one moment; those here
/// give the scene of a moment.
namespace plenoflame {

/// Tells whether a flame of the scene is a series of files, or changes by a table.
bool changes_with_time(const Scene& scene);

/// A scene in which nothing changes any more, and its share of an exposure.
struct SceneMoment {
  Scene scene;
  double share = 1;
};

/// The flames of a scene over the time [s]; time 0 is the begin of each series' first file.
/// Folders and tables are read once. Immutable.
///
/// Pictures are numbered in the order of frame_rate(). The first one has the number of the first
/// file of the first flame that is a series (0 without series).
class SceneTimeline {
 public:
  /// @param scene its files lie relative to Scene::file; of several cameras the first says when
  /// pictures are taken (for_camera() in cameras.h chooses)
  /// @throws InputError for a scene that does not change; InputError, FileError with the place in
  /// the scene or the table that is wrong
  explicit SceneTimeline(const Scene& scene, const PositionMap& positions = {});
  explicit SceneTimeline(const SceneDocument& document)
      : SceneTimeline(document.scene, document.positions) {}
  ~SceneTimeline();
  SceneTimeline(SceneTimeline&&) noexcept;

  /// [1/s] of pictures; 0: unknown, and the timeline knows times only.
  double frame_rate() const;
  int first_frame() const;
  int last_frame() const;  ///< last one whose exposure ends while all flames are known
  /// Time at which the exposure of a frame begins [s].
  /// @throws InputError when it is not among first_frame() to last_frame(), saying what ends, or
  ///         when there is no frame_rate()
  double begin_of(int frame) const;
  /// Number of the frame whose time is the last one before a time; first_frame() before the first.
  int frame_at(double time) const;
  double first_time() const;  ///< [s] from which all flames are known
  double end_time() const;    ///< [s] until which

  /// The scene at a time [s].
  /// @throws InputError before the begin, beyond the end or for a missing file of a series, with
  ///         its name
  Scene at_time(double time) const;
  /// The scene at the time at which a frame's exposure begins.
  Scene at_frame(int frame) const { return at_time(begin_of(frame)); }

  /// All moments of an exposure that begins at a time and takes the sensor's exposure_time. A
  /// series contributes each file for its duration, a table exposure_steps steps. Shares sum to 1.
  /// An exposure of 0 s is one moment. @throws as at_time
  std::vector<SceneMoment> exposure(double begin) const;
  std::vector<SceneMoment> exposure_of_frame(int frame) const { return exposure(begin_of(frame)); }

  /// The times of one flame, for reports.
  struct FlameTime {
    std::size_t flame = 0;  ///< which of the scene's
    std::string files;      ///< pattern of a series; empty: none
    double frame_rate = 0;
    int first = 0, last = -1;   ///< numbers of files
    std::string first_file;     ///< the first of them that is there
    std::vector<int> missing;   ///< of these
    std::string table;          ///< file; empty: none
    std::string table_columns;  ///< "x, brightness"
    double table_first = 0, table_last = 0;
  };
  std::vector<FlameTime> flames() const;
  /// Files of a series that frames from `first` to `last`, each `step`-th, want and that are not
  /// there.
  std::vector<std::string> missing_files(int first, int last, int step) const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

/// The scene as it is where nobody asks for another time: at its first frame. A scene that does not
/// change stays as it is.
Scene first_moment(const Scene& scene, const PositionMap& positions = {});

}  // namespace plenoflame
