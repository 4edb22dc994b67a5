#pragma once
#include <array>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/colour.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/lightfield/views.h"

namespace plenoflame {

/// Files of other light-field tools (docs/exports.md says what each holds).
enum class ExportFormat {
  plenoptic_toolbox,  ///< PlenopticToolbox2.0: RayCalibData XML and an RGB picture
  libpleno,           ///< libpleno, COMPOTE: camera.js, params.js, images.js, white images
  plenopticam,        ///< plenopticam: sRGB picture, white image, micro-image centres as JSON
  pip,                ///< PlenopticImageProcessing: MlaDescription XML and picture
  hci,                ///< HCI 4D light field benchmark: views, parameters.cfg, PFM
  plenoptomos,        ///< plenoptomos: HDF5 .vox
  eslf,               ///< LFToolbox: one picture, each lenslet a block
  view_grid,          ///< LFToolbox: a picture per view, for LFReadGantryArray
  npz,                ///< numpy arrays
  hdf5,               ///< the same arrays as HDF5
};

struct ExportName {
  ExportFormat format;
  const char* name;  ///< on the command line
  const char* what;  ///< one line
  int grid;          ///< views along a side unless said otherwise; 0: the format has none
  bool colour;       ///< whether the tool reads colour pictures
};
/// All formats.
const std::array<ExportName, 10>& export_formats();

struct ExportSettings {
  ExportFormat format = ExportFormat::npz;
  std::string name = "lightfield";  ///< stem of the files' names
  ViewSettings views;               ///< for the formats with views; views.grid is ignored
  int grid = 0;                     ///< views along a side; 0: as the tool expects
  ColourChannels colour;  ///< of pictures, where the tool knows colour; none: grey of views.channel
  double saturation = 0;  ///< [W] (formats of raw images) that becomes white; 0: automatic
};

struct ExportResult {
  std::vector<std::string> files;  ///< names within the folder, in the order written
  std::vector<std::string> notes;  ///< what the user should know, one line each
};

/// Makes sure that a tool can express the camera, before work is spent on it.
/// @throws InputError that says why not and what else to choose
void check_export(const Camera& camera, ExportFormat format);

/// Writes a raw light field for another tool. Pictures are upright, as everywhere.
/// @param folder exists
/// @throws InputError as check_export and extract_views;
///         FileError; Cancelled
ExportResult export_light_field(const LightField& light_field, const MicroImages& micro_images,
                                const ExportSettings& settings, const std::string& folder,
                                const Execution& execution = {});

}  // namespace plenoflame
