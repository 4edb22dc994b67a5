#pragma once
#include <initializer_list>
#include <string>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/scene/validate.h"

namespace plenoflame {

/// Collects what the parts of check_scene find.
class Issues {
 public:
  /// @param file that the scene comes from, for what stands nowhere in it; may be empty
  explicit Issues(const PositionMap& positions, std::string file = {})
      : positions_(positions), file_(std::move(file)) {}
  void error(const std::string& key, const std::string& message) { add(true, key, message); }
  /// About several values: at the first of them that the scene file itself gives, not a preset.
  void error_among(std::initializer_list<std::string> keys, const std::string& message) {
    const std::string* chosen = keys.begin();
    for (const std::string& key : keys) {
      const std::string file = positions_.find(key).file;
      if (file.empty() || file.starts_with("preset ")) continue;
      chosen = &key;
      break;
    }
    add(true, *chosen, message);
  }
  void warning(const std::string& key, const std::string& message,
               IssueCode code = IssueCode::other) {
    add(false, key, message, code);
  }
  /// Hands what an action throws over as an error at a key, behind what it is about.
  /// @return whether it threw nothing
  template <class Action>
  bool expect(const std::string& key, const std::string& what, Action action) {
    try {
      action();
      return true;
    } catch (const InputError& thrown) {
      error(key, what + ": " + thrown.what());
      return false;
    }
  }
  std::size_t errors() const { return errors_; }
  std::vector<SceneIssue> take() { return std::move(list_); }

 private:
  void add(bool is_error, const std::string& key, const std::string& message,
           IssueCode code = IssueCode::other) {
    errors_ += is_error ? 1 : 0;
    SourcePosition position = positions_.find(key);
    if (position.file.empty()) position.file = file_;
    list_.push_back({is_error, key, position, message, code});
  }
  const PositionMap& positions_;
  std::string file_;
  std::vector<SceneIssue> list_;
  std::size_t errors_ = 0;
};

/// Geometry of lens, array, sensor and focus.
void check_camera(const CameraSpec& camera, Issues& issues);
/// Shape of the microlenses, and whether they overlap.
void check_microlens_shape(const ArraySpec& array, Issues& issues);
/// Distance by which every microlens could be displaced before it met a neighbour [m]; negative:
/// they overlap.
double room_of_microlenses(const ArraySpec& array);
/// Filters over parts of the stop, each by itself, all together, and what they leave of channels.
void check_pupil_filters(const Scene& scene, Issues& issues);
/// Flames; where they lie relative to the camera only when `camera_is_sound`.
void check_flames(const Scene& scene, bool camera_is_sound, Issues& issues);
/// Checks the times of a flame. @param path of the flame @param what it is called in messages
void check_flame_time(const FlameSpec& flame, const std::string& path, const std::string& what,
                      Issues& issues);
/// Surfaces and lights.
void check_surfaces(const Scene& scene, Issues& issues);
/// Windows, also where they stand relative to each other and to the camera.
void check_windows(const Scene& scene, Issues& issues);
/// Channels, spectra of flames, and the sensor's electronics.
void check_channels(const Scene& scene, Issues& issues);
/// Emission lines of the flames; of a scene that is otherwise sound.
void check_lines(const Scene& scene, Issues& issues);

/// Distance along the axis from a surface's vertex to its point at height h, positive towards the
/// sensor for a positive radius [m]. |radius| >= h.
double sag(double radius, double height);

/// A length for a message, to four digits: "295.9 mm".
std::string short_length(double value);

}  // namespace plenoflame
