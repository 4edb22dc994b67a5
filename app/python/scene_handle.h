#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/volumes/scene_session.h"

namespace plenoflame::python {

/// A scene, and what was said about it. One of several cameras is chosen first.
struct SceneHandle : SceneSession {
  Scene scene_of_camera() const {
    check_camera();
    return SceneSession::scene_of_camera();
  }
  std::shared_ptr<const CompiledScene> compile(const Execution& execution,
                                               const std::vector<IssueCode>& unsaid = {}) {
    check_camera();
    return SceneSession::compile(execution, unsaid);
  }
  /// @throws UsageError that says how Python chooses
  void check_camera() const {
    const std::vector<std::string> names = camera_names(scene());
    if (!camera().empty() || names.size() < 2) return;
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    throw UsageError("the scene has the cameras " + list + "; choose one: scene.with_camera('" +
                     names.front() + "')");
  }

  std::vector<std::string> warnings;  ///< not fetched yet
};

}  // namespace plenoflame::python
