#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>

#include "commands/calibration/calibrate.h"
#include "commands/calibration/calibration_options.h"
#include "commands/scene_input.h"
#include "file_set.h"
#include "messages.h"
#include "number_rows.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/calibration/geometry_calibration.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/image/atomic_file.h"
#include "plot.h"
#include "report.h"
#include "run.h"
#include "white_calibration.h"

namespace plenoflame::cli {
namespace {

struct GeometryArguments : CalibrationArguments {
  std::string corners, output, centres, radii, residuals, plot, poses;
  std::vector<std::string> free;
  double pupil = GeometrySettings().pupil, f_number = GeometrySettings().f_number,
         microlens = GeometrySettings().microlens;
};

int whole_number(double value, const std::string& path, int line) {
  if (value != std::floor(value) || std::fabs(value) > 1e8)
    throw InputError(SourcePosition{path, line}, "a pose, q and r are whole numbers");
  return static_cast<int>(value);
}

/// The count of numbers in the first line that holds some.
std::size_t numbers_in(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    const auto first = line.find_first_not_of(" \t");
    if (first == std::string::npos || line[first] == '#' ||
        std::string_view("+-.0123456789").find(line[first]) == std::string_view::npos)
      continue;
    return 1 + static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
  }
  return 0;
}

std::vector<CornerObservation> read_corners(const std::string& path) {
  constexpr std::size_t kWithLens = 7, kWithBlur = 10;  // columns
  std::size_t count = numbers_in(path);
  if (count != kWithLens && count != kWithBlur) count = 5;
  std::vector<CornerObservation> corners;
  for (const NumberRow& row : read_number_rows(
           path, count,
           "a corner: pose,x,y,column,row[,q,r[,error,blur,blur_error]]; x, y in metres")) {
    CornerObservation corner;
    corner.pose = whole_number(row.values[0], path, row.line);
    corner.board = {row.values[1], row.values[2]};
    corner.pixel = {row.values[3], row.values[4]};
    if (count >= kWithLens)
      corner.lens = LensIndex{whole_number(row.values[5], path, row.line),
                              whole_number(row.values[6], path, row.line)};
    if (count == kWithBlur) {
      corner.blur = row.values[8];
      corner.blur_error = row.values[9];
      if (corner.blur_error < 0)
        throw InputError(SourcePosition{path, row.line}, "the error of a blur is not below 0");
    }
    corners.push_back(corner);
  }
  return corners;
}

std::vector<CentreObservation> read_lens_centres(const std::string& path) {
  std::vector<CentreObservation> centres;
  // The table of calibrate white: i,j,q,r,type,column,row,..., and whether the fit used it.
  constexpr std::size_t kColumnsOfWhite = 13;
  if (numbers_in(path) == kColumnsOfWhite) {
    for (const NumberRow& row :
         read_number_rows(path, kColumnsOfWhite, "a line of the table of calibrate white"))
      if (row.values[12] > 0)
        centres.push_back({{whole_number(row.values[2], path, row.line),
                            whole_number(row.values[3], path, row.line)},
                           {row.values[5], row.values[6]}});
    return centres;
  }
  for (const NumberRow& row : read_number_rows(path, 4, "a micro-image's centre: q,r,column,row"))
    centres.push_back(
        {{whole_number(row.values[0], path, row.line), whole_number(row.values[1], path, row.line)},
         {row.values[2], row.values[3]}});
  return centres;
}

/// The table of calibrate white --radii.
std::vector<RadiusObservation> read_radii(const std::string& path, std::size_t types) {
  std::vector<RadiusObservation> radii;
  for (const NumberRow& row :
       read_number_rows(path, 4, "a micro-image's radius: type,f_number,radius,error")) {
    RadiusObservation radius;
    const int type = whole_number(row.values[0], path, row.line);
    radius.f_number = row.values[1];
    radius.radius = row.values[2];
    radius.error = row.values[3];
    if (type < 0 || static_cast<std::size_t>(type) >= types)
      throw InputError(SourcePosition{path, row.line},
                       fmt::format("type {}: the camera's types are 0 to {}", type, types - 1));
    if (!(radius.f_number > 0 && radius.radius > 0 && radius.error >= 0))
      throw InputError(SourcePosition{path, row.line},
                       "f-number and radius are above 0, the error is not below 0");
    radius.type = static_cast<std::size_t>(type);
    radii.push_back(radius);
  }
  return radii;
}

std::string value_text(const CalibratedValue& value) {
  const bool length = value.key.find("distance") != std::string::npos ||
                      value.key.find("length") != std::string::npos ||
                      value.key.find("decentre") != std::string::npos ||
                      value.key.find("offset") != std::string::npos ||
                      value.key.find("pitch") != std::string::npos;
  const bool angle = value.key.find("tilt") != std::string::npos ||
                     value.key.find("rotation") != std::string::npos;
  const double unit = length || angle ? 1e3 : 1;
  return fmt::format("{:.7g} +- {:.2g}{}", unit * value.value, unit * value.error,
                     length  ? " mm"
                     : angle ? " mrad"
                             : "");
}

/// Board to camera as rotation about x, then y, then z, and translation.
std::string pose_table(const GeometryCalibration& found) {
  std::string text = "pose,rms_pixel,x,y,z,r00,r01,r02,r10,r11,r12,r20,r21,r22\n";
  for (const BoardPose& pose : found.poses) {
    const Vec3 t = pose.to_camera.translation;
    text += fmt::format("{},{:.4f},{:.9g},{:.9g},{:.9g}", pose.pose, pose.rms, t.x, t.y, t.z);
    for (const Vec3& row : pose.to_camera.rotation.rows)
      text += fmt::format(",{:.12g},{:.12g},{:.12g}", row.x, row.y, row.z);
    text += "\n";
  }
  return text;
}

/// The two values whose errors go together most.
std::string most_correlated(const GeometryCalibration& found) {
  std::string text = "none";
  double most = 0;
  for (std::size_t i = 0; i < found.values.size(); ++i)
    for (std::size_t k = i + 1; k < found.values.size(); ++k) {
      const double both = found.covariance[i][i] * found.covariance[k][k];
      const double correlation = both > 0 ? found.covariance[i][k] / std::sqrt(both) : 0;
      if (std::fabs(correlation) <= std::fabs(most)) continue;
      most = correlation;
      text = fmt::format("{} and {}, whose errors correlate by {:.4f}", found.values[i].key,
                         found.values[k].key, correlation);
    }
  return text;
}

/// Lateral shift of objects at z by the standard error of a fitted decentre. The decentre moves the
/// camera's axis and the world with it. 0: no decentre was fitted.
/// @param z [m] from the lens
double aside(const GeometryCalibration& found, double z) {
  double most = 0;
  for (const CalibratedValue& value : found.values)
    if (value.key.find("lens.decentre") != std::string::npos) most = std::max(most, value.error);
  return most * z / Camera(found.camera).lens_distance();
}

/// The boards' distance from the lens [m], their mean.
double mean_distance(const GeometryCalibration& found) {
  double sum = 0;
  for (const BoardPose& pose : found.poses) sum += pose.to_camera.translation.z;
  return sum / static_cast<double>(found.poses.size());
}

/// Names the values that the poses determine poorly. Limits of the error: a twentieth of lengths, a
/// hundredth of the lens' distance for a decentre, the value itself for distortion.
std::string hardly_known(const GeometryCalibration& found) {
  constexpr double kLength = 0.05, kDecentre = 0.01;
  const double lens_distance = Camera(found.camera).lens_distance();
  std::string names;
  for (const CalibratedValue& value : found.values) {
    const auto has = [&](const char* part) { return value.key.find(part) != std::string::npos; };
    double limit = std::numeric_limits<double>::infinity();
    if (has("lens.distortion"))
      limit = std::fabs(value.value);
    else if (has("decentre"))
      limit = kDecentre * lens_distance;
    else if (has("distance") || has("focal_length") || has("pitch"))
      limit = kLength * std::fabs(value.value);
    if (!(value.error > limit)) continue;
    if (!names.empty()) names += ", ";
    names += value.key;
  }
  return names;
}

/// Warns where corners lie outwards in their micro-images by more than noise explains.
void warn_of_outwards(const GeometryCalibration& found) {
  constexpr double kMost = 0.01;
  if (found.outwards_scatter < kMost) return;
  std::string types;
  for (const double part : found.outwards)
    types += fmt::format("{}{:+.1f} %", types.empty() ? "" : ", ", 100 * part);
  warn(fmt::format(
      "the fit leaves corners outwards in their micro-images by {:.1f} % of their distance from "
      "the middle ({} by type of microlens). Distances err alike, and their errors include it; "
      "corners are found better in sharp micro-images (a board farther from the plane in focus)",
      100 * found.outwards_scatter, types));
}

/// Warns where radii and corners contradict each other.
void warn_of_radii(const RadiiMatch& radii) {
  constexpr double kMost = 2;  // standard deviations
  if (std::fabs(radii.conflict) < kMost) return;
  warn(
      fmt::format("the corners alone predict radii of micro-images that differ by {:+.1f} % from "
                  "the observed ones, {:.1f} standard deviations: the corners lie {} in their "
                  "micro-images, or the f-numbers are not those of the pictures",
                  100 * radii.conflict * radii.relative_error, std::fabs(radii.conflict),
                  radii.conflict > 0 ? "outwards" : "inwards"));
}

/// Warns where blur and the nominal focal lengths of microlenses contradict each other.
void warn_of_blur(const BlurMatch& blur, double deviation) {
  constexpr double kMost = 2;  // standard deviations
  if (std::fabs(blur.change) < kMost * deviation) return;
  warn(
      fmt::format("by places and blur of the corners, focal lengths of microlenses differ by "
                  "{:+.1f} % from those to start with, {:.1f} standard deviations: the corners "
                  "lie {} in their micro-images, or --microlens-error is too small",
                  100 * blur.change, std::fabs(blur.change) / deviation,
                  blur.change > 0 ? "outwards" : "inwards"));
}

/// The largest distance of the board's points from their nominal places [m].
double most_aside(const GeometryCalibration& found) {
  double most = 0;
  for (const BoardPoint& point : found.board) most = std::max(most, length(point.offset));
  return most;
}

/// Warns of a focal length that the lens' name does not have.
void warn_of_focal_length(double nominal, double found) {
  constexpr double kMost = 0.05;  // lenses are within 2 % of their names
  const double change = found / nominal - 1;
  if (std::fabs(change) < kMost) return;
  warn(
      fmt::format("the focal length is {:.4g} mm, {:+.1f} % from the {:.4g} mm to start with: "
                  "lenses differ from their names by 2 %. Search for the other values alone "
                  "(--free), or give boards that are tilted more",
                  1e3 * found, 100 * change, 1e3 * nominal));
}

/// The residuals: of each corner, and outwards against the distance from the middle, in which
/// distortion would show.
std::vector<Plot> residual_plots(const GeometryCalibration& found,
                                 const std::vector<CornerObservation>& corners) {
  Plot scatter, field;
  scatter.title = "What the fit leaves of each corner";
  scatter.x_label = "right [pixel]";
  scatter.y_label = "down [pixel]";
  scatter.equal_scales = true;
  field.title = "Outwards, over the picture";
  field.x_label = "from the middle of the picture [pixel]";
  field.y_label = "outwards [pixel]";
  const SensorSpec& sensor = found.camera.sensor;
  const Vec2 middle{0.5 * sensor.columns, 0.5 * sensor.rows};
  PlotSeries series;
  series.name = "observed - predicted";
  series.colour = plot_colour(0);
  series.style = PlotStyle::marks;
  PlotSeries outwards = series;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 rest = found.residuals[i], away = corners[i].pixel - middle;
    if (!std::isfinite(rest.x)) continue;
    series.points.emplace_back(rest.x, rest.y);
    if (length(away) > 0)
      outwards.points.emplace_back(length(away), dot(rest, away) / length(away));
  }
  scatter.series.push_back(series);
  field.series.push_back(outwards);
  for (Plot* plot : {&scatter, &field}) plot->log_x = plot->log_y = false;
  return {scatter, field};
}

int run_geometry(const GeometryArguments& arguments, const Execution& execution) {
  check_ending("-o", arguments.output, {".toml"});
  const SceneDocument start = read_camera_scene(arguments.camera, arguments.set, arguments.which);
  const std::vector<CornerObservation> corners = read_corners(arguments.corners);
  std::vector<CentreObservation> centres;
  if (!arguments.centres.empty()) centres = read_lens_centres(arguments.centres);
  GeometrySettings settings;
  settings.free = arguments.free;
  settings.pupil = arguments.pupil;
  settings.f_number = arguments.f_number;
  settings.microlens = arguments.microlens;
  if (!arguments.radii.empty())
    settings.radii = read_radii(arguments.radii, start.scene.camera.array.types.size());
  const GeometryCalibration found =
      calibrate_geometry(start.scene.camera, corners, centres, settings, execution);
  Scene scene = start.scene;
  scene.camera = found.camera;

  Report report;
  report.add("camera", arguments.output, "camera", arguments.output);
  report.add("poses", std::to_string(found.poses.size()), "poses", found.poses.size());
  report.add("corners",
             std::to_string(found.corners) +
                 (found.left_out ? ", " + std::to_string(found.left_out) + " left out" : ""),
             "corners", found.corners);
  report.add_json("left_out", found.left_out);
  report.add("left by the fit", fmt::format("{:.4f} pixels {}", found.corner_rms, kRmsOfBoth),
             "corner_rms_pixel", found.corner_rms);
  if (!centres.empty())
    report.add("micro-image centres",
               fmt::format("{}, {:.4f} pixels {}", found.centres, found.centre_rms, kRmsOfBoth),
               "centre_rms_pixel", found.centre_rms);
  if (const std::optional<RadiiMatch>& radii = found.radii) {
    report.add("radii times f-number",
               fmt::format("{:.4g} +- {:.2g} pixels, by the camera {:.4g}", radii->observed,
                           radii->observed * radii->relative_error, radii->predicted),
               "radii_pixel", {radii->observed, radii->predicted});
    report.add_json("radii_error", radii->relative_error);
    report.add_json("radii_conflict", radii->conflict);
  }
  if (const std::optional<BlurMatch>& blur = found.blur) {
    report.add(
        "blur of corners",
        fmt::format("{}, left by the fit: {:.2f} times their errors", blur->corners, blur->excess),
        "blur_corners", blur->corners);
    report.add_json("blur_excess", blur->excess);
    report.add_json("microlens_change", blur->change);
  }
  if (!found.board.empty())
    report.add("the board",
               fmt::format("points up to {} from their nominal places",
                           readable(most_aside(found), Dimension::length)),
               "board_m", most_aside(found));
  nlohmann::json values;
  for (const CalibratedValue& value : found.values) {
    report.add_text(value.key.substr(7), value_text(value));
    values[value.key] = {{"value", value.value}, {"error", value.error}};
  }
  report.add_json("values", values);
  report.add_json("covariance", found.covariance);
  report.add_json("outwards", found.outwards);
  report.add_json("outwards_scatter", found.outwards_scatter);
  report.add_text("most alike", most_correlated(found));
  nlohmann::json distances;
  for (const BoardPose& pose : found.poses)
    distances.push_back({{"pose", pose.pose},
                         {"distance_m", pose.to_camera.translation.z},
                         {"error_m", pose.distance_error}});
  report.add_json("boards", distances);
  const double distance = mean_distance(found);
  if (const double shift = aside(found, distance); shift > 0) {
    report.add_text(
        "the camera's axis",
        fmt::format("known to {} at {}, by the decentre's deviation",
                    readable(shift, Dimension::length), readable(distance, Dimension::length)));
    report.add_json("axis_error_m", shift);
    report.add_json("boards_distance_m", distance);
  }

  for (const CalibratedValue& value : found.values)
    if (value.key.find("array.tilt") != std::string::npos)
      warn_of_tilt(value.key, value.value, value.error, execution);
  warn_of_outwards(found);
  if (found.radii) warn_of_radii(*found.radii);
  if (found.blur) warn_of_blur(*found.blur, arguments.microlens);
  warn_of_focal_length(start.scene.camera.lens.focal_length, found.camera.lens.focal_length);
  if (const std::string names = hardly_known(found); !names.empty())
    warn("these poses hardly tell " + names +
         ": give more poses at other distances and angles, or search for fewer values (--free)");

  FileSet files;
  files.write(arguments.output, [&](const std::string& name) { write_scene_file(name, scene); });
  if (!arguments.residuals.empty()) {
    std::string text = "pose,x,y,column,row,residual_column,residual_row\n";
    for (std::size_t i = 0; i < corners.size(); ++i)
      text += fmt::format("{},{:.9g},{:.9g},{:.4f},{:.4f},{:.4f},{:.4f}\n", corners[i].pose,
                          corners[i].board.x, corners[i].board.y, corners[i].pixel.x,
                          corners[i].pixel.y, found.residuals[i].x, found.residuals[i].y);
    files.write(arguments.residuals, [&](const std::string& name) { write_file(name, text); });
  }
  if (!arguments.poses.empty())
    files.write(arguments.poses,
                [&](const std::string& name) { write_file(name, pose_table(found)); });
  if (!arguments.plot.empty()) write_plot(arguments.plot, residual_plots(found, corners));
  files.commit();
  report.print(arguments.json);
  return kSuccess;
}

}  // namespace

void add_calibrate_geometry(CLI::App& calibrate, const Registry& registry) {
  auto a = std::make_shared<GeometryArguments>();
  CLI::App& command =
      *calibrate.add_subcommand("geometry",
                                "Distances, focal length and decentre from corners of a board that "
                                "was seen in several poses");
  command.footer(
      "Example:\n"
      "  plenoflame calibrate geometry corners.csv --camera camera.toml --centres centres.csv \\\n"
      "    -o calibrated.toml --plot residuals.png");
  command
      .add_option("CORNERS", a->corners,
                  "Table (.csv): pose,x,y,column,row[,q,r[,error,blur,blur_error]]; x, y on the "
                  "board [m], pixel (0, 0) at the picture's corner, q, r the microlens")
      ->required();
  add_camera_options(command, *a, "The camera to start with: nominal values will do");
  command.add_option("-o,--output", a->output, "The scene file with the camera that was found")
      ->check(written())
      ->required()
      ->option_text("FILE.toml");
  command
      .add_option("--centres", a->centres,
                  "Centres in white pictures, from calibrate white or as q,r,column,row; also "
                  "finds place and tilt of the array")
      ->option_text("FILE.csv");
  command
      .add_option("--radii", a->radii,
                  "Table of calibrate white --radii; it tells the distance from array to sensor")
      ->option_text("FILE.csv");
  command
      .add_option("--f-number-error", a->f_number,
                  "Relative standard deviation common to the f-numbers of --radii")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      .add_option(
          "--microlens-error", a->microlens,
          "Relative standard deviation common to the focal lengths of microlenses, for blur")
      ->check(CLI::Range(1e-4, 10.0))
      ->capture_default_str();
  command
      .add_option("--free", a->free,
                  "Keys that are fitted in place of the usual, such as "
                  "camera.lens.focal_length,camera.lens.decentre; `usual,camera.lens.distortion` "
                  "adds distortion")
      ->delimiter(',')
      ->option_text("KEY,...");
  command
      .add_option("--pupil", a->pupil,
                  "Standard deviation of the lens' distance from the array over the exit pupil's; "
                  "0: the stop is at a thin lens")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command.add_option("--residuals", a->residuals, "Table of what the fit leaves of each corner")
      ->check(written())
      ->option_text("FILE.csv");
  command.add_option("--poses", a->poses, "Table of the boards' places")
      ->check(written())
      ->option_text("FILE.csv");
  command.add_option("--plot", a->plot, "Picture of what the fit leaves")
      ->check(written())
      ->option_text("FILE.svg|png");
  finish_calibration(command, registry, a, CalibrationInput::tables,
                     [a](const Execution& execution) { return run_geometry(*a, execution); });
}

}  // namespace plenoflame::cli
