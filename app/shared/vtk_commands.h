#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/scene/scene.h"
#include "settings.h"

/// Commands that need VTK. Their library is loaded when one of them is called. Linked to the
/// command, VTK's hundred libraries would slow down the start of all others.
namespace plenoflame {

/// plenoflame picture
struct PictureRequest {
  std::string scene, output;
  std::optional<Scene> values;             ///< the scene, where it is not what the file says
  std::vector<std::string> cameras;        ///< whose rays are drawn; empty: of all
  std::string image;                       ///< light field for the sensor; empty: none
  std::string rays_file;                   ///< .vtp; empty: none
  std::vector<std::array<int, 2>> pixels;  ///< whose rays are drawn
  std::vector<std::array<int, 2>> microlenses;
  std::vector<std::array<double, 3>> points;  ///< [m] world
  bool chief = false;
  int random = 0;
  int rays = 32;    ///< per pixel and microlens, and per point
  int most = 2000;  ///< rays drawn
  int view = 0;     ///< vtkPlenoflameScenePicture::ViewType
  bool by_status = false;
  std::array<int, 2> size{1200, 800};
  bool flame = true, surfaces = true, insets = true, axes = true;
};

/// plenoflame flame import
struct FlameImportRequest {
  std::vector<std::string> files;
  std::string output, solution;
  std::string temperature = "T", temperature_unit = "K";
  double temperature_scale = 1;
  std::string absorption, absorption_unit = "1/m", soot;
  double constant = 0;  ///< [1/m]
  double soot_function = 0.26, wavelength = 650e-9;
  double voxel_size = 0;  ///< [m]; 0: automatic
  double length_scale = 1;
  std::array<double, 6> bounds{};  ///< [m]
  int step = -1;                   ///< -1: all of them
  bool half = false;
};

template <>
std::span<const SettingRow<FlameImportRequest>> setting_rows();

/// An array of a simulation's result: a number for each cell or point.
struct SimulationArray {
  std::string name;
  double lowest = 0, highest = 0;  ///< of the finite values, as they are in the file
  bool of_cells = false;
};

/// A file that was written, and the time that it belongs to.
struct ImportedFlame {
  std::string file;
  double time = 0;
};

/// Warnings go to standard error. @throws Error; FileError when the library is missing
void make_picture(const PictureRequest& request);
/// @param execution its stop, progress and warnings are used
/// @throws Error, FileError when the library is missing, Cancelled
std::vector<ImportedFlame> import_flames(const FlameImportRequest& request,
                                         const Execution& execution = {});

/// The arrays of a simulation's file, at its first step; arrays of single numbers only.
/// @throws Error, FileError when the library is missing, Cancelled
std::vector<SimulationArray> list_simulation_arrays(const std::string& file,
                                                    const Execution& execution = {});

}  // namespace plenoflame
