#include "board_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "options.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// A white picture with less than this share of its brightest light says nothing.
constexpr double kLeastWhite = 0.3;

BoardSpec board_of(const BoardRequest& request) {
  const SettingNames& names = request.files.names;
  const auto [columns, rows] = pair_option(names("board"), request.board, "COLUMNSxROWS", 'x');
  if (columns < 2 || rows < 2 || columns > 1000 || rows > 1000)
    throw UsageError(names("board") +
                     ": from 2x2 to 1000x1000 points; of a checkerboard, the corners "
                     "between its squares");
  const double cell = quantity_option(names("cell"), request.cell, Dimension::length);
  if (!(cell > 0)) throw UsageError(names("cell") + ": above 0");
  return {request.dots, columns, rows, cell};
}

/// The white picture, NaN in the dark between micro-images.
Image bright_part(Image white) {
  const double least = kLeastWhite * high_level(white);
  for (float& value : white.pixels)
    if (!(static_cast<double>(value) > least)) value = std::numeric_limits<float>::quiet_NaN();
  return white;
}

}  // namespace

double high_level(const Image& image) {
  std::vector<float> values;
  for (const float value : image.pixels)
    if (std::isfinite(value)) values.push_back(value);
  if (values.empty()) return 0;
  const auto high =
      values.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), high, values.end());
  return static_cast<double>(*high);
}

template <>
std::span<const SettingRow<BoardRequest>> setting_rows() {
  using R = BoardRequest;
  using enum SettingKind;
  static const std::vector<SettingRow<R>> rows{
      {"board", "COLUMNSxROWS",
       "Points of the board: corners between squares (one less than the squares each way), or dots",
       &R::board, sides, kRequired},
      {"cell", "LENGTH", "Distance between neighbouring points", &R::cell, lengths, kRequired},
      {"dots", "", "The board has round dots, not squares", &R::dots},
      {"white", "FILE ...",
       "White pictures, by which the others are divided against the edges of micro-images",
       &R::white, file},
      {"dark", "FILE ...", "Dark frames of the same exposure", &R::dark, file}};
  return rows;
}

BoardCalibration calibrate_corners(const BoardRequest& request, const SceneDocument& camera,
                                   const Execution& execution) {
  const BoardSpec board = board_of(request);
  const SensorSpec& sensor = camera.scene.camera.sensor;
  const double full = full_of(request.files, sensor);
  std::optional<CountFrames> dark;
  if (!request.dark.empty()) dark = read_frames(request.dark, request.files, execution);
  Image white;
  if (!request.white.empty())
    white = bright_part(
        light_of(read_frames(request.white, request.files, execution), dark, sensor.mosaic));
  BoardCalibration result;
  result.corners = "pose,x,y,column,row,q,r,error,blur,blur_error\n";
  std::size_t boards = 0, corners = 0;
  nlohmann::json list = nlohmann::json::array();
  std::vector<std::string> without;  // why pictures show no board
  const std::vector<std::string> pictures = files_of(request.boards);
  if (pictures.empty()) throw UsageError("no picture is given");
  for (std::size_t pose = 0; pose < pictures.size(); ++pose) {
    const std::string& file = pictures[pose];
    const CountFrames frames = read_frames({file}, request.files, execution, full);
    if (frames.width != sensor.columns || frames.height != sensor.rows)
      throw InputError(fmt::format("'{}' has {} x {} pixels, the camera's sensor {} x {}", file,
                                   frames.width, frames.height, sensor.columns, sensor.rows));
    warn_of_full(frames, file, full, sensor, execution);
    Image light = light_of(frames, dark, sensor.mosaic);
    if (!white.empty() && (white.width != light.width || white.height != light.height))
      throw InputError("the white picture has another size than '" + file + "'");
    BoardCorners found;
    try {
      found = find_board(light, camera.scene.camera, board, white, execution);
    } catch (const InputError& error) {
      without.push_back("'" + file + "': " + error.what());
      list.push_back({{"file", file}, {"pose", pose}, {"corners", 0}, {"reason", error.what()}});
      continue;
    }
    ++boards;
    corners += found.corners.size();
    for (const BoardCorner& c : found.corners)
      result.corners += fmt::format("{},{:.9g},{:.9g},{:.4f},{:.4f},{},{},{:.4f},{:.4f},{:.4f}\n",
                                    pose, c.column * board.cell, c.row * board.cell, c.pixel.x,
                                    c.pixel.y, c.lens.q, c.lens.r, c.error, c.blur, c.blur_error);
    result.report.add_text(
        file, fmt::format("{} of {} points, {} corners in micro-images, about "
                          "{:.4g} m away{}",
                          found.points, board.columns * board.rows, found.corners.size(),
                          found.distance, found.whole ? "" : "; a part of the board"));
    list.push_back({{"file", file},
                    {"pose", pose},
                    {"points", found.points},
                    {"corners", found.corners.size()},
                    {"whole", found.whole},
                    {"distance_m", found.distance}});
    if (!result.light.empty()) continue;
    result.light = std::move(light);
    result.found = std::move(found);
  }
  if (boards == 0) throw InputError("no picture shows the board; the first: " + without.front());
  // The advice is printed once.
  for (std::size_t i = 0; i < without.size(); ++i)
    execution.warn(i == 0 ? without[i] : without[i].substr(0, without[i].find("; ")));
  result.report.add("boards", fmt::format("{} of {} pictures", boards, pictures.size()), "boards",
                    boards);
  result.report.add("corners", std::to_string(corners), "corners", corners);
  result.report.add_json("pictures", list);
  return result;
}

}  // namespace plenoflame
