#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/scene/camera_spec.h"

/// Common parts of the readers of calibration files (camera_import.h). A format is a row of
/// camera_import.cpp and a function in a file of its own.
namespace plenoflame {

/// The regular grid of micro-images, in upright pixel coordinates. x points right, y down, and
/// pixel (0, 0) has its centre at (0.5, 0.5).
struct FoundGrid {
  bool hexagonal = true;
  Vec2 origin;  ///< [pixel] centre of a micro-image of the first type
  /// [pixel] Along and across its rows; in a hexagonal grid both are the distance of neighbours.
  Vec2 pitch;
  double rotation = 0;  ///< [rad] of the rows, from x towards y
  int types = 1;
};

/// The values from all files so far; 0 is an unknown value. All lengths in metres.
struct FoundCamera {
  CameraSpec camera;
  std::optional<FoundGrid> grid;
  /// True if pitch, offset and rotation of the array are in `camera`, not in `grid`.
  bool placed = false;
  std::vector<std::string> notes;
  /// TOML text of a file that holds a whole scene; it replaces all other values.
  std::string scene_text;

  void note(std::string text) { notes.push_back(std::move(text)); }
};

/// A file as its reader receives it.
struct CalibrationFile {
  std::string path;
  std::string text;  ///< of HDF5 only the beginning
};

/// First bytes of an HDF5 file.
constexpr std::string_view kHdf5Signature{"\x89HDF\r\n\x1a\n", 8};

/// Sets a value that is still unknown.
inline void set_new(double& known, double value) {
  if (known == 0) known = value;
}
inline void set_new(int& known, int value) {
  if (known == 0) known = value;
}

/// @throws InputError that begins with the file's name
[[noreturn]] void refuse_calibration(const CalibrationFile& file, const std::string& message);

/// Reads a number that may be in quotes. @throws InputError with the key if it is no finite number
double json_number(const CalibrationFile& file, const nlohmann::json& value,
                   const std::string& key);

/// JSON of a calibration file. @throws InputError with line and column
nlohmann::json read_json(const CalibrationFile& file);

/// The centre of a micro-image with its column and row, for the fit of a regular grid. Columns of a
/// hexagonal grid count along each row. Odd rows are shifted by half a step against even rows, to
/// the right or to the left.
struct NumberedCentre {
  int column = 0, row = 0;
  Vec2 at;  ///< [pixel] as in FoundGrid
};
FoundGrid fit_found_grid(const CalibrationFile& file, const std::vector<NumberedCentre>& centres,
                         bool hexagonal, FoundCamera& found);

bool is_libpleno(const CalibrationFile& file);
void read_libpleno(const CalibrationFile& file, FoundCamera& found);
bool is_libpleno_parameters(const CalibrationFile& file);
void read_libpleno_parameters(const CalibrationFile& file, FoundCamera& found);
bool is_plenoptic_toolbox(const CalibrationFile& file);
void read_plenoptic_toolbox(const CalibrationFile& file, FoundCamera& found);
bool is_pip(const CalibrationFile& file);
void read_pip(const CalibrationFile& file, FoundCamera& found);
bool is_plenoptomos(const CalibrationFile& file);
void read_plenoptomos(const CalibrationFile& file, FoundCamera& found);
/// Takes the values of plenoptomos' files, by section and key of its .ini: nominal values in mm, z
/// from the main lens.
/// @param aperture_is_length true: the main lens' aperture is a length; false: it is an f-number
void take_plenoptomos(const CalibrationFile& file, const std::map<std::string, double>& values,
                      bool aperture_is_length, FoundCamera& found);
bool is_vox(const CalibrationFile& file);
void read_vox(const CalibrationFile& file, FoundCamera& found);
bool is_exported_hdf5(const CalibrationFile& file);
void read_exported_hdf5(const CalibrationFile& file, FoundCamera& found);
bool is_lf_toolbox(const CalibrationFile& file);
void read_lf_toolbox(const CalibrationFile& file, FoundCamera& found);
bool is_plenopticam(const CalibrationFile& file);
void read_plenopticam(const CalibrationFile& file, FoundCamera& found);
bool is_centre_list(const CalibrationFile& file);
void read_centre_list(const CalibrationFile& file, FoundCamera& found);
bool is_ten_parameters(const CalibrationFile& file);
void read_ten_parameters(const CalibrationFile& file, FoundCamera& found);

}  // namespace plenoflame
