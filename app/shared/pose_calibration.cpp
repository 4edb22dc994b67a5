#include "pose_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "plenoflame/base/error.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/math/readable.h"
#include "white_calibration.h"

namespace plenoflame {
namespace {

/// The kind of RMS that all reports of calibrations have: root mean square of distances in x and y.
constexpr const char* kRmsOfBoth = "RMS of both coordinates together";

/// The rows of a request's table, in memory or of its file.
std::vector<NumberRow> rows_of(const GeometryRequest& request, const std::string& name,
                               const std::string& file, std::initializer_list<std::size_t> counts,
                               std::string_view what) {
  const auto found = request.tables.find(name);
  if (found != request.tables.end()) return found->second;
  return file.empty() ? std::vector<NumberRow>() : read_number_rows(file, counts, what);
}

std::vector<CornerObservation> corners_of(const GeometryRequest& request) {
  constexpr std::size_t kWithLens = 7, kWithBlur = 10;  // columns
  std::vector<CornerObservation> corners;
  for (const NumberRow& row :
       rows_of(request, "corners", request.corners, {5, kWithLens, kWithBlur},
               "a corner: pose,x,y,column,row[,q,r[,error,blur,blur_error]]; x, y in metres")) {
    const std::vector<double>& v = row.values;
    CornerObservation corner;
    corner.pose = row.whole(0);
    corner.board = {v[1], v[2]};
    corner.pixel = {v[3], v[4]};
    if (v.size() >= kWithLens) corner.lens = LensIndex{row.whole(5), row.whole(6)};
    if (v.size() == kWithBlur) {
      corner.blur = v[8];
      corner.blur_error = v[9];
      corner.error = v[7];
      if (corner.error < 0 || corner.blur_error < 0)
        throw InputError(row.at, "the errors of a place and of a blur are not below 0");
    }
    corners.push_back(corner);
  }
  return corners;
}

std::vector<CentreObservation> centres_of(const GeometryRequest& request) {
  // The table of calibrate white: i,j,q,r,type,column,row,..., and whether the fit used it.
  constexpr std::size_t kColumnsOfWhite = 13;
  std::vector<CentreObservation> centres;
  for (const NumberRow& row : rows_of(
           request, "centres", request.centres, {kColumnsOfWhite, 4},
           "a micro-image's centre: q,r,column,row, or a line of the table of a white picture")) {
    const std::vector<double>& v = row.values;
    if (v.size() == 4)
      centres.push_back({{row.whole(0), row.whole(1)}, {v[2], v[3]}});
    else if (v[12] > 0)
      centres.push_back({{row.whole(2), row.whole(3)}, {v[5], v[6]}});
  }
  return centres;
}

std::vector<RadiusObservation> radii_of(const GeometryRequest& request, std::size_t types) {
  std::vector<RadiusObservation> radii;
  for (const NumberRow& row : rows_of(request, "radii", request.radii, {4},
                                      "a micro-image's radius: type,f_number,radius,error")) {
    const int type = row.whole(0);
    if (type < 0 || static_cast<std::size_t>(type) >= types)
      throw InputError(row.at,
                       fmt::format("type {}: the camera's types are 0 to {}", type, types - 1));
    RadiusObservation radius;
    radius.type = static_cast<std::size_t>(type);
    radius.f_number = row.values[1];
    radius.radius = row.values[2];
    radius.error = row.values[3];
    if (!(radius.f_number > 0 && radius.radius > 0 && radius.error >= 0))
      throw InputError(row.at, "f-number and radius are above 0, the error is not below 0");
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
void warn_of_outwards(const GeometryCalibration& found, const Execution& execution) {
  constexpr double kMost = 0.01;
  if (found.outwards_scatter < kMost) return;
  std::string types;
  for (const double part : found.outwards)
    types += fmt::format("{}{:+.1f} %", types.empty() ? "" : ", ", 100 * part);
  execution.warn(fmt::format(
      "the fit leaves corners outwards in their micro-images by {:.1f} % of their distance from "
      "the middle ({} by type of microlens). Distances err alike, and their errors include it; "
      "corners are found better in sharp micro-images (a board farther from the plane in focus)",
      100 * found.outwards_scatter, types));
}

/// Warns of residuals that the corners' own errors do not explain.
void warn_of_residuals(const FoundGeometry& found, const Execution& execution) {
  constexpr double kMost = 3;  // times
  double squares = 0, count = 0;
  for (std::size_t i = 0; i < found.corners.size(); ++i) {
    if (!(found.corners[i].error > 0 && std::isfinite(found.fit.residuals[i].x))) continue;
    squares += 2 * found.corners[i].error * found.corners[i].error;
    count += 1;
  }
  if (count == 0) return;
  const double stated = std::sqrt(squares / count);
  if (found.fit.corner_rms < kMost * stated) return;
  execution.warn(
      fmt::format("the fit leaves {:.3f} pixels {} of the corners, whose own errors are {:.3f}: "
                  "distortion may be missing, or the board's points lie elsewhere",
                  found.fit.corner_rms, kRmsOfBoth, stated));
}

/// Warns where radii and corners contradict each other.
void warn_of_radii(const RadiiMatch& radii, const Execution& execution) {
  constexpr double kMost = 2;  // standard deviations
  if (std::fabs(radii.conflict) < kMost) return;
  execution.warn(
      fmt::format("the corners alone predict radii of micro-images that differ by {:+.1f} % from "
                  "the observed ones, {:.1f} standard deviations: the corners lie {} in their "
                  "micro-images, or the f-numbers are not those of the pictures",
                  100 * radii.conflict * radii.relative_error, std::fabs(radii.conflict),
                  radii.conflict > 0 ? "outwards" : "inwards"));
}

/// Warns where blur and the nominal focal lengths of microlenses contradict each other.
void warn_of_blur(const BlurMatch& blur, const GeometryRequest& request,
                  const Execution& execution) {
  constexpr double kMost = 2;  // standard deviations
  if (std::fabs(blur.change) < kMost * blur.change_error) return;
  execution.warn(
      fmt::format("by places and blur of the corners, focal lengths of microlenses differ by "
                  "{:+.1f} % from those to start with, {:.1f} standard deviations: the corners "
                  "lie {} in their micro-images, or {} is too small",
                  100 * blur.change, std::fabs(blur.change) / blur.change_error,
                  blur.change > 0 ? "outwards" : "inwards", request.names("microlens-error")));
}

/// The largest distance of the board's points from their nominal places [m].
double most_aside(const GeometryCalibration& found) {
  double most = 0;
  for (const BoardPoint& point : found.board) most = std::max(most, length(point.offset));
  return most;
}

/// Warns of a focal length that the lens' name does not have.
void warn_of_focal_length(double nominal, double found, const std::string& free,
                          const Execution& execution) {
  constexpr double kMost = 0.05;  // lenses are within 2 % of their names
  const double change = found / nominal - 1;
  if (std::fabs(change) < kMost) return;
  execution.warn(
      fmt::format("the focal length is {:.4g} mm, {:+.1f} % from the {:.4g} mm to start with: "
                  "lenses differ from their names by 2 %. Search for the other values alone "
                  "({}), or give boards that are tilted more",
                  1e3 * found, 100 * change, 1e3 * nominal, free));
}

/// The residual of each corner.
std::string residual_table(const GeometryCalibration& found,
                           const std::vector<CornerObservation>& corners) {
  std::string text = "pose,x,y,column,row,residual_column,residual_row\n";
  for (std::size_t i = 0; i < corners.size(); ++i)
    text += fmt::format("{},{:.9g},{:.9g},{:.4f},{:.4f},{:.4f},{:.4f}\n", corners[i].pose,
                        corners[i].board.x, corners[i].board.y, corners[i].pixel.x,
                        corners[i].pixel.y, found.residuals[i].x, found.residuals[i].y);
  return text;
}

Report report_of(const GeometryCalibration& fit) {
  Report report;
  report.add("poses", std::to_string(fit.poses.size()), "poses", fit.poses.size());
  report.add("corners",
             std::to_string(fit.corners) +
                 (fit.left_out ? ", " + std::to_string(fit.left_out) + " left out" : ""),
             "corners", fit.corners);
  report.add_json("left_out", fit.left_out);
  report.add("left by the fit", fmt::format("{:.4f} pixels {}", fit.corner_rms, kRmsOfBoth),
             "corner_rms_pixel", fit.corner_rms);
  if (fit.centres > 0)
    report.add("micro-image centres",
               fmt::format("{}, {:.4f} pixels {}", fit.centres, fit.centre_rms, kRmsOfBoth),
               "centre_rms_pixel", fit.centre_rms);
  if (const std::optional<RadiiMatch>& radii = fit.radii) {
    report.add("radii times f-number",
               fmt::format("{:.4g} +- {:.2g} pixels, by the camera {:.4g}", radii->observed,
                           radii->observed * radii->relative_error, radii->predicted),
               "radii_pixel", {radii->observed, radii->predicted});
    report.add_json("radii_error", radii->relative_error);
    report.add_json("radii_conflict", radii->conflict);
  }
  if (const std::optional<BlurMatch>& blur = fit.blur) {
    report.add(
        "blur of corners",
        fmt::format("{}, left by the fit: {:.2f} times their errors", blur->corners, blur->excess),
        "blur_corners", blur->corners);
    report.add_json("blur_excess", blur->excess);
    report.add_json("microlens_change", blur->change);
  }
  if (!fit.board.empty())
    report.add("the board",
               fmt::format("points up to {} from their nominal places",
                           readable(most_aside(fit), Dimension::length)),
               "board_m", most_aside(fit));
  nlohmann::json values;
  for (const CalibratedValue& value : fit.values) {
    report.add_text(value.key.substr(7), value_text(value));
    values[value.key] = {{"value", value.value}, {"error", value.error}};
  }
  report.add_json("values", values);
  report.add_json("covariance", fit.covariance);
  report.add_json("outwards", fit.outwards);
  report.add_json("outwards_scatter", fit.outwards_scatter);
  report.add_text("most alike", most_correlated(fit));
  nlohmann::json distances;
  for (const BoardPose& pose : fit.poses)
    distances.push_back({{"pose", pose.pose},
                         {"distance_m", pose.to_camera.translation.z},
                         {"error_m", pose.distance_error}});
  report.add_json("boards", distances);
  const double distance = mean_distance(fit);
  if (const double shift = aside(fit, distance); shift > 0) {
    report.add_text(
        "the camera's axis",
        fmt::format("known to {} at {}, by the decentre's deviation",
                    readable(shift, Dimension::length), readable(distance, Dimension::length)));
    report.add_json("axis_error_m", shift);
    report.add_json("boards_distance_m", distance);
  }
  return report;
}

void warn_of_fit(const GeometryCalibration& fit, const SceneDocument& start,
                 const GeometryRequest& request, const Execution& execution) {
  for (const CalibratedValue& value : fit.values)
    if (value.key.find("array.tilt") != std::string::npos)
      warn_of_tilt(value.key, value.value, value.error, execution);
  warn_of_outwards(fit, execution);
  if (fit.radii) warn_of_radii(*fit.radii, execution);
  if (fit.blur) warn_of_blur(*fit.blur, request, execution);
  warn_of_focal_length(start.scene.camera.lens.focal_length, fit.camera.lens.focal_length,
                       request.names("free"), execution);
  if (const std::string names = hardly_known(fit); !names.empty())
    execution.warn("these poses hardly tell " + names +
                   ": give more poses at other distances and angles, or search for fewer values (" +
                   request.names("free") + ")");
}

}  // namespace

template <>
std::span<const SettingRow<GeometryRequest>> setting_rows() {
  using R = GeometryRequest;
  using enum SettingKind;
  static const std::vector<SettingRow<R>> rows{
      {"centres", "FILE.csv",
       "Centres in white pictures, from calibrate white or as q,r,column,row; also finds place and "
       "tilt of the array",
       &R::centres, file},
      {"radii", "FILE.csv",
       "Radii from calibrate white; they tell the distance from array to sensor", &R::radii, file},
      {"f-number-error", "SHARE",
       "Relative standard deviation common to the f-numbers of the radii", &R::f_number,
       between(0, 1)},
      {"microlens-error", "SHARE",
       "Relative standard deviation common to the focal lengths of microlenses, for blur",
       &R::microlens, between(1e-4, 10)},
      {"free", "KEY,...",
       "Keys that are fitted in place of the usual, such as "
       "camera.lens.focal_length,camera.lens.decentre; `usual,camera.lens.distortion` adds "
       "distortion",
       &R::free},
      {"pupil", "SHARE",
       "Standard deviation of the lens' distance from the array over the exit pupil's; 0: the stop "
       "is at a thin lens",
       &R::pupil, between(0, 1)}};
  return rows;
}

FoundGeometry calibrate_geometry(const GeometryRequest& request, const SceneDocument& start,
                                 const Execution& execution) {
  FoundGeometry found;
  found.corners = corners_of(request);
  GeometrySettings settings;
  std::istringstream keys(request.free);
  for (std::string key; std::getline(keys, key, ',');) settings.free.push_back(key);
  settings.pupil = request.pupil;
  settings.f_number = request.f_number;
  settings.microlens = request.microlens;
  settings.radii = radii_of(request, start.scene.camera.array.types.size());
  found.fit = calibrate_geometry(start.scene.camera, found.corners, centres_of(request), settings,
                                 execution);
  found.poses = pose_table(found.fit);
  found.residuals = residual_table(found.fit, found.corners);
  found.report = report_of(found.fit);
  warn_of_residuals(found, execution);
  warn_of_fit(found.fit, start, request, execution);
  return found;
}

}  // namespace plenoflame
