#pragma once
#include <string>
#include <vector>

#include "plenoflame/scene/scene_file.h"

namespace CLI {
class App;
}
namespace plenoflame {
struct LightField;
}

namespace plenoflame::cli {

/// --set of every command that reads a scene. @param values receives "KEY=VALUE", in order
void add_set_option(CLI::App& command, std::vector<std::string>& values);

/// Reads and validates a scene file.
/// @param settings of --set
/// @param warnings if given, gets probable mistakes, one line each, with file, line and column. A
///        missing flame is none. compile() sends the same to its execution, and the missing flame
/// @throws FileError, InputError with at least the file in front; UsageError about a setting
SceneDocument read_valid_scene(const std::string& path,
                               const std::vector<std::string>& settings = {},
                               std::vector<std::string>* warnings = nullptr);

/// The same without looking at whether its values go together.
SceneDocument read_scene(const std::string& path, const std::vector<std::string>& settings = {});

/// The scene that a light field holds, with a camera that is sound; it opens no other file.
/// @param path of the light field, for messages
/// @throws InputError; UsageError about a setting
SceneDocument read_scene_of(const LightField& light_field, const std::string& path,
                            const std::vector<std::string>& settings = {});

/// The same, whatever its camera is: for what has nothing to do with it.
SceneDocument parse_scene_of(const LightField& light_field, const std::string& path,
                             const std::vector<std::string>& settings = {});

/// The scene of one camera of a file, of several that of --camera; nothing but the camera is looked
/// at. @throws as read_valid_scene
SceneDocument read_scene_of_camera(const std::string& path,
                                   const std::vector<std::string>& settings,
                                   const std::string& camera);

/// Says of a file that is no scene but something else that Plenoflame writes what to do with it.
/// Files that cannot be read pass: the reader of the scene reports them. @throws InputError
void check_is_scene(const std::string& path);

/// Adds --camera to a command that is about one of a scene's cameras.
void add_camera_option(CLI::App& command, std::string& camera);

/// The scene of one camera of a file. @param camera of --camera; may be empty where there is one
/// @throws UsageError naming the cameras, or the nearest
SceneDocument choose_camera(const SceneDocument& document, const std::string& camera);

/// The scene of each of some cameras.
struct CameraScene {
  std::string file;
  SceneDocument document;  ///< with that camera alone
  /// The name of the scene, and of its camera where that has one, for messages.
  std::string what() const;
};

/// --camera for a command that takes several. May be repeated.
void add_cameras_option(CLI::App& command, std::vector<std::string>& cameras);

/// The cameras of a scene, each with its scene: all of them, or those of --camera in their order.
/// @throws UsageError for a name that is unknown or given twice
std::vector<CameraScene> choose_cameras(const SceneDocument& document, const std::string& file,
                                        const std::vector<std::string>& cameras);

/// The same of several files, one after the other; --camera is about a single one.
std::vector<CameraScene> read_camera_scenes(const std::vector<std::string>& files,
                                            const std::vector<std::string>& settings,
                                            const std::vector<std::string>& cameras);

/// Reads, validates, chooses. @throws as they do
SceneDocument read_camera_scene(const std::string& path, const std::vector<std::string>& settings,
                                const std::string& camera,
                                std::vector<std::string>* warnings = nullptr);

}  // namespace plenoflame::cli
