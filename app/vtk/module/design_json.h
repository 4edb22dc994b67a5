#pragma once
#include <string>

namespace plenoflame {
struct Scene;

namespace pipeline {

/// What `plenoflame design --json` prints for a scene that has passed validate(): made by the same
/// functions. @throws InputError
std::string design_json(const Scene& scene);

}  // namespace pipeline
}  // namespace plenoflame
