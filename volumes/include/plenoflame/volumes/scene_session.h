#pragma once
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "plenoflame/base/execution.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/volumes/flame_file.h"

namespace plenoflame {

/// A scene that is changed now and then, and compiled when it is needed: what scripts and pipelines
/// work on. Flames may be in memory. Compiled scenes are kept until something changes, one for each
/// camera. Several threads may compile at once; changes must not happen meanwhile.
class SceneSession {
 public:
  SceneSession() = default;
  /// A copy compiles anew.
  SceneSession(const SceneSession& other);
  SceneSession& operator=(const SceneSession& other);

  /// @throws InputError, FileError; the scene is unchanged then
  void read_file(const std::string& path);
  /// @param name stands for the file in messages and is where relative paths start
  void read_text(const std::string& text, const std::string& name);
  void set_document(SceneDocument document);

  const SceneDocument& document() const { return document_; }
  const Scene& scene() const { return document_.scene; }
  /// The scene to be changed in place.
  Scene& change();

  /// A flame in memory, which stands in for the file of this name. Flames of kind vdb alone have
  /// files.
  void set_flame(const std::string& name, FlameFields flame);

  /// Chooses the camera that the scene is about; empty: the only one. @throws InputError for a name
  /// that no camera has
  void set_camera(const std::string& name);
  const std::string& camera() const { return camera_; }
  /// The scene with the chosen camera alone. @throws InputError: several, and none is chosen
  Scene scene_of_camera() const;

  /// Numbers of the first and the last frame of flames that change with time. They are the frames
  /// of the chosen camera, or of the first one if none is chosen. Without such flames the last
  /// number is below the first. @throws as SceneTimeline
  std::pair<int, int> frames() const;
  /// Makes it the scene of one moment: at a time [s], or at the begin of a frame's exposure.
  /// @throws as SceneTimeline; the scene is unchanged then
  void move_to_time(double time);
  void move_to_frame(int frame);

  /// Forgets compiled scenes, for files that have changed.
  void forget();
  /// @param unsaid warnings that do not matter for what the caller does with the scene
  /// @throws as plenoflame::compile()
  std::shared_ptr<const CompiledScene> compile(const Execution& execution,
                                               const std::vector<IssueCode>& unsaid = {});

 private:
  SceneDocument document_;
  std::map<std::string, std::shared_ptr<const FlameFields>> flames_;
  std::string camera_;
  std::mutex compiling_;  ///< renderings of one scene on several threads compile it once
  /// By the camera; with another one much is the same.
  std::map<std::string, std::shared_ptr<const CompiledScene>> compiled_;
};

/// Grids that are in memory as a medium, placed as the scene's flame says. Its emission lines are
/// the grids named as the lines are.
/// @throws InputError: no such grid; a mapping or an albedo from a grid, which files alone have
std::unique_ptr<Medium> medium_in_memory(const FlameFields& grids, const FlameSpec& spec,
                                         const std::vector<SourceFunction>& channels);

}  // namespace plenoflame
