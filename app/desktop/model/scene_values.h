#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/scene/scene_schema.h"

// The values of a scene that people see and change: those of its schema, and the f-number of each
// main lens, "camera.lens.f_number". A scene has the lens' stop in its place.
namespace plenoflame::desktop {

/// The key of a path with or without indices; null: there is none.
const SchemaKey* find_value(std::string_view path);

/// Every path that a scene has values for, in the order of files.
std::vector<std::string> value_paths(const Scene& scene);

/// The value as text with a unit. An f-number has four digits; a lens without one has an empty
/// text.
/// @throws InputError as get_text()
std::string value_text(const Scene& scene, const std::string& path);

/// An f-number sets the diameter of the stop, wider than before as well. @throws InputError as
/// set_text(), and where the lens has no f-number
void set_value_text(Scene& scene, const std::string& path, const std::string& text);

}  // namespace plenoflame::desktop
