#include "plenoflame/camera/camera_import.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "camera/import/found_camera.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/printable.h"
#include "plenoflame/image/open_file.h"

namespace plenoflame {

void refuse_calibration(const CalibrationFile& file, const std::string& message) {
  throw InputError(SourcePosition{file.path}, message);
}

nlohmann::json read_json(const CalibrationFile& file) {
  // The parser recurses without a limit, so the nesting is limited before it runs.
  int depth = 0;
  for (const char c : file.text) {
    depth += c == '[' || c == '{' ? 1 : c == ']' || c == '}' ? -1 : 0;
    if (depth > 64) refuse_calibration(file, "its lists are nested too deeply");
  }
  try {
    return nlohmann::json::parse(file.text);
  } catch (const nlohmann::json::parse_error& error) {
    const std::size_t end = std::min(error.byte, file.text.size());
    const auto stop = file.text.begin() + static_cast<std::ptrdiff_t>(end);
    const auto line = 1 + std::count(file.text.begin(), stop, '\n');
    throw InputError(SourcePosition{file.path, static_cast<int>(line)},
                     "it is no JSON from here on, or cut off");
  } catch (const nlohmann::json::exception&) {
    refuse_calibration(file, "holds a number that is too large");
  }
}

double json_number(const CalibrationFile& file, const nlohmann::json& value,
                   const std::string& key) {
  double number = std::nan("");
  if (value.is_number()) {
    number = value.get<double>();
  } else if (value.is_string()) {
    const std::string& text = value.get_ref<const std::string&>();
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) number = std::nan("");
  }
  if (!std::isfinite(number)) refuse_calibration(file, key + " is no finite number");
  return number;
}

namespace {

struct CameraFormatRow {
  CameraFormatName name;
  bool (*recognise)(const CalibrationFile& file);
  void (*read)(const CalibrationFile& file, FoundCamera& found);
};

constexpr CameraFormatRow kFormatRows[]{
    {{"libpleno", "libpleno, COMPOTE: intrinsics.js or camera.js"}, is_libpleno, read_libpleno},
    {{"libpleno-parameters", "libpleno, COMPOTE: params.js, beside one of those"},
     is_libpleno_parameters,
     read_libpleno_parameters},
    {{"plenoptic-toolbox", "PlenopticToolbox2.0: RayCalibData XML"},
     is_plenoptic_toolbox,
     read_plenoptic_toolbox},
    {{"pip", "PlenopticImageProcessing: MlaDescription XML"}, is_pip, read_pip},
    {{"plenoptomos", "plenoptomos: .ini"}, is_plenoptomos, read_plenoptomos},
    {{"vox", "plenoptomos: .vox"}, is_vox, read_vox},
    {{"hdf5", "the exported format of this name: .h5"}, is_exported_hdf5, read_exported_hdf5},
    {{"lf-toolbox", "LFToolbox, and the exported view-grid: LensletGridModel, .json"},
     is_lf_toolbox,
     read_lf_toolbox},
    {{"plenopticam", "plenopticam: .json of the white image"}, is_plenopticam, read_plenopticam},
    {{"centres", "libpleno: CSV of centres, k,l,u,v"}, is_centre_list, read_centre_list},
    {{"ten-parameters", "Bok, Nousias, O'Brien: K1, K2, fx, fy, cx, cy as text"},
     is_ten_parameters,
     read_ten_parameters},
};

constexpr std::size_t kLargestCalibration = 64u << 20;

std::string read_whole(const std::string& path) {
  std::FILE* const file = open_for_reading(path);
  std::string text;
  std::array<char, 65536> part{};
  std::size_t count = 0;
  while ((count = std::fread(part.data(), 1, part.size(), file)) > 0 &&
         text.size() <= kLargestCalibration) {
    text.append(part.data(), count);
    // The file also holds pictures; readers of HDF5 open it themselves.
    if (text.starts_with(kHdf5Signature)) break;
  }
  const bool failed = std::ferror(file) != 0;
  std::fclose(file);
  if (failed) throw FileError("cannot read '" + path + "'");
  if (text.size() > kLargestCalibration)
    throw InputError(SourcePosition{path}, "is larger than 64 MiB: no calibration");
  return text;
}

const CameraFormatRow& format_of(const CalibrationFile& file, std::string_view format) {
  for (const CameraFormatRow& row : kFormatRows)
    if (format.empty() ? row.recognise(file) : row.name.name == format) return row;
  std::string names;
  for (const CameraFormatRow& row : kFormatRows)
    names += std::string(names.empty() ? "" : ", ") + row.name.name;
  refuse_calibration(file, "is no calibration of a known kind; known are " + names);
}

void take_given(double& known, double given) {
  if (given > 0) known = given;
}

/// Given values replace those of files. They are set before the files are read, which need the size
/// of a pixel.
void take_given(const CameraSpec& given, CameraSpec& camera) {
  take_given(camera.lens.focal_length, given.lens.focal_length);
  take_given(camera.lens.diameter, given.lens.diameter);
  if (std::isfinite(given.lens.distortion.distance))
    camera.lens.distortion.distance = given.lens.distortion.distance;
  take_given(camera.array.pitch, given.array.pitch);
  take_given(camera.array.sensor_distance, given.array.sensor_distance);
  take_given(camera.sensor.pixel_pitch, given.sensor.pixel_pitch);
  take_given(camera.sensor.pixel_pitch_y, given.sensor.pixel_pitch_y);
  if (given.sensor.columns > 0) camera.sensor.columns = given.sensor.columns;
  if (given.sensor.rows > 0) camera.sensor.rows = given.sensor.rows;
  take_given(camera.focus.lens_distance, given.focus.lens_distance);
  for (std::size_t i = 0; i < given.array.types.size() && i < camera.array.types.size(); ++i)
    if (given.array.types[i].focal_length != 0)
      camera.array.types[i].focal_length = given.array.types[i].focal_length;
}

class MissingValues {
 public:
  void need(bool there, const std::string& key, const std::string& what) {
    if (!there) list_ += (list_.empty() ? "" : ", ") + key + "=" + what;
  }
  void report(const std::string& path) const {
    if (!list_.empty())
      throw InputError(SourcePosition{path},
                       "values are missing that no file gives; set each of them: " + list_);
  }

 private:
  std::string list_;
};

/// Places microlenses behind the grid of micro-images. The ray from the middle of the main lens to
/// the middle of a micro-image crosses the array at its microlens.
void place_grid(const FoundGrid& grid, CameraSpec& camera) {
  ArraySpec& array = camera.array;
  const Vec2 p = camera.sensor.pixel();
  const double distance = camera.focus.lens_distance, gap = array.sensor_distance;
  const double shrink = distance / (distance + gap);
  array.lattice = grid.hexagonal ? Lattice::hexagonal : Lattice::square;
  const double c = std::cos(grid.rotation), s = std::sin(grid.rotation);
  // Steps along and across the rows on the sensor, for pixels that may be rectangular.
  const Vec2 along{grid.pitch.x * c * p.x, grid.pitch.x * s * p.y};
  const Vec2 across{-grid.pitch.y * s * p.x, grid.pitch.y * c * p.y};
  array.pitch = shrink * length(along);
  array.rotation = std::atan2(along.y, along.x);
  const double pitch_y = shrink * length(across);
  array.pitch_y = 0;
  if (!grid.hexagonal && std::fabs(pitch_y / array.pitch - 1) > 1e-12) array.pitch_y = pitch_y;
  const Vec2 centre{(0.5 * camera.sensor.columns - grid.origin.x) * p.x,
                    (0.5 * camera.sensor.rows - grid.origin.y) * p.y};
  array.offset = shrink * (centre + (gap / distance) * camera.lens.decentre);
}

/// Values of a damaged file may overflow a double while the camera is computed.
void check_finite(const CameraSpec& camera, const std::string& file) {
  const ArraySpec& array = camera.array;
  std::vector<double> values{camera.lens.focal_length,
                             camera.lens.diameter,
                             camera.focus.lens_distance,
                             camera.sensor.pixel_pitch,
                             camera.sensor.pixel_pitch_y,
                             array.pitch,
                             array.pitch_y,
                             array.sensor_distance,
                             array.rotation,
                             array.offset.x,
                             array.offset.y,
                             array.tilt.x,
                             array.tilt.y};
  for (const MicrolensSpec& type : array.types) values.push_back(type.focal_length);
  for (const double value : values)
    if (!std::isfinite(value))
      throw InputError(SourcePosition{file}, "a length or an angle of this camera is not finite");
}

}  // namespace

std::span<const CameraFormatName> camera_formats() {
  static constexpr auto kNames = [] {
    std::array<CameraFormatName, std::size(kFormatRows)> names{};
    for (std::size_t i = 0; i < names.size(); ++i) names[i] = kFormatRows[i].name;
    return names;
  }();
  return kNames;
}

ImportedCamera import_camera(const std::vector<std::string>& files, const CameraSpec& given,
                             std::string_view format) {
  if (files.empty()) throw InputError("no calibration file was given");
  ImportedCamera result;
  FoundCamera found;
  CameraSpec& camera = found.camera;
  camera.lens.model = camera.array.model = LensModel::ideal;
  camera.array.present = true;
  take_given(given, camera);
  for (const std::string& path : files) {
    const CalibrationFile file{path, read_whole(path)};
    const CameraFormatRow& row = format_of(file, format);
    row.read(file, found);
    result.formats.emplace_back(row.name.name);
  }
  if (!found.scene_text.empty()) {
    if (files.size() > 1)
      throw InputError(SourcePosition{files.front()},
                       "one of the files holds a whole scene: give it alone");
    result.scene_text = found.scene_text;
    return result;
  }
  if (!found.placed && found.grid) {
    const auto types = static_cast<std::size_t>(found.grid->types);
    if (camera.array.types.size() < types) camera.array.types.resize(types);
  }
  ArraySpec& array = camera.array;
  if (array.types.empty()) array.types.resize(1);
  take_given(given, camera);
  if (camera.focus.lens_distance == 0 && given.focus.object_distance > camera.lens.focal_length &&
      camera.lens.focal_length > 0)
    camera.focus.lens_distance =
        1 / (1 / camera.lens.focal_length - 1 / given.focus.object_distance);
  camera.focus.mode = FocusMode::distance;

  MissingValues missing;
  missing.need(camera.sensor.columns > 0, "camera.sensor.columns", "COUNT");
  missing.need(camera.sensor.rows > 0, "camera.sensor.rows", "COUNT");
  missing.need(camera.sensor.pixel_pitch > 0, "camera.sensor.pixel_pitch", "LENGTH");
  missing.need(camera.lens.focal_length > 0, "camera.lens.focal_length", "LENGTH");
  missing.need(camera.lens.diameter > 0, "camera.lens.diameter", "LENGTH");
  missing.need(camera.focus.lens_distance > 0, "camera.focus.lens_distance",
               "LENGTH (main lens to array; or "
               "camera.focus.object_distance)");
  missing.need(array.sensor_distance > 0, "camera.array.sensor_distance", "LENGTH");
  missing.need(found.placed || found.grid || array.pitch > 0, "camera.array.pitch",
               "LENGTH (or a further FILE with the grid)");
  for (std::size_t i = 0; i < array.types.size(); ++i)
    missing.need(array.types[i].focal_length != 0,
                 "camera.array.types[" + std::to_string(i) + "].focal_length", "LENGTH");
  missing.report(files.front());

  if (!found.placed && found.grid) place_grid(*found.grid, camera);
  if (!found.placed && !found.grid)
    found.note(
        "no file says where the microlenses are: camera.array.lattice, offset and rotation "
        "are those that were given, or the default");
  array.diameter = array.pitch_y > 0 ? std::min(array.pitch, array.pitch_y) : array.pitch;
  check_finite(camera, files.front());
  found.note(
      "microlenses are circles that touch; no file gives their clear diameter "
      "(camera.array.diameter)");
  if (array.types.size() == 1) {
    array.types[0].name = "all";
  } else {
    for (std::size_t i = 0; i < array.types.size(); ++i)
      array.types[i].name = "type" + std::to_string(i);
  }
  result.camera = camera;
  result.notes = found.notes;
  return result;
}

}  // namespace plenoflame
