#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "commands/render/render_options.h"
#include "commands/render/run_record.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/render/render.h"

namespace plenoflame::cli {

/// A picture to be made: the scene of its camera, and the options with its own names of files.
struct Picture : SceneInTime {
  RenderOptions options;
  std::optional<int> frame = {};  ///< of a scene that changes; nothing: of --time
  /// Number of the camera (with its f-number) whose frames follow each other in time.
  std::size_t view = 0;
};

/// All pictures of a run: of each frame, each camera, each f-number, so that what burns in a frame
/// is read once for all cameras. Each of several cameras has a file with its name, and one that was
/// chosen alone has it, too, unless a name was given.
/// @throws UsageError, InputError
std::vector<Picture> pictures_of(const RenderOptions& options);

/// Adds the exposure to the state of a run, for its picture's light field. It consists of the
/// frame, its begin, its length, and the values that frame_is_done() compares.
void add_exposure(const Picture& picture, const RenderSettings& settings, RunRecord& record);
/// Puts that into the light field, with the energy in J. @param flux [W]
void put_exposure(const RunRecord& record, double flux, LightField& field);

/// True if the file of a frame holds it already, complete and newer than the files of its flames.
/// @throws InputError when it is a picture of another scene or other settings, naming what differs
bool frame_is_done(const Picture& picture, const RenderSettings& settings);

}  // namespace plenoflame::cli
