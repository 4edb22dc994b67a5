#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "commands/calibration/calibrate.h"
#include "commands/calibration/calibration_options.h"
#include "commands/scene_input.h"
#include "file_set.h"
#include "messages.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/calibration/board_corners.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/png_file.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

/// A white picture with less than this share of its brightest light says nothing.
constexpr double kLeastWhite = 0.3;

struct BoardArguments : CalibrationArguments {
  std::vector<std::string> boards, white, dark;
  std::string output, board, cell, picture;
  bool dots = false;
};

/// Brightness that nearly no pixel exceeds.
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

/// The pictures, as they were taken, with a cross at each corner that was found.
PngImage corner_picture(const Image& light, const BoardCorners& found) {
  PngImage picture;
  picture.width = light.width;
  picture.height = light.height;
  picture.channels = 3;
  picture.samples.assign(picture.sample_count(), 0);
  const double high = std::max(high_level(light), 1e-30);
  for (std::size_t i = 0; i < light.pixels.size(); ++i) {
    const double value = static_cast<double>(light.pixels[i]) / high;
    const int grey = static_cast<int>(230 * std::sqrt(std::clamp(value, 0.0, 1.0)) + 0.5);
    for (std::size_t c = 0; c < 3; ++c)
      picture.samples[3 * i + c] = static_cast<std::uint16_t>(std::isfinite(value) ? grey : 0);
  }
  for (const BoardCorner& corner : found.corners)
    for (int k = -3; k <= 3; ++k)
      for (const bool along : {false, true}) {
        const int x = static_cast<int>(corner.pixel.x) + (along ? k : 0),
                  y = static_cast<int>(corner.pixel.y) + (along ? 0 : k);
        if (x < 0 || y < 0 || x >= light.width || y >= light.height) continue;
        const auto at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(light.width) +
                             static_cast<std::size_t>(x));
        // The colour tells columns and rows that are even from the others.
        picture.samples[at] = 255;
        picture.samples[at + 1] = (corner.column + corner.row) % 2 == 0 ? 60 : 160;
        picture.samples[at + 2] = corner.row % 2 == 0 ? 0 : 90;
      }
  return picture;
}

class BoardCornersRun {
 public:
  explicit BoardCornersRun(const BoardArguments& arguments) : arguments_(arguments) {
    const std::array<int, 2> sides = pair_option("--board", arguments_.board, "COLUMNSxROWS", 'x');
    board_.dots = arguments_.dots;
    board_.columns = sides[0];
    board_.rows = sides[1];
    board_.cell = quantity_option("--cell", arguments_.cell, Dimension::length);
    if (board_.columns < 2 || board_.rows < 2 || board_.columns > 1000 || board_.rows > 1000)
      throw UsageError(
          "--board: from 2x2 to 1000x1000 points; of a checkerboard, the corners "
          "between its squares");
    if (!(board_.cell > 0)) throw UsageError("--cell: above 0");
    check_ending("-o", arguments_.output, {".csv"});
    if (!arguments_.picture.empty()) check_ending("--picture", arguments_.picture, {".png"});
    check_writable(arguments_.output);
    if (!arguments_.picture.empty()) check_writable(arguments_.picture);
  }

  int run(const Execution& execution) {
    document_ = read_camera_scene(arguments_.camera, arguments_.set, arguments_.which);
    const MosaicPattern mosaic = document_.scene.camera.sensor.mosaic;
    const SensorSpec& sensor = document_.scene.camera.sensor;
    const double full = full_of(arguments_.files, sensor);
    std::optional<CountFrames> dark;
    if (!arguments_.dark.empty()) dark = read_frames(arguments_.dark, arguments_.files, execution);
    Image white;
    if (!arguments_.white.empty())
      white = bright_part(
          light_of(read_frames(arguments_.white, arguments_.files, execution), dark, mosaic));
    std::string table = "pose,x,y,column,row,q,r,error,blur,blur_error\n";
    std::size_t boards = 0, corners = 0;
    nlohmann::json list = nlohmann::json::array();
    PngImage picture;
    std::vector<std::string> without;  // why pictures show no board
    for (std::size_t pose = 0; pose < arguments_.boards.size(); ++pose) {
      const std::string& file = arguments_.boards[pose];
      const CountFrames frames = read_frames({file}, arguments_.files, execution, full);
      if (frames.width != sensor.columns || frames.height != sensor.rows)
        throw InputError(fmt::format("'{}' has {} x {} pixels, the camera's sensor {} x {}", file,
                                     frames.width, frames.height, sensor.columns, sensor.rows));
      warn_of_full(frames, file, full, sensor, execution);
      const Image light = light_of(frames, dark, mosaic);
      if (!white.empty() && (white.width != light.width || white.height != light.height))
        throw InputError("the white picture has another size than '" + file + "'");
      BoardCorners found;
      try {
        found = find_board(light, document_.scene.camera, board_, white, execution);
      } catch (const InputError& error) {
        without.push_back("'" + file + "': " + error.what());
        list.push_back({{"file", file}, {"pose", pose}, {"corners", 0}, {"reason", error.what()}});
        continue;
      }
      ++boards;
      corners += found.corners.size();
      for (const BoardCorner& c : found.corners)
        table += fmt::format("{},{:.9g},{:.9g},{:.4f},{:.4f},{},{},{:.4f},{:.4f},{:.4f}\n", pose,
                             c.column * board_.cell, c.row * board_.cell, c.pixel.x, c.pixel.y,
                             c.lens.q, c.lens.r, c.error, c.blur, c.blur_error);
      report_.add_text(file,
                       fmt::format("{} of {} points, {} corners in micro-images, about {:.4g} "
                                   "m away{}",
                                   found.points, board_.columns * board_.rows, found.corners.size(),
                                   found.distance, found.whole ? "" : "; a part of the board"));
      list.push_back({{"file", file},
                      {"pose", pose},
                      {"points", found.points},
                      {"corners", found.corners.size()},
                      {"whole", found.whole},
                      {"distance_m", found.distance}});
      if (picture.samples.empty() && !arguments_.picture.empty())
        picture = corner_picture(light, found);
    }
    if (boards == 0) throw InputError("no picture shows the board; the first: " + without.front());
    // The advice is printed once.
    for (std::size_t i = 0; i < without.size(); ++i)
      warn(i == 0 ? without[i] : without[i].substr(0, without[i].find("; ")));
    FileSet files;
    files.write(arguments_.output, [&](const std::string& name) { write_file(name, table); });
    if (!arguments_.picture.empty())
      files.write(arguments_.picture, [&](const std::string& name) { write_png(name, picture); });
    files.commit();
    report_.add("boards", fmt::format("{} of {} pictures", boards, arguments_.boards.size()),
                "boards", boards);
    report_.add("corners", std::to_string(corners), "corners", corners);
    report_.add_json("pictures", list);
    report_.print(arguments_.json);
    return kSuccess;
  }

 private:
  /// The white picture, NaN in the dark between micro-images.
  static Image bright_part(Image white) {
    const double least = kLeastWhite * high_level(white);
    for (float& value : white.pixels)
      if (!(static_cast<double>(value) > least)) value = std::numeric_limits<float>::quiet_NaN();
    return white;
  }

  const BoardArguments& arguments_;
  BoardSpec board_;
  SceneDocument document_;
  Report report_;
};

}  // namespace

void add_calibrate_corners(CLI::App& calibrate, const Registry& registry) {
  auto a = std::make_shared<BoardArguments>();
  CLI::App& command = *calibrate.add_subcommand(
      "corners", "The corners of checkerboards, or dots, in the micro-images of raw pictures");
  command.footer(
      "Example:\n"
      "  plenoflame calibrate corners board-*.tif --camera camera.toml --board 9x6 --cell 5mm \\\n"
      "    --white white.tif -o corners.csv --picture seen.png");
  command
      .add_option("BOARD", a->boards,
                  "Raw pictures of one board, each in a pose of its own, counted from 0")
      ->required();
  add_camera_options(command, *a, "The camera, as found by calibrate white");
  command
      .add_option("--board", a->board,
                  "Points of the board: corners between squares (one less than the squares each "
                  "way), or dots")
      ->required()
      ->option_text("COLUMNSxROWS");
  command.add_option("--cell", a->cell, "Distance between neighbouring points")
      ->required()
      ->option_text("LENGTH");
  command.add_flag("--dots", a->dots, "The board has round dots, not squares");
  command
      .add_option(
          "--white", a->white,
          "White pictures, by which the others are divided against the edges of micro-images")
      ->option_text("FILE ...");
  command.add_option("--dark", a->dark, "Dark frames of the same exposure")
      ->option_text("FILE ...");
  command.add_option("-o,--output", a->output, "Table for calibrate geometry (.csv)")
      ->check(written())
      ->required()
      ->option_text("FILE.csv");
  command.add_option("--picture", a->picture, "The first board with what was found in it (.png)")
      ->check(written())
      ->option_text("FILE");
  finish_calibration(
      command, registry, a, CalibrationInput::pictures,
      [a](const Execution& execution) { return BoardCornersRun(*a).run(execution); });
}

}  // namespace plenoflame::cli
