#pragma once
#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// Adds the data that later steps need beside the images: the scene's text, the version, and
/// derived values of the camera ("lens.focal_length", "array.pitch", ...; SI units).
/// @throws InputError as write_scene
void describe(const CompiledScene& scene, LightField& field);
/// The same for a camera alone: flames and lights of the scene are not opened.
void describe(const Scene& scene, const Camera& camera, LightField& field);

}  // namespace plenoflame
