#include "plenoflame/scene/design_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "plenoflame/base/error.h"
#include "plenoflame/camera/window_design.h"
#include "plenoflame/math/readable.h"
#include "plenoflame/scene/channel_kinds.h"

namespace plenoflame {
namespace {

nlohmann::json range_json(const SharpRange& range) {
  return {range.near, range.focus, range.far};
}

/// True if this is the camera of the paper's Table 1: B, D and p decide the ratio of Table 2.
bool is_the_papers(const Camera& camera, const CameraDesign& d) {
  const auto near = [](double a, double b) { return std::fabs(a / b - 1) < 1e-6; };
  return d.types.size() == 3 && near(d.types[0].sensor_distance, 0.2534e-3) &&
         near(camera.spec().array.diameter, 0.1e-3) &&
         near(camera.spec().sensor.pixel_pitch, 10e-6);
}

}  // namespace

std::string length_text(double value) {
  return std::isfinite(value) ? readable(value + 0.0, Dimension::length) : std::string("infinity");
}

std::string array_range_text(double near, double far) {
  return length_text(near) + " to " + length_text(far) +
         (passes_infinity(near, far) ? " (through infinity)" : "");
}

namespace {

/// A distance in the scene; negative ones lie past infinity.
std::string object_text(double value) {
  return value < 0 ? "past infinity" : length_text(value);
}

/// A computed distance beyond this one stands for infinity: its digits are rounding.
constexpr double kFar = 1e6;  // [m]

std::string focus_text(double value) {
  return std::fabs(value) > kFar ? "infinity" : object_text(value);
}

/// Rounding leaves some 1e-14 pixels between an image and a pitch that are equal.
std::string overlap_text(double pixels) {
  if (std::fabs(pixels) < 1e-9) return "as wide as the pitch";
  return readable_number(std::fabs(pixels)) + (pixels > 0 ? " more" : " less") + " than the pitch";
}

std::string place_text(double behind, const std::string& vertex) {
  return length_text(std::fabs(behind)) + (behind < 0 ? " in front of " : " behind ") + vertex;
}

void add_main_lens(const CameraDesign& d, Report& report) {
  const FirstOrder& lens = d.lens;
  report.add("focal length", length_text(lens.focal_length), "focal_length_m", lens.focal_length);
  report.add("back focal distance", length_text(lens.back_focal_distance), "back_focal_distance_m",
             lens.back_focal_distance);
  report.add("entrance pupil",
             length_text(lens.entrance_pupil_diameter) + " wide, " +
                 place_text(lens.entrance_pupil, "the first vertex"),
             "entrance_pupil_m", {lens.entrance_pupil, lens.entrance_pupil_diameter});
  report.add("exit pupil",
             length_text(lens.exit_pupil_diameter) + " wide, " +
                 place_text(lens.exit_pupil, "the last vertex"),
             "exit_pupil_m", {lens.exit_pupil, lens.exit_pupil_diameter});
  report.add("in focus", "object at " + object_text(d.object_distance), "object_distance_m",
             d.object_distance);
  report.add("working f-number", readable_number(d.array_f_number), "f_number", d.array_f_number);
}

void add_types(const Camera& camera, const CameraDesign& d, Report& report) {
  const double pixel = camera.spec().sensor.pixel_pitch, pitch = camera.spec().array.pitch;
  nlohmann::json types = nlohmann::json::array();
  for (const TypeDesign& t : d.types) {
    const double overlap = (t.image_diameter - pitch) / pixel;
    report.add_text("type " + t.name, "focal length " + length_text(t.focal_length) + ", B " +
                                          length_text(t.sensor_distance) +
                                          (t.keplerian ? ", Keplerian" : ", Galilean"));
    report.add_text("  f-number", "B/D " + readable_number(t.f_number) + " against " +
                                      readable_number(d.array_f_number) + " of the main lens");
    report.add_text("  micro-image", readable_number(t.image_diameter / pixel) + " pixels wide, " +
                                         overlap_text(overlap));
    report.add_text(
        "  sharp at the array",
        array_range_text(t.array.near, t.array.far) + ", best " + focus_text(t.array.focus) +
            (std::fabs(t.array.focus) > kFar ? "" : ", v = " + readable_number(t.virtual_depth)));
    report.add_text("  sharp in the scene",
                    object_text(t.object.near) + " to " + object_text(t.object.far) +
                        (t.object_through_infinity ? " (through infinity)" : "") + ", best " +
                        focus_text(t.object.focus));
    report.add_text("  disparity", readable_number(t.disparity_rate) +
                                       " pixels between neighbouring lenses per metre of distance");
    types.push_back({{"name", t.name},
                     {"focal_length_m", t.focal_length},
                     {"sensor_distance_m", t.sensor_distance},
                     {"f_number", t.f_number},
                     {"image_diameter_m", t.image_diameter},
                     {"image_diameter_pixels", t.image_diameter / pixel},
                     {"overlap_pixels", overlap},
                     {"keplerian", t.keplerian},
                     {"virtual_depth", t.virtual_depth},
                     {"disparity_pixels_per_m", t.disparity_rate},
                     {"dioptric_width_1_m", t.dioptric_width},
                     {"array_m", range_json(t.array)},
                     {"object_m", range_json(t.object)},
                     {"array_through_infinity", passes_infinity(t.array.near, t.array.far)},
                     {"object_through_infinity", t.object_through_infinity}});
  }
  if (d.types.empty()) return;
  report.add_json("types", types);
  if (d.types.size() > 1)
    report.add(
        "all types together",
        readable_number(d.joint_ratio) + " times the depth of field of the first, in dioptres",
        "joint_ratio", d.joint_ratio);
  else
    report.add_json("joint_ratio", d.joint_ratio);
  if (d.covering_depth > 0)
    report.add("total covering", "from |v| = " + readable_number(d.covering_depth) + " on",
               "covering_depth", d.covering_depth);
}

void add_array(const Camera& camera, const CameraDesign& d, Report& report) {
  if (d.types.empty()) return;
  const auto lattice = [](const LatticeDesign& l) {
    return std::to_string(l.lenses) + " lenses, " + readable_percent(l.used_share) +
           " of the sensor used";
  };
  const double ratio = d.square.lenses > 0 ? double(d.hexagonal.lenses) / d.square.lenses : NAN;
  report.add("hexagonal array", lattice(d.hexagonal), "hexagonal",
             {{"lenses", d.hexagonal.lenses}, {"used_share", d.hexagonal.used_share}});
  report.add("square array", lattice(d.square), "square",
             {{"lenses", d.square.lenses}, {"used_share", d.square.used_share}});
  report.add("hexagonal over square",
             readable_number(ratio) + " times the lenses; 1.1547 for a large sensor",
             "hexagonal_over_square", ratio);
  const ViewDesign& v = d.views;
  report.add("views",
             readable_number(v.count) + ", " + readable_number(v.across) + " across, each of " +
                 readable_number(v.columns) + " x " + readable_number(v.rows) + " lenses",
             "views",
             {{"count", v.count},
              {"across", v.across},
              {"columns", v.columns},
              {"rows", v.rows},
              {"object_pixel_m", v.object_pixel},
              {"disparity_view_pixels_per_m", v.disparity_rate}});
  report.add_text("  pixel of a view", length_text(v.object_pixel) +
                                           " in the plane in focus; the outermost "
                                           "views shift by " +
                                           readable_number(v.disparity_rate) +
                                           " of them per metre");
  // Plenoptic 1.0: one type; 2.0: all of them.
  const TypeDesign& first = d.types.front();
  double near = first.array.near, lowest = 1 / first.array.far;
  for (const TypeDesign& type : d.types) {
    if (1 / type.array.near > 1 / near) near = type.array.near;
    lowest = std::min(lowest, 1 / type.array.far);
  }
  report.add_text("depth of field, one type",
                  first.name + ": " + array_range_text(first.array.near, first.array.far) + ", " +
                      readable_number(first.dioptric_width) + " 1/m");
  report.add_text("depth of field, all types",
                  array_range_text(near, 1 / lowest) + ", " +
                      readable_number(d.joint_ratio * first.dioptric_width) + " 1/m, ratio " +
                      readable_number(d.joint_ratio));
  nlohmann::json table = {{"single_m", {first.array.near, first.array.far}},
                          {"joint_m", {near, 1 / lowest}},
                          {"single_1_m", first.dioptric_width},
                          {"joint_1_m", d.joint_ratio * first.dioptric_width},
                          {"ratio", d.joint_ratio}};
  if (is_the_papers(camera, d)) {
    report.add_text(
        "  ratio in the paper",
        "Table 2 has 1.955, which does not follow from its own formulas: they give widths that "
        "join end to end, 3 in dioptres");
    table["printed_ratio"] = 1.955;
  }
  report.add_json("table_2", table);
}

void add_spots(const CameraDesign& d, Report& report) {
  nlohmann::json spots = nlohmann::json::array();
  for (const SpotDesign& spot : d.spots) {
    report.add_text("spot at " + length_text(spot.image_height),
                    "RMS radius " + length_text(spot.rms) + ", best " +
                        length_text(std::fabs(spot.shift)) +
                        (spot.shift < 0 ? " behind" : " in front of") + " the paraxial image");
    spots.push_back(
        {{"image_height_m", spot.image_height}, {"rms_m", spot.rms}, {"shift_m", spot.shift}});
  }
  report.add_json("spots", spots);
}

void add_resolution(const std::vector<ResolutionPoint>& curve, const CameraDesign& d,
                    Report& report) {
  if (curve.empty()) return;
  nlohmann::json points = nlohmann::json::array();
  const ResolutionPoint* best = nullptr;
  const ResolutionPoint* traced = nullptr;
  for (const ResolutionPoint& p : curve) {
    points.push_back({{"object_distance_m", p.object_distance},
                      {"array_distance_m", p.array_distance},
                      {"paraxial", p.paraxial},
                      {"traced", p.traced},
                      {"paraxial_joint", p.paraxial_joint},
                      {"traced_joint", p.traced_joint}});
    // Nearer to the array than the total covering plane not every point is seen.
    if (std::fabs(p.array_distance) < d.covering_depth * d.types.front().sensor_distance) continue;
    if (!best || p.paraxial_joint > best->paraxial_joint) best = &p;
    if (std::isfinite(p.traced_joint) && (!traced || p.traced_joint > traced->traced_joint))
      traced = &p;
  }
  report.add_json("resolution", points);
  const auto at = [](double ratio, const ResolutionPoint& p) {
    return readable_number(ratio) + " at " + length_text(p.object_distance);
  };
  if (best && traced)
    report.add_text("effective resolution", "at most " + at(best->paraxial_joint, *best) +
                                                "; by rays " + at(traced->traced_joint, *traced) +
                                                " (pixels kept along one axis, beyond "
                                                "the total covering plane)");
}

}  // namespace

std::vector<ResolutionPoint> design_curve(const Camera& camera, const Scene& scene) {
  constexpr int kCurvePoints = 61;
  return resolution_curve(camera, kCurvePoints, own_wavelength(scene.channels.front()));
}

void add_design(const Camera& camera, const CameraDesign& d,
                const std::vector<ResolutionPoint>& curve, Report& report) {
  add_main_lens(d, report);
  add_types(camera, d, report);
  add_array(camera, d, report);
  add_resolution(curve, d, report);
  add_spots(d, report);
}

void add_windows(const Camera& camera, const std::vector<WindowSpec>& windows, Report& report) {
  nlohmann::json list = nlohmann::json::array();
  const auto add = [&](const std::string& label, const std::vector<WindowSpec>& of) {
    const WindowDesign d = window_design(camera, WindowSet(of));
    if (!d.crossed) {
      report.add_text(label, "not between the lens and a point in focus on the axis");
      list.push_back({{"name", label}, {"crossed", false}});
      return;
    }
    // Less than a picometre is rounding.
    const auto length = [](double value) {
      return length_text(std::fabs(value) < 1e-12 ? 0 : value);
    };
    report.add_text(label, "moves the focus by " + length(d.shift_x) + " (camera x) and " +
                               length(d.shift_y) + " (y), astigmatism " + length(d.astigmatism()) +
                               ", aside by " + length(d.displacement) + ", takes " +
                               readable_number(100 * d.loss) + " % of the light");
    list.push_back({{"name", label},
                    {"crossed", true},
                    {"shift_x_m", d.shift_x},
                    {"shift_y_m", d.shift_y},
                    {"astigmatism_m", d.astigmatism()},
                    {"displacement_m", d.displacement},
                    {"loss", d.loss}});
  };
  for (std::size_t i = 0; i < windows.size(); ++i) add(window_name(windows, i), {windows[i]});
  if (windows.size() > 1) add("all windows", windows);
  report.add_json("windows", list);
}

}  // namespace plenoflame
