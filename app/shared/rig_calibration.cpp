#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/calibration/camera_rig.h"
#include "plenoflame/camera/camera.h"
#include "pose_calibration.h"

namespace plenoflame {
namespace {

constexpr double kUsualBoard = 0.05;  ///< [m]

/// The boards of the table of poses by their numbers.
std::map<int, RigidTransform> boards_of(const RigCamera& camera) {
  std::map<int, RigidTransform> boards;
  for (const NumberRow& row : camera.poses) {
    RigidTransform pose;
    const std::vector<double>& v = row.values;
    pose.translation = {v[2], v[3], v[4]};
    for (std::size_t k = 0; k < 3; ++k)
      pose.rotation.rows[k] = {v[5 + 3 * k], v[6 + 3 * k], v[7 + 3 * k]};
    if (!boards.emplace(row.whole(0), pose).second)
      throw InputError(row.at, "this pose was there before");
  }
  return boards;
}

/// The camera's own name, else that of its file as far as a scene allows it; numbered where another
/// camera has it.
std::string free_name(const RigCamera& camera, std::size_t number,
                      const std::vector<CameraSpec>& others) {
  std::string name = camera.scene.camera.name;
  if (name.empty())
    for (const char c : std::filesystem::path(camera.file).stem().string()) {
      const bool allowed = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') ||
                           (c >= 'a' && c <= 'z') || c == '_' || c == '-';
      name += allowed ? c : '-';
    }
  const auto is_taken = [&](const std::string& wanted) {
    return std::any_of(others.begin(), others.end(),
                       [&](const CameraSpec& other) { return other.name == wanted; });
  };
  std::string found = name;
  for (std::size_t k = number + 1; is_taken(found); ++k) found = fmt::format("{}-{}", name, k);
  return found;
}

}  // namespace

std::vector<NumberRow> read_poses(const std::string& path) {
  return read_number_rows(path, {14},
                          "a board: pose,rms_pixel,x,y,z and nine numbers of its rotation");
}

template <>
std::span<const SettingRow<RigRequest>> setting_rows() {
  static const std::vector<SettingRow<RigRequest>> rows{
      {"size", "LENGTH",
       "Approximate size of the board, which weighs rotations against places (50 mm)",
       &RigRequest::size, SettingKind::lengths}};
  return rows;
}

FoundRig calibrate_rig(const RigRequest& request, const Execution& execution) {
  const std::string name = request.names("size");
  const double size =
      request.size.empty() ? kUsualBoard : quantity_option(name, request.size, Dimension::length);
  if (!(size > 0)) throw UsageError(name + ": above 0");
  const std::vector<RigCamera>& cameras = request.cameras;
  if (cameras.size() < 2) throw UsageError("a rig has two cameras or more");
  FoundRig result;
  nlohmann::json list = nlohmann::json::array();
  const RigidTransform to_world = Camera(cameras[0].scene.camera).to_world();
  const std::map<int, RigidTransform> first_boards = boards_of(cameras[0]);
  Scene& scene = result.scene;
  scene = cameras[0].scene;
  scene.cameras.clear();
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const RigCamera& camera = cameras[k];
    CameraSpec spec = camera.scene.camera;
    spec.name = free_name(camera, k, scene.cameras);
    if (k > 0) {
      std::vector<RigidTransform> first, second;
      for (const auto& [pose, place] : boards_of(camera))
        if (const auto seen = first_boards.find(pose); seen != first_boards.end()) {
          first.push_back(seen->second);
          second.push_back(place);
        }
      if (first.empty())
        throw InputError(
            fmt::format("'{}' and '{}' have no pose in common: the same number is the "
                        "same place of the board",
                        cameras[0].what, camera.what));
      const RelativePose found = register_cameras(first, second, size);
      const RigidTransform place{to_world.rotation * found.to_first.rotation,
                                 to_world.point(found.to_first.translation)};
      spec.position = place.translation;
      spec.look_direction = place.direction({0, 0, 1});
      spec.up = place.direction({0, -1, 0});
      const Vec3 t = found.to_first.translation;
      result.report.add_text(
          spec.name,
          fmt::format("{:.4f}, {:.4f}, {:.4f} mm from the first, +- {:.3g} mm and {:.3g} mrad, by "
                      "{} boards that differ by {:.3g} mm RMS",
                      1e3 * t.x, 1e3 * t.y, 1e3 * t.z, 1e3 * found.place_error,
                      1e3 * found.turn_error, first.size(), 1e3 * found.rms));
      list.push_back({{"camera", camera.file},
                      {"boards", first.size()},
                      {"place_m", {t.x, t.y, t.z}},
                      {"place_error_m", found.place_error},
                      {"turn_error_rad", found.turn_error},
                      {"rms_m", found.rms},
                      {"apart_m", found.apart}});
      if (found.rms > 0.1 * size)
        execution.warn(
            fmt::format("the boards of '{}' and '{}' differ by {:.3g} mm: do both count columns "
                        "and rows from the same corner?",
                        cameras[0].what, camera.what, 1e3 * found.rms));
    }
    scene.cameras.push_back(spec);
  }
  scene.camera = {};
  result.report.add_json("cameras", list);
  return result;
}

}  // namespace plenoflame
