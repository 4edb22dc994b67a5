#pragma once
#include <string>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame {

/// The subject of an issue, for callers that treat some of them otherwise than others.
enum class IssueCode {
  other,
  no_flame,        ///< nothing emits light
  straight_light,  ///< windows do not refract light on its way to what sends it on
};

/// Something about a scene that is impossible (error) or probably not meant (warning).
struct SceneIssue {
  bool is_error = false;
  std::string key;          ///< path of the value it is about, "" for the scene as a whole
  SourcePosition position;  ///< of that key, unknown when the scene does not come from a file
  std::string message;      ///< one line that says what to do
  IssueCode code = IssueCode::other;
};

/// "file:line:column: message".
std::string to_string(const SceneIssue& issue);

/// All errors and warnings of a scene, in a fixed order: values out of range, overlapping surfaces,
/// a missing stop, a flame inside the camera, ... The function opens no files.
std::vector<SceneIssue> check_scene(const Scene& scene, const PositionMap& positions = {});

/// The warnings of check_scene. @throws InputError with the first error, at its place in the file
std::vector<SceneIssue> validate(const Scene& scene, const PositionMap& positions = {});
inline std::vector<SceneIssue> validate(const SceneDocument& document) {
  return validate(document.scene, document.positions);
}

/// Checks a flame whose extent is known only after its file has been read: the position of its
/// world box relative to the camera. An error if the box reaches behind the front of the main lens.
/// A warning if it reaches inside the front focal point (its image is virtual). The camera must
/// have passed validate().
/// @param key path of the flame, for the issues, e.g. "flames[0].position"
std::vector<SceneIssue> check_flame_box(const CameraSpec& camera, const std::string& flame_name,
                                        const Box& world, const std::string& key,
                                        const PositionMap& positions = {});

}  // namespace plenoflame
