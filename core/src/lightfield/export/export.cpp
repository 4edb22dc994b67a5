#include "plenoflame/lightfield/export.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <optional>

#include "lightfield/export/export_files.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/lightfield/develop.h"

namespace plenoflame {

std::string ExportJob::file(const std::string& name) const {
  result.files.push_back(name);
  return (std::filesystem::path(folder) / name).string();
}

void ExportJob::text(const std::string& name, const std::string& contents) const {
  write_file(file(name), contents);
}

void ExportJob::png(const std::string& name, const Image& image, double white, int bits,
                    int channels) const {
  png(name, std::vector<const Image*>{&image}, white, bits, channels);
}

void ExportJob::png(const std::string& name, const std::vector<const Image*>& images, double white,
                    int bits, int channels) const {
  PngImage picture;
  picture.width = images[0]->width;
  picture.height = images[0]->height;
  picture.bits = bits;
  picture.channels = images.size() == 3 ? 3 : channels;
  picture.samples.reserve(picture.sample_count());
  const double most = bits == 16 ? 65535 : 255;
  const auto sample = [&](float value) {
    const double share = white > 0 ? std::clamp(static_cast<double>(value) / white, 0.0, 1.0) : 0.0;
    return static_cast<std::uint16_t>(std::lround(most * encode_srgb(share)));
  };
  const int repeated = images.size() == 3 ? 1 : channels;
  for (std::size_t i = 0; i < images[0]->pixels.size(); ++i)
    for (const Image* image : images)
      picture.samples.insert(picture.samples.end(), static_cast<std::size_t>(repeated),
                             sample(image->pixels[i]));
  picture.texts = {{"Software", "Plenoflame " + field.version}};
  write_png(file(name), picture, execution.stop);
}

void ExportJob::raw_png(const std::string& name, int bits, int channels) const {
  std::vector<const Image*> images{&flux};
  if (colour) {
    images.clear();
    for (const LightFieldChannel& channel : colour->channels) images.push_back(&channel.flux);
  }
  png(name, images, raw_white(), bits, channels);
}

double ExportJob::raw_white() const {
  if (settings.saturation > 0) return settings.saturation;
  if (!colour) return automatic_saturation(flux);
  double white = 0;
  for (const LightFieldChannel& channel : colour->channels)
    white = std::max(white, automatic_saturation(channel.flux));
  return white;
}

Views ExportJob::views(int grid) const {
  ViewSettings how = settings.views;
  how.grid = settings.grid > 0 ? settings.grid : grid;
  return extract_views(field, micro, how, execution);
}

std::vector<Views> ExportJob::colour_views(const Views& views) const {
  if (!colour) return {views};
  std::vector<Views> all;
  for (const LightFieldChannel& channel : colour->channels) {
    ViewSettings how = settings.views;
    how.grid = static_cast<int>(std::lround(std::sqrt(views.views.size())));
    how.channel = channel.name;
    all.push_back(extract_views(*colour, micro, how, execution));
  }
  return all;
}

double views_white(const std::vector<Views>& colours) {
  double white = 0;
  for (const Views& views : colours) {
    Image all;
    for (const View& view : views.views)
      all.pixels.insert(all.pixels.end(), view.image.pixels.begin(), view.image.pixels.end());
    all.width = static_cast<int>(all.pixels.size());
    all.height = 1;
    white = std::max(white, automatic_saturation(all));
  }
  return white;
}

std::vector<const Image*> view_images(const std::vector<Views>& colours, std::size_t view) {
  std::vector<const Image*> images;
  for (const Views& views : colours) images.push_back(&views.views[view].image);
  return images;
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

namespace {

[[noreturn]] void refuse(const std::string& reason, const std::string& others) {
  throw InputError(reason + "; choose another format, e.g. " + others);
}

bool is_hexagonal(const Camera& camera) {
  return camera.spec().array.lattice == Lattice::hexagonal;
}

void any_camera(const Camera&) {}

void check_plenoptic_toolbox(const Camera& camera) {
  if (!is_hexagonal(camera))
    refuse("PlenopticToolbox2.0 knows hexagonal arrays only, the camera has a square one",
           "libpleno or view-grid");
}

void check_pip(const Camera& camera) {
  if (!is_hexagonal(camera))
    refuse(
        "PlenopticImageProcessing takes every array for a hexagonal one, the camera has a square "
        "one",
        "libpleno or view-grid");
}

void check_libpleno(const Camera& camera) {
  const std::size_t types = camera.spec().array.types.size();
  if (types == 2)
    refuse("libpleno knows arrays of one or three types of microlenses, the camera has two",
           "view-grid or npz");
  if (types == 3 && !is_hexagonal(camera))
    refuse(
        "libpleno knows three types of microlenses in hexagonal arrays only, the camera has a "
        "square one",
        "view-grid or npz");
}

void check_plenopticam(const Camera& camera) {
  if (!is_unfocused(camera))
    refuse(
        "plenopticam knows unfocused cameras (plenoptic 1.0) only, in which the sensor stands in "
        "the focal plane of the microlenses",
        "plenoptic-toolbox, libpleno or pip");
}

/// All that there is to know about a format.
struct ExportRow {
  ExportName name;
  void (*check)(const Camera& camera);  ///< throws where the tool cannot express the camera
  void (*write)(const ExportJob& job);
};

constexpr ExportRow kRows[]{
    {{ExportFormat::plenoptic_toolbox, "plenoptic-toolbox",
      "PlenopticToolbox2.0: RayCalibData XML and an RGB picture", 0, true},
     check_plenoptic_toolbox,
     export_plenoptic_toolbox},
    {{ExportFormat::libpleno, "libpleno",
      "libpleno, COMPOTE: camera.js, params.js, images.js, white images", 0, true},
     check_libpleno,
     export_libpleno},
    {{ExportFormat::plenopticam, "plenopticam",
      "plenopticam: sRGB picture, white image, micro-image centres", 0, true},
     check_plenopticam,
     export_plenopticam},
    {{ExportFormat::pip, "pip", "PlenopticImageProcessing: MlaDescription XML and picture", 0,
      false},
     check_pip,
     export_pip},
    {{ExportFormat::hci, "hci", "HCI 4D light field benchmark: views, parameters.cfg, PFM", 9,
      true},
     any_camera,
     export_hci},
    {{ExportFormat::plenoptomos, "plenoptomos", "plenoptomos: HDF5 (.vox)", 9, false},
     any_camera,
     export_plenoptomos},
    {{ExportFormat::eslf, "eslf", "LFToolbox: one picture, a block per lenslet", 14, true},
     any_camera,
     export_eslf},
    {{ExportFormat::view_grid, "view-grid", "LFToolbox, LightFieldLab: a picture per view", 9,
      true},
     any_camera,
     export_view_grid},
    {{ExportFormat::npz, "npz", "numpy arrays: raw image, centres, views", 9, false},
     any_camera,
     export_npz},
    {{ExportFormat::hdf5, "hdf5", "the arrays of npz as HDF5", 9, false}, any_camera, export_hdf5},
};

const ExportRow& row_of(ExportFormat format) {
  return *std::find_if(std::begin(kRows), std::end(kRows),
                       [&](const ExportRow& row) { return row.name.format == format; });
}

}  // namespace

const std::array<ExportName, std::size(kRows)>& export_formats() {
  static constexpr auto kNames = [] {
    std::array<ExportName, std::size(kRows)> names{};
    for (std::size_t i = 0; i < names.size(); ++i) names[i] = kRows[i].name;
    return names;
  }();
  return kNames;
}

void check_export(const Camera& camera, ExportFormat format) {
  if (!is_regular(camera.spec().array) && format != ExportFormat::npz &&
      format != ExportFormat::hdf5)
    refuse("this format knows one pitch, but the microlenses are not as far apart in x as in y",
           "npz or hdf5, which list every micro-image");
  if (!camera.spec().sensor.square_pixels() && format != ExportFormat::npz &&
      format != ExportFormat::hdf5)
    refuse("this format knows square pixels only", "npz or hdf5, which have pixel_pitch_y, too");
  row_of(format).check(camera);
}

ExportResult export_light_field(const LightField& light_field, const MicroImages& micro_images,
                                const ExportSettings& settings, const std::string& folder,
                                const Execution& execution) {
  ExportResult result;
  check_export(micro_images.camera(), settings.format);
  const Image& flux = find_channel(light_field, settings.views.channel).flux;
  for (const float value : flux.pixels)
    if (!std::isfinite(value)) throw InputError("the light field holds a value that is not finite");
  std::optional<LightField> colour;
  if (settings.colour.present()) {
    const ExportName& format = row_of(settings.format).name;
    if (!format.colour)
      throw InputError(std::string("the format ") + format.name +
                       " holds one channel, not a colour picture");
    colour = colour_field(light_field, settings.colour);
    for (const LightFieldChannel& channel : colour->channels)
      for (const float value : channel.flux.pixels)
        if (!std::isfinite(value))
          throw InputError("the light field holds a value that is not finite");
  }
  const ExportJob job{light_field,  flux,     colour ? &*colour : nullptr,
                      micro_images, settings, folder,
                      execution,    result};
  row_of(settings.format).write(job);
  return result;
}

}  // namespace plenoflame
