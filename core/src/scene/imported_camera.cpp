#include "plenoflame/scene/imported_camera.h"

#include <cmath>
#include <cstdlib>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/camera/camera_import.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/validate.h"

namespace plenoflame {
namespace {

/// A scene with 0 where a setting may give a value of a camera that is still to be found.
constexpr const char* kNothingYet = R"(
[camera.lens]
model = "ideal"
[camera.array]
model = "ideal"
[[camera.array.types]]
[[camera.array.types]]
[[camera.array.types]]
)";

/// camera.lens.f_number=N is the diameter once the focal length is known.
double take_f_number(std::vector<std::string>& values, const std::string& option) {
  constexpr std::string_view kKey = "camera.lens.f_number=";
  double f_number = 0;
  std::erase_if(values, [&](const std::string& value) {
    if (!value.starts_with(kKey)) return false;
    const std::string text = value.substr(kKey.size());
    char* end = nullptr;
    f_number = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || *end != '\0' || !(f_number > 0) || !std::isfinite(f_number))
      throw UsageError(option + " camera.lens.f_number: a number above 0");
    return true;
  });
  return f_number;
}

SceneDocument parse_with(const std::string& text, const std::string& name,
                         const SceneSettings& settings) {
  try {
    return parse_scene(text, name, settings);
  } catch (const InputError& error) {
    if (error.position().file.starts_with(settings.option)) throw UsageError(error.what());
    throw;
  }
}

/// The scene of one camera that a file holds beside pictures.
Scene scene_in_file(const std::string& text, const std::string& path) {
  return for_camera(parse_embedded_scene(text, path)).scene;
}

}  // namespace

ImportedScene import_camera_scene(const std::vector<std::string>& files,
                                  const SceneSettings& settings, std::string_view format) {
  SceneSettings values = settings;
  const double f_number = take_f_number(values.values, values.option);
  CameraSpec given = parse_with(kNothingYet, "camera", values).scene.camera;
  if (f_number > 0) {
    // The focal length may stand in a file: a diameter that is certainly replaced.
    given.lens.diameter = given.lens.focal_length > 0 ? given.lens.focal_length / f_number : 1;
  }
  ImportedCamera found = import_camera(files, given, format);
  ImportedScene result;
  Scene& scene = result.scene;
  if (found.scene_text.empty()) {
    scene.camera = found.camera;
  } else {
    const Scene whole = scene_in_file(found.scene_text, files.front());
    scene.camera = whole.camera;
    scene.channels = whole.channels;
  }
  if (f_number > 0) scene.camera.lens.diameter = scene.camera.lens.focal_length / f_number;
  // Every other key that was given replaces what was found; several types that were not are none.
  std::erase_if(values.values, [](const std::string& value) {
    return value.starts_with("camera.focus.object_distance=");
  });
  scene = parse_with(write_scene(scene), "camera", values).scene;
  try {
    for (const SceneIssue& issue : validate({scene, {}}))
      if (issue.code != IssueCode::no_flame) result.warnings.push_back(to_string(issue));
  } catch (const InputError& error) {
    throw InputError(SourcePosition{files.front()},
                     "the camera that it describes cannot be: " + std::string(error.what()));
  }
  result.formats = std::move(found.formats);
  result.notes = std::move(found.notes);
  return result;
}

}  // namespace plenoflame
