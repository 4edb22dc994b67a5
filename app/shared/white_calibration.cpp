#include "white_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "number_rows.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/calibration/array_fit.h"
#include "plenoflame/calibration/white_lattice.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame {
namespace {

constexpr double kLargestPixel = 0.01;  // [m]

/// A white picture at one f-number; 0: not stated.
struct Aperture {
  double f_number = 0;
  std::vector<std::string> files;
};

/// "4=white.tif": a picture at f/4. Sorted: the smallest stop first, where micro-images lie apart.
std::vector<Aperture> apertures_of(const std::vector<std::string>& white) {
  std::map<double, Aperture, std::greater<>> apertures;
  for (const std::string& text : white) {
    const std::size_t sign = text.find('=');
    double f_number = 0;
    std::string file = text;
    if (sign != std::string::npos) {
      char* end = nullptr;
      const std::string number = text.substr(0, sign);
      const double value = std::strtod(number.c_str(), &end);
      if (!number.empty() && *end == '\0') {
        if (!(value > 0.1 && value < 1000))
          throw UsageError("WHITE: '" + text + "': an f-number from 0.1 to 1000");
        f_number = value;
        file = text.substr(sign + 1);
      }
    }
    apertures[f_number].f_number = f_number;
    apertures[f_number].files.push_back(file);
  }
  if (apertures.size() > 1 && apertures.count(0) != 0)
    throw UsageError(
        "WHITE: of several apertures each file has its f-number "
        "in front (4=FILE)");
  std::vector<Aperture> list;
  for (auto& [number, aperture] : apertures) list.push_back(std::move(aperture));
  return list;
}

std::string centres_csv(const WhiteLattice& lattice, const ArrayFit& fit) {
  std::string text = "i,j,q,r,type,column,row,model_column,model_row,radius,blur,rms,used\n";
  for (const MicroImageFit& image : lattice.images) {
    const LensIndex lens = lens_of(fit, image.i, image.j);
    text += fmt::format("{},{},{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{}\n",
                        image.i, image.j, lens.q, lens.r, image.type, image.centre.x,
                        image.centre.y, image.model.x, image.model.y, image.radius, image.blur,
                        image.rms, image.good ? 1 : 0);
  }
  return text;
}

std::string array_text(const ArraySpec& array, Vec2 pixel, const CountFrames& frames) {
  const auto length_of = [](double value) { return format_quantity(value, Dimension::length); };
  std::string text =
      "# Found in a white picture by plenoflame calibrate "
      "white, without a camera: microlenses "
      "are\n"
      "# taken to lie above their micro-images (a camera knows "
      "better).\n[camera.array]\n";
  text += fmt::format("lattice = \"{}\"\npitch = \"{}\"\n",
                      array.lattice == Lattice::hexagonal ? "hexagonal" : "square",
                      length_of(array.pitch));
  if (array.pitch_y > 0) text += fmt::format("pitch_y = \"{}\"\n", length_of(array.pitch_y));
  text += fmt::format("rotation = \"{}\"\noffset = [\"{}\", \"{}\"]\n",
                      format_quantity(array.rotation, Dimension::angle), length_of(array.offset.x),
                      length_of(array.offset.y));
  text += fmt::format("\n[camera.sensor]\ncolumns = {}\nrows = {}\npixel_pitch = \"{}\"\n",
                      frames.width, frames.height, length_of(pixel.x));
  return text;
}

class WhiteRun {
 public:
  WhiteRun(const WhiteRequest& arguments, const SceneDocument* camera, const Execution& execution)
      : arguments_(arguments), execution_(execution), camera_(camera) {}

  WhiteCalibration run(const WhiteSeen& seen) {
    if (!arguments_.pixel_pitch.empty()) {
      const std::string name = arguments_.files.names("pixel-pitch");
      pixel_ = quantity_option(name, arguments_.pixel_pitch, Dimension::length);
      if (!(pixel_ > 0 && pixel_ <= kLargestPixel))
        throw UsageError(name + ": above 0, at most 1 cm, not '" + arguments_.pixel_pitch + "'");
    }
    const std::vector<Aperture> apertures = apertures_of(arguments_.white);
    if (arguments_.white.size() == 1 && arguments_.white[0].ends_with(".csv")) return run_centres();
    std::optional<CountFrames> dark;
    constexpr double kNever = 1e9;
    if (!arguments_.dark.empty())
      dark = read_frames(arguments_.dark, arguments_.files, execution_, kNever);
    frames_ = frames_of(apertures[0]);
    const Image white = light_of(frames_, dark, mosaic());
    try {
      lattice_ = measure_white(white, execution_);
    } catch (const InputError& error) {
      throw InputError("'" + apertures[0].files[0] + "': " + error.what() +
                       (seen ? seen(white) : ""));
    }
    for (std::size_t a = 0; a < apertures.size(); ++a)
      looks_.push_back(a == 0 ? lattice_.types
                              : looks_at(light_of(frames_of(apertures[a]), dark, mosaic()),
                                         lattice_, execution_));
    check_apertures(apertures);
    if (2 * lattice_.good < lattice_.images.size())
      execution_.warn(
          fmt::format("only {} of {} micro-images take part in the model: is '{}' a white "
                      "picture, "
                      "evenly lit and not overexposed? The picture shows which ones",
                      lattice_.good, lattice_.images.size(), apertures[0].files[0]));
    if (!warn_of_overlap(apertures[0].files[0])) warn_of_stop(apertures[0]);
    fit_camera();
    return result(white, apertures);
  }

 private:
  /// Centres that another program found.
  WhiteCalibration run_centres() {
    const std::string& file = arguments_.white[0];
    const RawLayout layout = arguments_.files.layout();
    frames_.width = layout.width > 0 ? layout.width : sensor().columns;
    frames_.height = layout.width > 0 ? layout.height : sensor().rows;
    if (layout.width == 0 && !camera_)
      throw UsageError(arguments_.files.names("size") +
                       ": centres do not tell how large the picture is; give "
                       "it, or the camera");
    std::vector<Vec2> centres;
    // libpleno's table has column and row of the lens first, and pixels centred on whole numbers.
    if (read_file(file).starts_with("k,l,u,v")) {
      for (const NumberRow& row : read_number_rows(file, {4}, "a centre: k,l,u,v"))
        centres.push_back({row.values[2] + 0.5, row.values[3] + 0.5});
    } else {
      for (const NumberRow& row : read_number_rows(file, {2}, "a centre: column,row in pixels"))
        centres.push_back({row.values[0], row.values[1]});
    }
    try {
      lattice_ = lattice_of_centres(centres, frames_.width, frames_.height);
    } catch (const InputError& error) {
      throw InputError("'" + file + "': " + error.what());
    }
    fit_camera();
    return result(Image(), {{0, {file}}});
  }

  /// Warns of a stop that the radii contradict. Squares of radii are those of the stop's image and
  /// of the microlens' blur.
  void warn_of_stop(const Aperture& aperture) const {
    constexpr double kMost = 0.2;  // nominal distances of sensors are known better
    if (!camera_ || camera_->scene.camera.lens.model != LensModel::ideal) return;
    const CameraSpec& spec = camera_->scene.camera;
    const Camera camera(spec);
    const double b = spec.array.sensor_distance, pixel = spec.sensor.pixel_pitch,
                 shrink = b / camera.lens_distance(),
                 own = spec.lens.focal_length / spec.lens.diameter,
                 f_number = aperture.f_number > 0 ? aperture.f_number : own,
                 stop = 0.5 * shrink * spec.lens.focal_length / (f_number * pixel);
    double expected = kInfinity, seen = kInfinity;  // of the sharpest type
    for (const MicrolensSpec& type : spec.array.types) {
      const double blur = camera.aperture().radius() / pixel * (1 - b / type.focal_length + shrink);
      expected = std::min(expected, std::hypot(stop, blur));
    }
    for (const TypeLooks& type : lattice_.types) seen = std::min(seen, type.even_radius);
    if (std::fabs(seen / expected - 1) < kMost) return;
    execution_.warn(
        fmt::format("micro-images of '{}' have a radius of {:.2f} pixels, by the camera's f/{:.3g} "
                    "it is {:.2f}: was the stop another one, or is the sensor's distance wrong?",
                    aperture.files[0], seen, f_number, expected));
  }

  /// The light of neighbours moves centres alike over the sensor, which no scatter tells.
  /// @return whether micro-images overlap
  bool warn_of_overlap(const std::string& file) const {
    constexpr double kMostReach = 0.6;  // of the pitch; from half of it on they touch
    const double pitch = lattice_.guess.pitch();
    double reach = 0;
    for (const TypeLooks& type : lattice_.types) reach = std::max(reach, type.radius + type.blur);
    const bool overlap = reach > kMostReach * pitch;
    if (overlap)
      execution_.warn(
          fmt::format("micro-images of '{}' overlap: they reach {:.1f} pixels "
                      "far from their "
                      "middles, which are {:.1f} pixels apart; centres and "
                      "tilt may be further "
                      "from the truth than is stated: stop the lens down",
                      file, reach, pitch));
    return overlap;
  }

  CountFrames frames_of(const Aperture& aperture) const {
    const double full = camera_ ? full_of(arguments_.files, sensor()) : 0;
    CountFrames frames = read_frames(aperture.files, arguments_.files, execution_, full);
    warn_of_full(frames, aperture.files.front(), full, sensor(), execution_);
    return frames;
  }

  MosaicPattern mosaic() const {
    if (camera_) return sensor().mosaic;
    return arguments_.mosaic == "rggb"   ? MosaicPattern::rggb
           : arguments_.mosaic == "bggr" ? MosaicPattern::bggr
           : arguments_.mosaic == "grbg" ? MosaicPattern::grbg
           : arguments_.mosaic == "gbrg" ? MosaicPattern::gbrg
                                         : MosaicPattern::none;
  }

  void fit_camera() {
    if (!camera_) {
      const double pixel = pixel_ > 0 ? pixel_ : 1;
      fit_.array = plain_array(lattice_, {pixel, pixel}, frames_.width, frames_.height);
      return;
    }
    fit_ = fit_array(camera_->scene.camera, lattice_, frames_.width, frames_.height,
                     !arguments_.no_tilt);
    // Types are counted from that of lens (0, 0).
    const auto types = static_cast<int>(lattice_.types.size());
    if (types == 1) return;
    const int shift = ((fit_.origin_j - fit_.origin_i) % types + types) % types;
    for (MicroImageFit& image : lattice_.images) image.type = (image.type - shift + types) % types;
    for (std::vector<TypeLooks>& looks : looks_)
      std::rotate(looks.begin(), looks.begin() + shift, looks.end());
  }

  WhiteCalibration result(const Image& white, const std::vector<Aperture>& apertures) const {
    WhiteCalibration found;
    if (camera_) {
      Scene scene = camera_->scene;
      scene.camera.array = fit_.array;
      found.camera = write_scene(scene);
    } else if (pixel_ > 0) {
      found.camera = array_text(fit_.array, {pixel_, pixel_}, frames_);
    }
    found.centres = centres_csv(lattice_, fit_);
    if (apertures.size() > 1) found.radii = radii_csv(apertures);
    found.white = white;
    found.lattice = lattice_;
    print(apertures, found.report);
    return found;
  }

  /// Radii for calibrate geometry. A cell of overlapping micro-images holds light of several.
  std::string radii_csv(const std::vector<Aperture>& apertures) const {
    constexpr double kMostReach = 0.53;  // of the pitch; from half of it on they touch
    std::string text = "type,f_number,radius,error\n";
    for (std::size_t a = 0; a < looks_.size(); ++a) {
      double reach = 0;
      for (std::size_t t = 0; t < looks_[a].size(); ++t)
        reach = std::max(reach, whole_radius(a, t));
      if (reach > kMostReach * lattice_.guess.pitch()) {
        execution_.warn(
            fmt::format("micro-images of '{}' overlap: the table "
                        "does not contain their radii",
                        apertures[a].files.front()));
        continue;
      }
      for (std::size_t t = 0; t < looks_[a].size(); ++t)
        text += fmt::format("{},{:g},{:.5f},{:.5f}\n", t, apertures[a].f_number,
                            looks_[a][t].even_radius, looks_[a][t].even_error);
    }
    return text;
  }

  void print(const std::vector<Aperture>& apertures, Report& report) const {
    report.add("lattice", lattice_.guess.hexagonal ? "hexagonal" : "square", "lattice",
               lattice_.guess.hexagonal ? "hexagonal" : "square");
    report.add("micro-images",
               fmt::format("{}, of which {} take part in the model", lattice_.images.size(),
                           lattice_.good),
               "micro_images", lattice_.images.size());
    report.add_json("used", lattice_.good);
    report.add("pitch in the middle",
               lattice_.guess.hexagonal
                   ? fmt::format("{:.4f} pixels", 0.5 * (lattice_.pitch_i + lattice_.pitch_j))
                   : fmt::format("{:.4f} and {:.4f} pixels", lattice_.pitch_i, lattice_.pitch_j),
               "pitch_pixels", {lattice_.pitch_i, lattice_.pitch_j});
    report.add("rotation", fmt::format("{:.5f} deg", lattice_.rotation * 180 / std::numbers::pi),
               "rotation_rad", lattice_.rotation);
    report.add("centres from the model",
               fmt::format("{:.4f} pixels {}, {:.3f} the worst", lattice_.rms,
                           "RMS of both coordinates together", lattice_.worst),
               "rms_pixels", lattice_.rms);
    report.add_json("worst_pixels", lattice_.worst);
    report.add("distortion",
               fmt::format("{:.3g} s^2 + {:.3g} s^4, s = 1 in the corners", lattice_.model.k1,
                           lattice_.model.k2),
               "distortion", {lattice_.model.k1, lattice_.model.k2});
    print_types(report, apertures);
    if (camera_) print_camera(report);
  }

  /// Radius of the whole disc against 1/N.
  struct RadiusLine {
    double slope = 0, rest = 0;  ///< [pixel]
  };
  RadiusLine radius_line(const std::vector<Aperture>& apertures, std::size_t type) const {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (std::size_t a = 0; a < looks_.size(); ++a) {
      const double x = 1 / apertures[a].f_number, y = whole_radius(a, type);
      n += 1;
      sx += x;
      sy += y;
      sxx += x * x;
      sxy += x * y;
    }
    RadiusLine line;
    line.slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    line.rest = (sy - line.slope * sx) / n;
    return line;
  }
  double whole_radius(std::size_t aperture, std::size_t type) const {
    return looks_[aperture][type].radius + looks_[aperture][type].blur;
  }

  /// @throws InputError where radii contradict the f-numbers. A wider stop makes larger
  /// micro-images, and the radius at 1/N = 0 is a blur, which is not         below 0
  void check_apertures(const std::vector<Aperture>& apertures) const {
    constexpr double kBelowZero = 0.1;  // of the radius: discs that are blurred are fitted smaller
    for (std::size_t t = 0; t < lattice_.types.size() && looks_.size() > 1; ++t) {
      for (std::size_t a = 1; a < looks_.size(); ++a)
        if (!(whole_radius(a, t) > whole_radius(a - 1, t)))
          throw InputError(fmt::format(
              "micro-images have a radius of {:.2f} pixels at "
              "f/{:g} ('{}') and of {:.2f} at "
              "f/{:g} "
              "('{}'), where the stop is wider: are the f-numbers "
              "those of the files?",
              whole_radius(a - 1, t), apertures[a - 1].f_number, apertures[a - 1].files.front(),
              whole_radius(a, t), apertures[a].f_number, apertures[a].files.front()));
      const RadiusLine line = radius_line(apertures, t);
      if (line.rest < -kBelowZero * whole_radius(0, t))
        throw InputError(
            fmt::format("radii of micro-images grow faster than the stop, from {:.2f} "
                        "pixels at "
                        "f/{:g} to {:.2f} "
                        "at f/{:g}: are the f-numbers those of the files?",
                        whole_radius(0, t), apertures.front().f_number,
                        whole_radius(looks_.size() - 1, t), apertures.back().f_number));
    }
  }

  void print_types(Report& report, const std::vector<Aperture>& apertures) const {
    report.add("types", std::to_string(lattice_.types.size()), "types", lattice_.types.size());
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t a = 0; a < looks_.size(); ++a)
      for (std::size_t t = 0; t < looks_[a].size(); ++t) {
        const TypeLooks& looks = looks_[a][t];
        const std::string stop =
            apertures[a].f_number > 0 ? fmt::format(" at f/{:g}", apertures[a].f_number) : "";
        report.add_text(fmt::format("type {}{}", t + 1, stop),
                        fmt::format("radius {:.3f} +- {:.3f}, edge +- {:.3f} "
                                    "+- {:.3f} pixels, {} micro-images",
                                    looks.radius, looks.radius_error, looks.blur, looks.blur_error,
                                    looks.count));
        list.push_back({{"type", t + 1},
                        {"f_number", apertures[a].f_number},
                        {"radius_pixels", looks.radius},
                        {"radius_error_pixels", looks.radius_error},
                        {"blur_pixels", looks.blur},
                        {"blur_error_pixels", looks.blur_error},
                        {"count", looks.count}});
      }
    report.add_json("looks", list);
    if (looks_.size() < 2) return;
    // Radius of the whole disc against 1/N: the slope is the same for all, the radius at 1/N = 0 is
    // the type's own.
    nlohmann::json lines = nlohmann::json::array();
    for (std::size_t t = 0; t < lattice_.types.size(); ++t) {
      const RadiusLine line = radius_line(apertures, t);
      report.add_text(
          fmt::format("type {} against 1/N", t + 1),
          fmt::format("whole radius {:.3f} / N + {:.3f} pixels", line.slope, line.rest));
      lines.push_back({{"type", t + 1}, {"slope_pixels", line.slope}, {"rest_pixels", line.rest}});
    }
    report.add_json("radius_lines", lines);
  }

  void print_camera(Report& report) const {
    const ArraySpec& array = fit_.array;
    const Vec2 origin = lattice_.model.point(fit_.origin_i, fit_.origin_j);
    report.add("microlens 0, 0",
               fmt::format("its micro-image is at {:.2f}, {:.2f}{}", origin.x, origin.y,
                           fit_.same_origin ? "" : ", not that of the camera's file"),
               "origin_pixels", {origin.x, origin.y});
    report.add_json("same_origin", fit_.same_origin);
    report.add("pitch of the microlenses",
               fmt::format("{:.5f} +- {:.5f} um", 1e6 * array.pitch, 1e6 * fit_.pitch_error),
               "pitch_m", array.pitch);
    report.add_json("pitch_error_m", fit_.pitch_error);
    report.add(
        "offset",
        fmt::format("{:.3f}, {:.3f} +- {:.3f} um", 1e6 * array.offset.x, 1e6 * array.offset.y,
                    1e6 * std::max(fit_.offset_error.x, fit_.offset_error.y)),
        "offset_m", {array.offset.x, array.offset.y});
    report.add(
        "rotation of the array",
        fmt::format("{:.5f} +- {:.5f} mrad", 1e3 * array.rotation, 1e3 * fit_.rotation_error),
        "array_rotation_rad", array.rotation);
    report.add_json("rotation_error_rad", fit_.rotation_error);
    if (fit_.tilted) {
      report.add(
          "tilt",
          fmt::format("{:.3f}, {:.3f} +- {:.3f} mrad", 1e3 * array.tilt.x, 1e3 * array.tilt.y,
                      1e3 * std::max(fit_.tilt_error.x, fit_.tilt_error.y)),
          "tilt_rad", {array.tilt.x, array.tilt.y});
      report.add_json("tilt_error_rad", {fit_.tilt_error.x, fit_.tilt_error.y});
      warn_of_tilt("camera.array.tilt[0]", array.tilt.x, fit_.tilt_error.x, execution_);
      warn_of_tilt("camera.array.tilt[1]", array.tilt.y, fit_.tilt_error.y, execution_);
    }
    report.add("centres from the camera",
               fmt::format("{:.4f} pixels {}, {:.3f} the worst of {}", fit_.rms,
                           "RMS of both coordinates together", fit_.worst, fit_.used),
               "camera_rms_pixels", fit_.rms);
    if (array.types.size() != lattice_.types.size())
      execution_.warn(
          fmt::format("the camera has {} types of microlenses, {} "
                      "can be told apart in the white "
                      "picture: which is which is not known",
                      array.types.size(), lattice_.types.size()));
    else if (array.types.size() > 1)
      report.add(
          "types",
          fmt::format("named after the camera's, whose blur correlates by {:.3f}", fit_.type_match),
          "type_match", fit_.type_match);
    if (fit_.rms > std::max(0.1, 3 * lattice_.rms))
      execution_.warn(
          fmt::format("the camera's rays miss the micro-images by "
                      "{:.2f} pixels RMS, their own model "
                      "by {:.2f}: lens, focus or sensor of the "
                      "camera's file are not those of the picture",
                      fit_.rms, lattice_.rms));
  }

  SensorSpec sensor() const { return camera_ ? camera_->scene.camera.sensor : SensorSpec(); }

  const WhiteRequest& arguments_;
  const Execution& execution_;
  const SceneDocument* camera_;  ///< nullptr: it is not known
  CountFrames frames_;
  WhiteLattice lattice_;
  std::vector<std::vector<TypeLooks>> looks_;  ///< of each aperture
  ArrayFit fit_;
  double pixel_ = 0;  ///< [m] side of a pixel, as given
};

}  // namespace

void warn_of_tilt(const std::string& key, double tilt, double error, const Execution& execution) {
  constexpr double kErrors = 5,
                   kUsual = 5e-3;  // [rad] mounts of arrays are better
  if (!(std::fabs(tilt) > kUsual && std::fabs(tilt) > kErrors * error)) return;
  execution.warn(
      fmt::format("{} is {:.3g} +- {:.2g} mrad, more than arrays are mounted with: a main "
                  "lens that is shifted "
                  "or tilted, distortion, or micro-images that overlap may look like it",
                  key, 1e3 * tilt, 1e3 * error));
}

template <>
std::span<const SettingRow<WhiteRequest>> setting_rows() {
  using R = WhiteRequest;
  using enum SettingKind;
  static const std::vector<SettingRow<R>> rows{
      {"dark", "FILE ...", "Dark frames of the same exposure", &R::dark, file},
      {"pixel-pitch", "LENGTH", "Size of a pixel, without a camera", &R::pixel_pitch, lengths},
      {"mosaic", "PATTERN",
       "Colours of the first two pixels of the first two rows, without a camera: rggb, bggr, grbg "
       "or gbrg",
       &R::mosaic, any_of("rggb", "bggr", "grbg", "gbrg")},
      {"no-tilt", "", "Leaves the array's tilt as the camera's file has it", &R::no_tilt}};
  return rows;
}

WhiteCalibration calibrate_white(const WhiteRequest& request, const SceneDocument* camera,
                                 const Execution& execution, const WhiteSeen& seen) {
  return WhiteRun(request, camera, execution).run(seen);
}

}  // namespace plenoflame
