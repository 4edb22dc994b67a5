#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/base/report.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/scene_file.h"
#include "raw_files.h"
#include "settings.h"

namespace plenoflame {

/// A request for the light field of a real camera's pictures.
struct RawPicturesRequest {
  RawFileOptions files;
  std::vector<std::string> raw;  ///< files of one scene; NAME=FILE: of that channel
  std::string channel = {}, unit = {};
  std::vector<std::string> dark = {}, flat = {}, flat_dark = {}, white = {}, white_dark = {};
  std::string defects = {};
  std::optional<double> gain = {}, read_noise = {}, black_level = {};
  std::vector<std::string> exposure_time = {};  ///< with units; NAME=TIME: of that channel
  std::optional<double> saturation = {};
  std::string noise = {};
  std::vector<std::string> radiometry = {};
  std::string window = {};

  const SettingNames& names() const { return files.names; }
};
template <>
std::span<const SettingRow<RawPicturesRequest>> setting_rows();

/// The pictures of a camera, and the figures about them.
struct RawPictures {
  LightField light_field;
  Report report;
};

/// Reads pictures and corrections, and makes a light field of them.
/// @param camera scene with the camera and its channels
/// @throws UsageError, InputError, FileError
RawPictures import_pictures(const RawPicturesRequest& request, const SceneDocument& camera,
                            const Execution& execution);

}  // namespace plenoflame
