#pragma once
#include <string>
#include <vector>

#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/timeline.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

/// The moment that a command is about, of a scene that changes with time.
struct MomentChoice {
  std::string frame, time;  ///< as on the command line; empty: not given
  bool given() const { return !frame.empty() || !time.empty(); }
};

/// Adds --frame and --time to a command that is about one moment.
void add_moment_options(CLI::App& command, MomentChoice& choice);

/// The scene at the moment that was chosen; without a choice at its first frame, which is said.
/// @throws UsageError for a choice in a scene that does not change; as SceneTimeline
SceneDocument at_moment(const SceneDocument& document, const MomentChoice& choice);

/// --frames A:B:STEP, every number from 0.
struct FrameRange {
  int first = 0, last = 0, step = 1;
};

/// "5", "5:20", "5:20:3". @throws UsageError
FrameRange frame_range_option(const std::string& name, const std::string& text);

/// "flame.exr", 7 -> "flame.0007.exr".
std::string with_frame(const std::string& path, int frame);

/// A time with its unit, before 0 too. @throws UsageError
double time_option(const std::string& name, const std::string& text);

/// Refuses frames that want files which are not there, naming some.
/// @throws InputError
void check_frames(const SceneTimeline& timeline, const FrameRange& frames,
                  const SceneDocument& document);

}  // namespace plenoflame::cli
