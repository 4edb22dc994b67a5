/// Calibrations in HDF5: plenoptomos' .vox, and the scene in a file of export --format hdf5.
#include <hdf5.h>

#include <algorithm>
#include <cmath>

#include "camera/import/found_camera.h"

namespace plenoflame {
namespace {

/// An HDF5 identifier with its closing function; negative if opening failed.
class CalibrationId {
 public:
  CalibrationId(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~CalibrationId() {
    if (id_ >= 0) close_(id_);
  }
  CalibrationId(const CalibrationId&) = delete;
  CalibrationId& operator=(const CalibrationId&) = delete;
  operator hid_t() const { return id_; }
  bool there() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

hid_t open_quietly(const CalibrationFile& file) {
  // HDF5 would otherwise print its own error messages.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  return file.text.starts_with(kHdf5Signature)
             ? H5Fopen(file.path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)
             : -1;
}

class Hdf5Calibration {
 public:
  explicit Hdf5Calibration(const CalibrationFile& file)
      : file_(file), hdf5_(open_quietly(file), H5Fclose) {}

  bool opened() const { return hdf5_.there(); }

  /// The text attribute of a group; empty: there is none.
  std::string text(const char* group, const char* name) const {
    const CalibrationId made(H5Aopen_by_name(hdf5_, group, name, H5P_DEFAULT, H5P_DEFAULT),
                             H5Aclose);
    if (!made.there()) return {};
    const CalibrationId type(H5Aget_type(made), H5Tclose);
    const CalibrationId space(H5Aget_space(made), H5Sclose);
    if (!type.there() || H5Tget_class(type) != H5T_STRING ||
        H5Sget_simple_extent_npoints(space) != 1)
      return {};
    if (H5Tis_variable_str(type) > 0) {
      char* value = nullptr;
      const CalibrationId memory(H5Tcopy(H5T_C_S1), H5Tclose);
      H5Tset_size(memory, H5T_VARIABLE);
      H5Tset_cset(memory, H5Tget_cset(type));
      if (H5Aread(made, memory, &value) < 0 || value == nullptr) return {};
      std::string text = value;
      H5free_memory(value);
      return text;
    }
    std::string text(std::min(H5Tget_size(type), kLongestText), '\0');
    if (text.size() < H5Tget_size(type) || H5Aread(made, type, text.data()) < 0) return {};
    return text.substr(0, text.find('\0'));
  }

  /// The numbers of a short array; empty: there is none. @throws InputError for another count or
  /// numbers that are not finite
  std::vector<double> numbers(const std::string& path, std::size_t count) const {
    const CalibrationId data(H5Dopen2(hdf5_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.there()) return {};
    const CalibrationId space(H5Dget_space(data), H5Sclose);
    std::vector<double> values(count);
    if (H5Sget_simple_extent_npoints(space) != static_cast<hssize_t>(count) ||
        H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      refuse_calibration(file_, path + " is not " + std::to_string(count) + " numbers");
    for (const double value : values)
      if (!std::isfinite(value)) refuse_calibration(file_, path + " is no finite number");
    return values;
  }

 private:
  static constexpr std::size_t kLongestText = std::size_t{1} << 26;

  const CalibrationFile& file_;
  CalibrationId hdf5_;
};

}  // namespace

bool is_vox(const CalibrationFile& file) {
  const Hdf5Calibration hdf5(file);
  return hdf5.opened() && hdf5.text("/", "description") == "VoxelDataFormat";
}

void read_vox(const CalibrationFile& file, FoundCamera& found) {
  const Hdf5Calibration hdf5(file);
  if (!hdf5.opened()) refuse_calibration(file, "is no HDF5 file, or cut off");
  const std::string root = "/instrument/camera/";
  std::map<std::string, double> values;
  // Arrays hold the vertical value first, then the horizontal one; positions hold x first.
  const auto take = [&](const char* path, const std::vector<const char*>& keys) {
    const std::vector<double> numbers = hdf5.numbers(root + path, keys.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) values[keys[i]] = numbers[i];
  };
  take("sensor/size", {"sensor.size_y", "sensor.size_x"});
  take("sensor/pixel_size", {"sensor.pixel_size_y", "sensor.pixel_size_x"});
  take("sensor/position", {"sensor.x", "sensor.y", "sensor.z"});
  take("micro_lenses_array/position",
       {"micro_lenses_array.x", "micro_lenses_array.y", "micro_lenses_array.z"});
  take("main_lens/f1", {"main_lens.f1"});
  take("main_lens/aperture", {"main_lens.aperture"});
  take("micro_lens/f2", {"micro_lens.f2"});
  take("micro_lens/physical_size", {"micro_lens.physical_size_t", "micro_lens.physical_size_s"});
  take("micro_lens/micro_image_size", {"image_t", "image_s"});
  if (values.empty()) refuse_calibration(file, "lacks the values of /instrument/camera");
  // In views of hexagonal arrays the pixel size differs from the size of a microlens. The distance
  // of micro-images is the array's pitch as seen from the main lens.
  const double shrink =
      values["sensor.z"] > 0 ? values["micro_lenses_array.z"] / values["sensor.z"] : 0;
  if (values["image_t"] > 0 && values["image_s"] > 0 && shrink > 0) {
    values["micro_lens.physical_size_t"] = shrink * values["image_t"];
    values["micro_lens.physical_size_s"] = shrink * values["image_s"];
  }
  // Plenoflame writes a length; the other tool copies the value of its .ini.
  const bool own = hdf5.text("/instrument/camera", "manufacturer") == "Plenoflame";
  take_plenoptomos(file, values, own, found);
  if (hdf5.text("/data/image", "mode") == "sub-aperture")
    found.note(
        "the file holds views: its pixels and their number are those of the views, and lenses "
        "are square to it (camera.sensor.columns, rows, pixel_pitch, camera.array.lattice)");
}

bool is_exported_hdf5(const CalibrationFile& file) {
  const Hdf5Calibration hdf5(file);
  return hdf5.opened() && !hdf5.text("/", "scene").empty();
}

void read_exported_hdf5(const CalibrationFile& file, FoundCamera& found) {
  const Hdf5Calibration hdf5(file);
  if (!hdf5.opened()) refuse_calibration(file, "is no HDF5 file, or cut off");
  found.scene_text = hdf5.text("/", "scene");
  if (found.scene_text.empty()) refuse_calibration(file, "lacks the text of a scene");
}

}  // namespace plenoflame
