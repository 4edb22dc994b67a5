#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/scene/scene_file.h"

/// Scenes that several cameras look at. Functions that use a scene treat one camera; those here
/// give the scene of one camera.
namespace plenoflame {

/// Names of a scene's cameras in its order: those of "[[cameras]]", or the one of "[camera]", which
/// may be empty.
std::vector<std::string> camera_names(const Scene& scene);

/// The same flames, surfaces, lights and settings with one camera alone: Scene::camera is it, and
/// Scene::cameras is empty.
/// @param name empty: the only one there is
/// @throws InputError for a name that no camera has, naming the nearest; for an empty one when
/// there are several, naming all
Scene for_camera(const Scene& scene, std::string_view name = {});

/// The same; keys of "cameras[i]" in its positions become those of "camera".
SceneDocument for_camera(const SceneDocument& document, std::string_view name = {});

/// The scene with a camera in place of the one that has its name, or of its only one.
Scene replace_camera(const Scene& scene, const CameraSpec& camera);

/// Puts a camera before that place of Scene::cameras: a copy of the one before it, with a name that
/// is free. A single "[camera]" becomes the first of them. @param position at most their number
void insert_camera(Scene& scene, std::size_t position);

/// "the camera", or with its name: `camera "left"`.
std::string camera_in_words(const CameraSpec& camera);

}  // namespace plenoflame
