#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands/render_options.h"
#include "commands/run_record.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/timeline.h"

namespace plenoflame::cli {

/// When a picture of flames that change with time is taken.
struct PictureTime {
  std::shared_ptr<const SceneTimeline> timeline;
  std::optional<int> frame;  ///< nothing: of --time
  double begin = 0;          ///< [s] of the exposure
};

/// A picture to be made: the options with its own names of files, and the scene of its camera.
struct Picture {
  RenderOptions options;
  SceneDocument document;
  std::optional<PictureTime> time = {};  ///< nothing: the scene does not change
  /// Number of the camera (with its f-number) whose frames follow each other in time.
  std::size_t view = 0;
  /// The moments of which the picture is the mean.
  std::vector<SceneMoment> moments() const;
};

/// All pictures of a run: of each frame, each camera, each f-number, so that what burns in a frame
/// is read once for all cameras. Each of several cameras has a file with its name, and one that was
/// chosen alone has it, too, unless a name was given.
/// @throws UsageError, InputError
std::vector<Picture> pictures_of(const RenderOptions& options);

/// Keeps with the state of a run what its picture's light field is to say of the exposure: which
/// frame, when, how long, and what frame_is_done() compares.
void add_exposure(const Picture& picture, const RenderSettings& settings, RunRecord& record);
/// Puts that into the light field, with the energy in J. @param flux [W]
void put_exposure(const RunRecord& record, double flux, LightField& field);

/// True if the file of a frame holds it already, complete and newer than the files of its flames.
/// @throws InputError when it is a picture of another scene or other settings, naming what differs
bool frame_is_done(const Picture& picture, const RenderSettings& settings);

}  // namespace plenoflame::cli
