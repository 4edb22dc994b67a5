#include "commands/light_field/compare_lenses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "commands/scene_input.h"
#include "plenoflame/base/error.h"
#include "plenoflame/calibration/registration.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/image/png_file.h"

namespace plenoflame::cli {
namespace {

/// Blue where the measured picture is darker than the fitted one, red where it is brighter; full
/// colour at a tenth of the brightest light.
void write_residual_map(const std::string& path, const Image& rest, double brightest) {
  constexpr double kFull = 0.1;
  PngImage picture;
  picture.width = rest.width;
  picture.height = rest.height;
  picture.channels = 3;
  picture.samples.reserve(picture.sample_count());
  for (const float value : rest.pixels) {
    const double share = std::clamp(static_cast<double>(value) / (kFull * brightest), -1.0, 1.0);
    const auto fade = static_cast<std::uint16_t>(std::lround(255 * (1 - std::fabs(share))));
    const std::uint16_t full = 255;
    if (share > 0)
      picture.samples.insert(picture.samples.end(), {full, fade, fade});
    else
      picture.samples.insert(picture.samples.end(), {fade, fade, full});
  }
  write_png(path, picture);
}

std::string table_of(const Registration& registration) {
  std::string text =
      "q,r,type,column,row,pixels,gain,gain_error,shift_x,shift_y,shift_x_error,shift_y_error,"
      "residual\n";
  for (const LensFit& lens : registration.lenses) {
    const PictureFit& f = lens.fit;
    text += fmt::format(
        "{},{},{},{:.4f},{:.4f},{},{:.6g},{:.3g},{:.5f},{:.5f},{:.3g},{:.3g},{:.5g}\n", lens.lens.q,
        lens.lens.r, lens.type, lens.centre.x, lens.centre.y, f.pixels, f.gain, f.gain_error,
        f.shift.x, f.shift.y, f.shift_error.x, f.shift_error.y, f.residual);
  }
  return text;
}

}  // namespace

void compare_lenses(const LightField& measured, const LightField& simulated,
                    const std::string& channel, const std::string& path,
                    const LensComparison& settings, Report& report) {
  if (!(measured.window == simulated.window) || measured.sensor_width != simulated.sensor_width ||
      measured.sensor_height != simulated.sensor_height)
    throw InputError("--by-lens: both light fields must have the same sensor and window");
  const CameraSpec spec = read_scene_of(simulated, path).scene.camera;
  check_raw_image(simulated, spec, path);
  const Image& a = find_channel(measured, channel).flux;
  const Image& b = find_channel(simulated, channel).flux;
  const MicroImages images(Camera(spec), false);
  const Registration found = register_pictures(a, b, simulated.window, images);
  const PictureFit& whole = found.whole;
  report.add("gain", fmt::format("{:.6g} +- {:.2g}", whole.gain, whole.gain_error), "gain",
             whole.gain);
  report.add_json("gain_error", whole.gain_error);
  report.add("registration",
             fmt::format("{:+.4f}, {:+.4f} pixel (+- {:.2g}, {:.2g}) right, down", whole.shift.x,
                         whole.shift.y, whole.shift_error.x, whole.shift_error.y),
             "shift_pixel", {whole.shift.x, whole.shift.y});
  report.add_json("shift_error_pixel", {whole.shift_error.x, whole.shift_error.y});
  report.add("left by that fit", fmt::format("{:.3g} % rms", 100 * whole.residual), "residual",
             whole.residual);
  report.add("micro-images", std::to_string(found.lenses.size()), "lenses", found.lenses.size());
  report.add("shift of a micro-image", fmt::format("{:.4f} pixel (median)", found.median_shift),
             "median_shift_pixel", found.median_shift);
  const auto farthest = std::max_element(found.lenses.begin(), found.lenses.end(),
                                         [](const LensFit& one, const LensFit& other) {
                                           return length(one.fit.shift) < length(other.fit.shift);
                                         });
  if (farthest != found.lenses.end())
    report.add("largest",
               fmt::format("{:.4f} pixel at {:.1f},{:.1f}", length(farthest->fit.shift),
                           farthest->centre.x, farthest->centre.y),
               "largest_shift_pixel", length(farthest->fit.shift));
  if (!settings.csv.empty()) write_file(settings.csv, table_of(found));
  if (!settings.map.empty()) {
    const float brightest = *std::max_element(b.pixels.begin(), b.pixels.end());
    write_residual_map(settings.map, registration_residual(a, b, whole),
                       whole.gain * static_cast<double>(brightest));
  }
}

}  // namespace plenoflame::cli
