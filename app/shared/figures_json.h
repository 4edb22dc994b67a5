#pragma once
#include <string>

namespace plenoflame {
struct Execution;
struct LightField;
struct Scene;

/// The text of `plenoflame design --json` for a scene that has passed validate(), made by the
/// same functions. @throws InputError
std::string design_json(const Scene& scene);

/// {"value", "unit", "text"} of a scene's value. @throws InputError for an unknown path
std::string value_json(const Scene& scene, const std::string& path);

/// The figures that `plenoflame compare --json` prints of two light fields; its warnings.
/// @throws InputError
std::string comparison_json(const LightField& field, const LightField& reference,
                            const std::string& channel, const Execution& execution);

}  // namespace plenoflame
