#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>

#include "commands/calibration/calibrate.h"
#include "commands/scene_input.h"
#include "messages.h"
#include "number_rows.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/calibration/camera_rig.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/scene/scene_file.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

constexpr double kUsualBoard = 0.05;  ///< [m]

struct RigArguments {
  std::vector<std::string> cameras;
  std::string output, board;
  bool json = false;
};

struct RigCamera {
  std::string file;
  CameraSpec spec;
  std::map<int, RigidTransform> boards;
};

/// The table that calibrate geometry writes with --poses.
std::map<int, RigidTransform> read_poses(const std::string& path) {
  std::map<int, RigidTransform> poses;
  for (const NumberRow& row : read_number_rows(
           path, 14, "a board: pose,rms_pixel,x,y,z and nine numbers of its rotation")) {
    RigidTransform pose;
    const std::vector<double>& v = row.values;
    pose.translation = {v[2], v[3], v[4]};
    for (std::size_t k = 0; k < 3; ++k)
      pose.rotation.rows[k] = {v[5 + 3 * k], v[6 + 3 * k], v[7 + 3 * k]};
    if (!poses.emplace(static_cast<int>(v[0]), pose).second)
      throw InputError(SourcePosition{path, row.line}, "this pose was there before");
  }
  return poses;
}

/// The camera's own name, else that of its file as far as a scene allows it; numbered where another
/// camera has it.
std::string free_name(const RigCamera& camera, std::size_t number,
                      const std::vector<CameraSpec>& others) {
  std::string name = camera.spec.name;
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

int run_rig(const RigArguments& arguments) {
  check_ending("-o", arguments.output, {".toml"});
  const double size = arguments.board.empty()
                          ? kUsualBoard
                          : quantity_option("--size", arguments.board, Dimension::length);
  if (!(size > 0)) throw UsageError("--size: above 0");
  std::vector<RigCamera> cameras;
  for (const std::string& text : arguments.cameras) {
    const std::size_t sign = text.find('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == text.size())
      throw UsageError("'" + text +
                       "' is no CAMERA.toml=POSES.csv: the camera and the places of "
                       "its boards, both from calibrate geometry");
    RigCamera camera;
    camera.file = text.substr(0, sign);
    camera.spec = read_valid_scene(camera.file).scene.camera;
    camera.boards = read_poses(text.substr(sign + 1));
    cameras.push_back(std::move(camera));
  }
  if (cameras.size() < 2) throw UsageError("a rig has two cameras or more");
  check_writable(arguments.output);
  Report report;
  nlohmann::json list = nlohmann::json::array();
  const RigidTransform to_world = Camera(cameras[0].spec).to_world();
  Scene scene = read_valid_scene(cameras[0].file).scene;
  scene.cameras.clear();
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    RigCamera& camera = cameras[k];
    camera.spec.name = free_name(camera, k, scene.cameras);
    if (k > 0) {
      std::vector<RigidTransform> first, second;
      for (const auto& [pose, place] : camera.boards)
        if (const auto seen = cameras[0].boards.find(pose); seen != cameras[0].boards.end()) {
          first.push_back(seen->second);
          second.push_back(place);
        }
      if (first.empty())
        throw InputError(
            fmt::format("'{}' and '{}' have no pose in common: the same number is the "
                        "same place of the board",
                        cameras[0].file, camera.file));
      const RelativePose found = register_cameras(first, second, size);
      const RigidTransform place{to_world.rotation * found.to_first.rotation,
                                 to_world.point(found.to_first.translation)};
      camera.spec.position = place.translation;
      camera.spec.look_direction = place.direction({0, 0, 1});
      camera.spec.up = place.direction({0, -1, 0});
      const Vec3 t = found.to_first.translation;
      report.add_text(
          camera.spec.name,
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
        warn(
            fmt::format("the boards of '{}' and '{}' differ by {:.3g} mm: do both count columns "
                        "and rows from the same corner?",
                        cameras[0].file, camera.file, 1e3 * found.rms));
    }
    scene.cameras.push_back(camera.spec);
  }
  scene.camera = {};
  write_scene_file(arguments.output, scene);
  report.add("scene", arguments.output, "output", arguments.output);
  report.add_json("cameras", list);
  report.print(arguments.json);
  return kSuccess;
}

}  // namespace

void add_calibrate_rig(CLI::App& calibrate, const Registry& registry) {
  auto a = std::make_shared<RigArguments>();
  CLI::App& command = *calibrate.add_subcommand(
      "rig", "Where several cameras stand, by boards that they have seen together");
  command.footer(
      "Example:\n"
      "  plenoflame calibrate rig left.toml=left-poses.csv right.toml=right-poses.csv -o rig.toml");
  command
      .add_option("CAMERA", a->cameras,
                  "CAMERA.toml=POSES.csv of calibrate geometry; a pose's number stands for one "
                  "place of the board, and the first camera stays")
      ->required();
  command
      .add_option("-o,--output", a->output, "Scene file with all cameras, in the first one's world")
      ->check(written())
      ->required()
      ->option_text("FILE.toml");
  command
      .add_option("--size", a->board,
                  "Approximate size of the board, which weighs rotations against places (50 mm)")
      ->option_text("LENGTH");
  command.add_flag("--json", a->json, "Print the figures as JSON");
  on_chosen(command, registry, [a] { return run_rig(*a); });
}

}  // namespace plenoflame::cli
