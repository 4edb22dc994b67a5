/// Grids of micro-images: PlenopticToolbox2.0, PlenopticImageProcessing, plenopticam, lists of
/// centres.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <pugixml.hpp>

#include "camera/import/found_camera.h"

namespace plenoflame {
namespace {

using GridJson = nlohmann::json;
constexpr double kXmlMillimetre = 1e-3;

pugi::xml_document read_xml(const CalibrationFile& file) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(file.text.data(), file.text.size());
  if (!result) {
    const auto end = file.text.begin() + result.offset;
    const auto line = 1 + std::count(file.text.begin(), end, '\n');
    throw InputError(SourcePosition{file.path, static_cast<int>(line)},
                     std::string("it is no XML: ") + result.description());
  }
  return document;
}

double plain_number(const CalibrationFile& file, std::string_view text, const std::string& name) {
  const auto first = text.find_first_not_of(" \t\r\n");
  const auto last = text.find_last_not_of(" \t\r\n");
  double value = 0;
  if (first != std::string_view::npos) {
    text = text.substr(first, last - first + 1);
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size() && std::isfinite(value))
      return value;
  }
  refuse_calibration(file, name + " is no number");
}

double xml_number(const CalibrationFile& file, pugi::xml_node parent, const char* name) {
  const pugi::xml_node node = parent.child(name);
  if (!node) refuse_calibration(file, std::string("lacks <") + name + ">");
  return plain_number(file, node.child_value(), std::string("<") + name + ">");
}

std::vector<double> xml_numbers(const CalibrationFile& file, pugi::xml_node parent,
                                const char* name) {
  const pugi::xml_node node = parent.child(name);
  if (!node) refuse_calibration(file, std::string("lacks <") + name + ">");
  std::vector<double> numbers;
  const std::string text = node.child_value();
  std::size_t at = 0;
  while ((at = text.find_first_not_of(" \t\r\n", at)) != std::string::npos) {
    const std::size_t end = std::min(text.find_first_of(" \t\r\n", at), text.size());
    numbers.push_back(
        plain_number(file, std::string_view(text).substr(at, end - at), std::string("<") + name));
    at = end;
  }
  if (numbers.size() < 2)
    refuse_calibration(file, std::string("<") + name + "> has not two numbers");
  return numbers;
}

}  // namespace

bool is_plenoptic_toolbox(const CalibrationFile& file) {
  return file.text.find("<RayCalibData") != std::string::npos;
}

/// Units: pixels from the middle of the picture, y upwards, angles counter-clockwise.
void read_plenoptic_toolbox(const CalibrationFile& file, FoundCamera& found) {
  const pugi::xml_document document = read_xml(file);
  const pugi::xml_node root = document.child("RayCalibData");
  if (!root) refuse_calibration(file, "lacks <RayCalibData>");
  FoundGrid grid;
  const pugi::xml_node offset = root.child("offset");
  grid.origin = {xml_number(file, offset, "x"), -xml_number(file, offset, "y")};
  const double pitch = xml_number(file, root, "diameter");
  if (!(pitch > 1)) refuse_calibration(file, "<diameter> is not above one pixel");
  grid.pitch = {pitch, pitch};
  grid.rotation = -xml_number(file, root, "rotation");
  // The file describes its picture, whose middle is the middle of the sensor.
  const SensorSpec& sensor = found.camera.sensor;
  grid.origin = grid.origin + Vec2{0.5 * sensor.columns, 0.5 * sensor.rows};
  grid.types = 0;
  bool alike = true;
  std::string first_range;
  for (const pugi::xml_node type : root.children("lens_type")) {
    const pugi::xml_node range = type.child("depth_range");
    const std::string text =
        std::string(range.child_value("min")) + " to " + range.child_value("max");
    if (grid.types == 0) first_range = text;
    alike = alike && text == first_range;
    ++grid.types;
  }
  if (grid.types == 0 || alike) grid.types = 1;
  if (grid.types > 3) refuse_calibration(file, "has more than three <lens_type>");
  if (grid.types == 3)
    found.note(
        "the file numbers types of microlenses and gives their depth ranges, not their focal "
        "lengths; camera.array.types[i] is its lens_type i");
  const pugi::xml_node distortion = root.child("distortion");
  const std::string function = distortion.child_value("function");
  if (!function.empty() && function != "none")
    found.note("<distortion> is left out: its function is not documented");
  if (!found.grid) found.grid = grid;
}

bool is_pip(const CalibrationFile& file) {
  return file.text.find("<MlaDescription") != std::string::npos;
}

void read_pip(const CalibrationFile& file, FoundCamera& found) {
  const pugi::xml_document document = read_xml(file);
  const pugi::xml_node node = document.child("opencv_storage").child("MlaDescription");
  if (!node) refuse_calibration(file, "lacks <MlaDescription> in <opencv_storage>");
  CameraSpec& camera = found.camera;
  const std::vector<double> size = xml_numbers(file, node, "SensorResPX");
  for (const double count : size)
    if (!(count >= 1 && count <= 65536)) refuse_calibration(file, "<SensorResPX> is no size");
  set_new(camera.sensor.columns, static_cast<int>(size[0]));
  set_new(camera.sensor.rows, static_cast<int>(size[1]));
  const double p = kXmlMillimetre * xml_number(file, node, "PixelsizeMM");
  const double scale = node.child("MlaImageScale") ? xml_number(file, node, "MlaImageScale") : 1;
  const double pitch = xml_number(file, node, "MicroLensDistancePX");
  const double gap = xml_number(file, node, "MicroLensFocalLengthPX");
  const double focal = xml_number(file, node, "MainLensFLengthMM");
  const double distance = xml_number(file, node, "MainLensFDistMM");
  if (!(p > 0 && scale > 0 && pitch > 1 && gap > 0 && focal > 0 && distance > 0))
    refuse_calibration(file, "a size or distance in <MlaDescription> is not above 0");
  set_new(camera.sensor.pixel_pitch, p);
  set_new(camera.array.sensor_distance, gap * p);
  set_new(camera.lens.focal_length, kXmlMillimetre * focal);
  set_new(camera.focus.lens_distance, kXmlMillimetre * distance);
  const std::vector<double> lens = xml_numbers(file, node, "MlaCenterPX");
  const std::vector<double> axis = xml_numbers(file, node, "MainPrincipalPointPX");
  const Vec2 principal{axis[0] + 0.5, axis[1] + 0.5};
  camera.lens.decentre = {(0.5 * camera.sensor.columns - principal.x) * p,
                          (0.5 * camera.sensor.rows - principal.y) * p};
  FoundGrid grid;
  const std::string kind = node.child_value("IsHexGrid");
  grid.hexagonal = kind.empty() || plain_number(file, kind, "<IsHexGrid>") != 0;
  // Lens centres are scaled about the principal point; this gives the centres of micro-images.
  grid.origin = principal + scale * (Vec2{lens[0] + 0.5, lens[1] + 0.5} - principal);
  grid.pitch = {scale * pitch, scale * pitch};
  grid.rotation = -xml_number(file, node, "GridRotRAD");
  const double expected = 1 + gap * p / (kXmlMillimetre * distance);
  if (std::fabs(scale - expected) > 2e-3 * (expected - 1) + 1e-6) {
    char text[200];
    std::snprintf(
        text, sizeof text,
        "MlaImageScale is %.6f, and %.6f follows from the distances: the grid that is seen "
        "was kept, and the array's pitch follows from it",
        scale, expected);
    found.note(text);
  }
  found.note("the file knows one type of microlens, and no aperture of the main lens");
  if (!found.grid) found.grid = grid;
}

/// Fits an affine map from the numbers to the places by least squares. In a hexagonal grid, odd
/// rows may be right or left of even ones.
FoundGrid fit_found_grid(const CalibrationFile& file, const std::vector<NumberedCentre>& centres,
                         bool hexagonal, FoundCamera& found) {
  if (centres.size() < 6) refuse_calibration(file, "has fewer than six centres of micro-images");
  double best = -1;
  FoundGrid grid;
  grid.hexagonal = hexagonal;
  for (const double shift : hexagonal ? std::vector<double>{0.5, -0.5} : std::vector<double>{0.0}) {
    Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
    const auto row_of = [&](const NumberedCentre& c) {
      return Eigen::Vector3d(1, c.column + (c.row % 2 != 0 ? shift : 0.0), c.row);
    };
    for (const NumberedCentre& c : centres) {
      const Eigen::Vector3d row = row_of(c);
      square += row * row.transpose();
      right += row * Eigen::RowVector2d(c.at.x, c.at.y);
    }
    const Eigen::FullPivLU<Eigen::Matrix3d> solver(square);
    if (!solver.isInvertible())
      refuse_calibration(file, "the centres do not spread over columns and rows");
    const Eigen::Matrix<double, 3, 2> fit = solver.solve(right);
    double misfit = 0;
    for (const NumberedCentre& c : centres)
      misfit += (fit.transpose() * row_of(c) - Eigen::Vector2d(c.at.x, c.at.y)).squaredNorm();
    if (best >= 0 && misfit >= best) continue;
    best = misfit;
    const Eigen::Vector2d along = fit.row(1).transpose(), across = fit.row(2).transpose();
    grid.rotation = std::atan2(along.y(), along.x());
    const double area = std::fabs(along.x() * across.y() - along.y() * across.x());
    // Distance of the rows: one pitch, in a hexagonal grid times the sine of 60 degrees.
    grid.pitch = {along.norm(), area / along.norm()};
    if (hexagonal) {
      const double pitch = std::sqrt(area / std::sqrt(0.75));
      grid.pitch = {pitch, pitch};
    }
    // The origin is the centre nearest to the middle, by the fit.
    Vec2 mean;
    for (const NumberedCentre& c : centres)
      mean = mean + (1.0 / static_cast<double>(centres.size())) * c.at;
    double least = kInfinity;
    for (const NumberedCentre& c : centres)
      if (length(c.at - mean) < least) {
        least = length(c.at - mean);
        const Eigen::Vector2d at = fit.transpose() * row_of(c);
        grid.origin = {at.x(), at.y()};
      }
  }
  char text[160];
  std::snprintf(text, sizeof text,
                "%zu centres of micro-images lie %.3f pixel rms from the regular grid that was "
                "fitted to them",
                centres.size(), std::sqrt(best / static_cast<double>(centres.size())));
  found.note(text);
  return grid;
}

bool is_plenopticam(const CalibrationFile& file) {
  return file.text.find("\"mic_list\"") != std::string::npos;
}

void read_plenopticam(const CalibrationFile& file, FoundCamera& found) {
  const GridJson json = read_json(file);
  if (!json.is_object() || !json.contains("mic_list") || !json["mic_list"].is_array())
    refuse_calibration(file, "lacks the list mic_list");
  const GridJson pattern = json.value("pat_type", GridJson("rec"));
  std::vector<NumberedCentre> centres;
  for (const GridJson& item : json["mic_list"]) {
    if (!item.is_array() || item.size() < 4)
      refuse_calibration(file,
                         "mic_list: a centre has four numbers, row, column and their indices");
    std::array<double, 4> v{};
    for (std::size_t i = 0; i < 4; ++i) v[i] = json_number(file, item[i], "mic_list");
    if (std::fabs(v[2]) > 1e6 || std::fabs(v[3]) > 1e6)
      refuse_calibration(file, "mic_list: an index is out of range");
    // The file has pixel centres at whole numbers.
    centres.push_back({static_cast<int>(std::lround(v[3])),
                       static_cast<int>(std::lround(v[2])),
                       {v[1] + 0.5, v[0] + 0.5}});
  }
  const FoundGrid grid = fit_found_grid(file, centres, pattern == "hex", found);
  found.note(
      "plenopticam gives centres alone: the camera is unfocused unless the focal lengths of "
      "the microlenses say otherwise");
  if (!found.grid) found.grid = grid;
}

bool is_lf_toolbox(const CalibrationFile& file) {
  return file.text.find("\"LensletGridModel\"") != std::string::npos;
}

/// Reads a hexagonal grid from the distance of its rows and the position of its first micro-image.
/// Pixels in the file count from 1.
void read_lf_toolbox(const CalibrationFile& file, FoundCamera& found) {
  const GridJson json = read_json(file);
  if (!json.is_object() || !json.contains("LensletGridModel") ||
      !json["LensletGridModel"].is_object())
    refuse_calibration(file, "lacks the values of LensletGridModel");
  const GridJson& model = json["LensletGridModel"];
  const auto value = [&](const char* key) {
    if (!model.contains(key))
      refuse_calibration(file, std::string("LensletGridModel lacks ") + key);
    return json_number(file, model[key], std::string("LensletGridModel: ") + key);
  };
  if (model.value("Orientation", GridJson("horz")) != "horz")
    refuse_calibration(file,
                       "LensletGridModel: Orientation is not horz; only rows that run across are "
                       "read");
  const double along = value("HSpacing"), across = value("VSpacing");
  if (!(along > 1 && across > 1))
    refuse_calibration(file, "LensletGridModel: a spacing is not above one pixel");
  FoundGrid grid;
  grid.rotation = value("Rot");
  grid.origin = {value("HOffset") - 0.5, value("VOffset") - 0.5};
  const double step = std::sqrt(0.75);
  grid.hexagonal = std::fabs(across / along - step) < std::fabs(across / along - 1);
  if (grid.hexagonal) {
    const double pitch = std::sqrt(along * across / step);
    grid.pitch = {pitch, pitch};
    if (std::fabs(across / along / step - 1) > 1e-4)
      found.note(
          "LensletGridModel: HSpacing and VSpacing are those of no regular hexagons; their "
          "mean was taken");
  } else {
    grid.pitch = {along, across};
  }
  if (!found.grid) found.grid = grid;
}

bool is_centre_list(const CalibrationFile& file) {
  return file.text.starts_with("k,l,u,v");
}

/// Reads centres of libpleno: columns and rows of the array, pixel centres at whole numbers.
void read_centre_list(const CalibrationFile& file, FoundCamera& found) {
  std::vector<NumberedCentre> centres;
  std::size_t begin = file.text.find('\n');
  int line = 1;
  while (begin != std::string::npos && begin + 1 < file.text.size()) {
    const std::size_t start = begin + 1;
    begin = file.text.find('\n', start);
    ++line;
    std::string_view text = std::string_view(file.text).substr(
        start, (begin == std::string::npos ? file.text.size() : begin) - start);
    if (text.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    std::array<double, 4> v{};
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t comma = std::min(text.find(','), text.size());
      v[i] = plain_number(file, text.substr(0, comma), "line " + std::to_string(line));
      text.remove_prefix(std::min(comma + 1, text.size()));
    }
    if (std::fabs(v[0]) > 1e6 || std::fabs(v[1]) > 1e6)
      refuse_calibration(file, "line " + std::to_string(line) + ": an index is out of range");
    centres.push_back({static_cast<int>(std::lround(v[0])),
                       static_cast<int>(std::lround(v[1])),
                       {v[2] + 0.5, v[3] + 0.5}});
  }
  const FoundGrid grid = fit_found_grid(file, centres, true, found);
  if (!found.grid) found.grid = grid;
}

}  // namespace plenoflame
