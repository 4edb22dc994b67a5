#pragma once
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands/render/render_options.h"
#include "plenoflame/film/film.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/render/exposure.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/input_files.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/timeline.h"

namespace plenoflame::cli {

/// The record that is kept with the state of a run: all that its continuation needs.
struct RunRecord {
  std::string version;
  std::string scene_text;        ///< TOML, complete; of several moments with what changes
  std::string scene_file;        ///< path, absolute: relative names in the scene start there
  std::vector<InputFile> files;  ///< that the scene names, as they were
  RenderSettings settings;       ///< without what is no setting: film and functions
  bool white = false;
  bool truth = false;         ///< layers of ground truth are requested
  std::string stats;          ///< file for the figures; empty: none
  std::string compression;    ///< as on the command line; empty: as it is without
  double seconds = 0;         ///< of rendering, so far
  std::size_t moments = 1;    ///< of the exposure
  ExposureProgress exposure;  ///< of several
  /// Attributes of the light field that describe the exposure (render_pictures.h).
  std::map<std::string, double> numbers;
  std::map<std::string, std::string> texts;
};

/// Files that a picture is made of: those of all moments, each once.
std::vector<InputFile> files_of(const std::vector<SceneMoment>& moments);

std::string to_text(const RunRecord& record);
/// @throws FileError when it is not what to_text() gave. @param path for messages
RunRecord record_from(const std::string& text, const std::string& path);

/// A scene that may change with time, and when a picture of it is taken.
struct SceneInTime {
  SceneDocument document;                              ///< of one camera
  std::shared_ptr<const SceneTimeline> timeline = {};  ///< nullptr: it does not change
  double begin = 0;                                    ///< [s] of the exposure

  std::vector<SceneMoment> moments() const;
};

/// [s] The begin of the requested exposure; without a time, of the first frame's.
double begin_of(const SceneTimeline& timeline, std::optional<double> time);

/// A run that can be continued.
struct Continuation {
  RunRecord record;
  Film film;                                   ///< of a single moment
  std::optional<ExposureState> exposure = {};  ///< of several
  SceneInTime scene;                           ///< of a single moment without what changes
  /// The picture, when that is complete and gets more: its layers stay true.
  std::optional<LightField> picture;
};

/// The run that should have written options.resume. It is read from its state or, when the picture
/// is complete, from the picture. Options that differ from the run are rejected, by name and with
/// both values. Only samples (more of them), target error, time limit, layers, files and threads
/// may change.
/// @param now the requested scene; nullptr: that of the options, if any
/// @throws UsageError, InputError, FileError
Continuation read_continuation(const RenderOptions& options, const SceneInTime* now = nullptr);

/// Settings of the rest of the run: those of the record, with the changes of the options.
/// @throws UsageError for fewer samples, and without any change
RenderSettings continued_settings(const RenderOptions& options, const Continuation& run);

}  // namespace plenoflame::cli
