#include "plenoflame/lightfield/export.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "lightfield/export/export_files.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/lightfield/develop.h"

namespace plenoflame {

const std::array<ExportName, 10>& export_formats() {
  static constexpr std::array<ExportName, 10> kFormats{{
      {ExportFormat::plenoptic_toolbox, "plenoptic-toolbox",
       "PlenopticToolbox2.0: RayCalibData XML and an RGB picture", 0},
      {ExportFormat::libpleno, "libpleno",
       "libpleno, COMPOTE: camera.js, params.js, images.js, white images", 0},
      {ExportFormat::plenopticam, "plenopticam",
       "plenopticam: sRGB picture, white image, micro-image centres", 0},
      {ExportFormat::pip, "pip", "PlenopticImageProcessing: MlaDescription XML and picture", 0},
      {ExportFormat::hci, "hci", "HCI 4D light field benchmark: views, parameters.cfg, PFM", 9},
      {ExportFormat::plenoptomos, "plenoptomos", "plenoptomos: HDF5 (.vox)", 9},
      {ExportFormat::eslf, "eslf", "LFToolbox: one picture, a block per lenslet", 14},
      {ExportFormat::view_grid, "view-grid", "LFToolbox, LightFieldLab: a picture per view", 9},
      {ExportFormat::npz, "npz", "numpy arrays: raw image, centres, views", 9},
      {ExportFormat::hdf5, "hdf5", "the arrays of npz as HDF5", 9},
  }};
  return kFormats;
}

std::string ExportJob::file(const std::string& name) const {
  result.files.push_back(name);
  return (std::filesystem::path(folder) / name).string();
}

void ExportJob::text(const std::string& name, const std::string& contents) const {
  write_file(file(name), contents);
}

void ExportJob::png(const std::string& name, const Image& image, double white, int bits,
                    int channels) const {
  PngImage picture;
  picture.width = image.width;
  picture.height = image.height;
  picture.bits = bits;
  picture.channels = channels;
  picture.samples.reserve(picture.sample_count());
  const double most = bits == 16 ? 65535 : 255;
  for (const float value : image.pixels) {
    const double share = white > 0 ? std::clamp(static_cast<double>(value) / white, 0.0, 1.0) : 0.0;
    const auto sample = static_cast<std::uint16_t>(std::lround(most * encode_srgb(share)));
    for (int c = 0; c < channels; ++c) picture.samples.push_back(sample);
  }
  picture.texts = {{"Software", "Plenoflame " + field.version}};
  write_png(file(name), picture, execution.stop);
}

double ExportJob::raw_white() const {
  return settings.saturation > 0 ? settings.saturation : automatic_saturation(flux);
}

Views ExportJob::views(int grid) const {
  ViewSettings how = settings.views;
  how.grid = settings.grid > 0 ? settings.grid : grid;
  return extract_views(field, micro, how, execution);
}

double views_white(const Views& views) {
  Image all;
  for (const View& view : views.views)
    all.pixels.insert(all.pixels.end(), view.image.pixels.begin(), view.image.pixels.end());
  all.width = static_cast<int>(all.pixels.size());
  all.height = 1;
  return automatic_saturation(all);
}

std::string number(double value) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

std::string real(double value) {
  std::string text = number(value);
  if (text.find_first_of(".en") == std::string::npos) text += '.';
  return text;
}

void check_export(const Camera& camera, ExportFormat format) {
  const ArraySpec& array = camera.spec().array;
  const bool hexagonal = array.lattice == Lattice::hexagonal;
  const auto refuse = [](const std::string& reason, const std::string& others) {
    throw InputError(reason + "; choose another format, e.g. " + others);
  };
  switch (format) {
    case ExportFormat::plenoptic_toolbox:
      if (!hexagonal)
        refuse("PlenopticToolbox2.0 knows hexagonal arrays only, the camera has a square one",
               "libpleno or view-grid");
      break;
    case ExportFormat::pip:
      if (!hexagonal)
        refuse(
            "PlenopticImageProcessing takes every array for a hexagonal one, the camera has a "
            "square one",
            "libpleno or view-grid");
      break;
    case ExportFormat::libpleno:
      if (array.types.size() == 2)
        refuse("libpleno knows arrays of one or three types of microlenses, the camera has two",
               "view-grid or npz");
      if (array.types.size() == 3 && !hexagonal)
        refuse(
            "libpleno knows three types of microlenses in hexagonal arrays only, the camera "
            "has a square one",
            "view-grid or npz");
      break;
    case ExportFormat::plenopticam:
      if (!is_unfocused(camera))
        refuse(
            "plenopticam knows unfocused cameras (plenoptic 1.0) only, in which the sensor "
            "stands in the focal plane of the microlenses",
            "plenoptic-toolbox, libpleno or pip");
      break;
    default:
      break;
  }
}

ExportResult export_light_field(const LightField& light_field, const MicroImages& micro_images,
                                const ExportSettings& settings, const std::string& folder,
                                const Execution& execution) {
  ExportResult result;
  check_export(micro_images.camera(), settings.format);
  const Image& flux = find_channel(light_field, settings.views.channel).flux;
  for (const float value : flux.pixels)
    if (!std::isfinite(value)) throw InputError("the light field holds a value that is not finite");
  const ExportJob job{light_field, flux, micro_images, settings, folder, execution, result};
  switch (settings.format) {
    case ExportFormat::plenoptic_toolbox:
      export_plenoptic_toolbox(job);
      break;
    case ExportFormat::libpleno:
      export_libpleno(job);
      break;
    case ExportFormat::plenopticam:
      export_plenopticam(job);
      break;
    case ExportFormat::pip:
      export_pip(job);
      break;
    case ExportFormat::hci:
      export_hci(job);
      break;
    case ExportFormat::plenoptomos:
      export_plenoptomos(job);
      break;
    case ExportFormat::eslf:
      export_eslf(job);
      break;
    case ExportFormat::view_grid:
      export_view_grid(job);
      break;
    case ExportFormat::npz:
      export_npz(job);
      break;
    case ExportFormat::hdf5:
      export_hdf5(job);
      break;
  }
  return result;
}

}  // namespace plenoflame
