/// Raw images with their grid as JSON: libpleno and plenopticam.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "lightfield/export/export_files.h"

namespace plenoflame {
namespace {

using Json = nlohmann::ordered_json;

Json row(double x, double y) {
  return Json::array({Json::array({x, y})});
}
Json row(double x, double y, double z) {
  return Json::array({Json::array({x, y, z})});
}
/// libpleno reads a nested list as the columns of a matrix, not as its rows.
Json rotation2(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return Json::array({Json::array({c, s}), Json::array({-s, c})});
}
Json rotation3(const Mat3& turn) {
  Json columns = Json::array();
  for (const Vec3& column : transpose(turn).rows)
    columns.push_back(Json::array({column.x, column.y, column.z}));
  return columns;
}

/// Distance behind the lens at which the plane is imaged that stays sharp [mm].
double distortion_plane(const Camera& camera) {
  const double f = camera.lens_first_order().focal_length,
               distance = camera.spec().lens.distortion.distance;
  return 1e3 / (1 / f - 1 / distance);
}

/// libpleno's coefficients, A_0 to A_2, B_0 and B_1: its image points lie at minus the image
/// distance times the direction of the object.
std::array<double, 5> distortion_in_mm(const Camera& camera) {
  const DistortionSpec& d = camera.spec().lens.distortion;
  const double a = distortion_plane(camera), a2 = a * a;
  return {d.k1 / a2, d.k2 / (a2 * a2), d.k3 / (a2 * a2 * a2), 0.0 - d.p2 / a, 0.0 - d.p1 / a};
}

/// The same polynomials, fitted to the inverse over the sensor.
std::array<double, 5> inverse_in_mm(const Camera& camera) {
  if (!camera.distortion().present()) return {};
  constexpr int kSide = 41;
  const double a = distortion_plane(camera);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2 * kSide * kSide, 5);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(2 * kSide * kSide);
  const Vec2 corner = 1e3 * camera.sensor_point(0, 0);
  Eigen::Index k = 0;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j, k += 2) {
      const Vec2 at{corner.x * (2.0 * i / (kSide - 1) - 1), corner.y * (2.0 * j / (kSide - 1) - 1)};
      const auto direction = camera.distortion().undistorted((-1 / a) * at);
      if (!direction) continue;
      const Vec2 back = -a * *direction - at;
      const double r2 = dot(at, at), xy = 2 * at.x * at.y;
      rows.row(k) << at.x * r2, at.x * r2 * r2, at.x * r2 * r2 * r2, r2 + 2 * at.x * at.x, xy;
      rows.row(k + 1) << at.y * r2, at.y * r2 * r2, at.y * r2 * r2 * r2, xy, r2 + 2 * at.y * at.y;
      values[k] = back.x;
      values[k + 1] = back.y;
    }
  // Columns differ by many orders of magnitude.
  const Eigen::RowVectorXd size = rows.colwise().norm();
  for (Eigen::Index c = 0; c < 5; ++c) rows.col(c) /= size[c];
  const Eigen::VectorXd x = rows.colPivHouseholderQr().solve(values);
  std::array<double, 5> result{};
  for (Eigen::Index c = 0; c < 5; ++c) result[static_cast<std::size_t>(c)] = x[c] / size[c];
  return result;
}

Json distortion_json(const std::array<double, 5>& c) {
  return {
      {"radial", row(c[0], c[1], c[2])}, {"tangential", row(c[3], c[4])}, {"depth", row(0, 0, 0)}};
}

/// The smallest grid of libpleno's indices (column k, row l) whose nodes cover the window.
struct NodeGrid {
  int i0 = 0, j0 = 0;  ///< grid point of node (0, 0)
  int width = 0, height = 0;
};

/// Rows are those of the lattice; of a hexagonal one, even rows are shifted to the right by half a
/// step. The number of rows is even, so that the same holds for the array's own numbering, which
/// starts at the opposite corner.
NodeGrid node_grid(const MicroImageGrid& grid, const PixelWindow& window) {
  const double row_step = grid.hexagonal ? std::sqrt(0.75) : 1.0;
  const double c = std::cos(grid.rotation), s = std::sin(grid.rotation);
  double left = kInfinity, right = -kInfinity, top = kInfinity, bottom = -kInfinity;
  for (const double x : {window.x, window.x + window.width})
    for (const double y : {window.y, window.y + window.height}) {
      const Vec2 d = (1 / grid.pitch) * (Vec2{x, y} - grid.origin);
      const double along = c * d.x + s * d.y, across = (c * d.y - s * d.x) / row_step;
      left = std::min(left, along);
      right = std::max(right, along);
      top = std::min(top, across);
      bottom = std::max(bottom, across);
    }
  NodeGrid nodes;
  nodes.j0 = static_cast<int>(std::floor(top));
  nodes.height = static_cast<int>(std::ceil(bottom)) - nodes.j0 + 1;
  nodes.height += nodes.height % 2;
  const double first = std::floor(left) - (grid.hexagonal ? 0.5 * nodes.j0 : 0.0);
  nodes.i0 = static_cast<int>(std::floor(first));
  nodes.width = static_cast<int>(std::ceil(right) - std::floor(left)) + 2;
  return nodes;
}

/// Rows and columns of a lattice without a gap.
struct LensRectangle {
  int row = 0, column = 0;  ///< the first ones
  int rows = 0, columns = 0;
};

/// The one with the most micro-images, of those given at (row, column).
LensRectangle largest_rectangle(const std::map<std::pair<int, int>, Vec2>& centres) {
  LensRectangle best;
  if (centres.empty()) return best;
  int left = centres.begin()->first.second, right = left;
  for (const auto& [place, centre] : centres) {
    left = std::min(left, place.second);
    right = std::max(right, place.second);
  }
  // Micro-images in a column that end at the present row, and the columns where taller ones began.
  std::vector<int> heights(static_cast<std::size_t>(right - left) + 2, 0);
  for (int row = centres.begin()->first.first; row <= centres.rbegin()->first.first; ++row) {
    std::vector<std::pair<int, int>> rising;  // first column, height
    for (int column = left; column <= right + 1; ++column) {
      int& height = heights[static_cast<std::size_t>(column - left)];
      height = centres.contains({row, column}) ? height + 1 : 0;
      int begin = column;
      while (!rising.empty() && rising.back().second >= height) {
        begin = rising.back().first;
        const int rows = rising.back().second, columns = column - begin;
        if (rows * columns > best.rows * best.columns)
          best = {row - rows + 1, begin, rows, columns};
        rising.pop_back();
      }
      rising.emplace_back(begin, height);
    }
  }
  return best;
}

/// The same camera with its stop narrowed.
CameraSpec stopped_down(const Camera& camera, double factor) {
  CameraSpec spec = camera.spec();
  spec.focus.mode = FocusMode::distance;
  spec.focus.lens_distance = camera.lens_distance();
  spec.lens.diameter /= factor;
  for (SurfaceSpec& surface : spec.lens.surfaces)
    if (surface.stop) surface.diameter /= factor;
  return spec;
}

}  // namespace

void export_libpleno(const ExportJob& job) {
  const Camera& camera = job.micro.camera();
  const CameraSpec& spec = camera.spec();
  const PixelWindow& window = job.field.window;
  const double p = spec.sensor.pixel_pitch;
  const MicroImageGrid grid = fit_grid(job.micro, window);
  const NodeGrid nodes = node_grid(grid, window);
  const FirstOrder& main = camera.lens_first_order();
  const int types = static_cast<int>(camera.microlenses().size());
  // Node (0, 0) of a hexagonal grid is shifted by half a step against the grid's own origin.
  const double shift = grid.hexagonal ? 0.5 : 0.0;
  // A pixel's centre lies at whole numbers there.
  const Vec2 corner{window.x + 0.5, window.y + 0.5};
  const Vec2 along{grid.pitch * std::cos(grid.rotation), grid.pitch * std::sin(grid.rotation)};
  const Vec2 origin = grid.point(nodes.i0, nodes.j0) - corner - shift * along;

  // The origin is the thin main lens: the rear principal point, moved and tilted with it. The axes
  // are those of the sensor, and the array is tilted against them.
  const double f_number = main.focal_length / main.entrance_pupil_diameter;
  const Microlens& first = camera.microlenses()[0];
  const Vec3 middle = camera.lens_pose().point({0, 0, camera.rear_vertex() - main.rear_principal});
  const auto on_array = [&](Vec2 place) {
    return camera.array_pose().point({place.x, place.y, first.front_principal}) - middle;
  };
  const double distance = -on_array({0, 0}).z;
  const double gap = first.sensor_distance;
  const double object = 1 / (1 / main.focal_length - 1 / distance);

  Json mia_mesh{
      {"geometry", grid.hexagonal ? 1 : 0},
      {"width", nodes.width},
      {"height", nodes.height},
      {"pitch", row(grid.pitch, grid.pitch)},
      {"pose", {{"rotation", rotation2(grid.rotation)}, {"translation", row(origin.x, origin.y)}}}};
  // The array itself, seen from the scene: node (0, 0) lies behind the last node of the image, and
  // its rows run along camera x.
  const int last_i =
      grid.hexagonal ? nodes.i0 + nodes.width - 1 - nodes.height / 2 : nodes.i0 + nodes.width - 1;
  const int last_j = nodes.j0 + nodes.height - 1;
  const Vec2 lens = camera.lattice().centre({-last_i, -last_j});
  const double turn = spec.array.rotation;
  const Vec3 lens_origin =
      on_array(lens - shift * spec.array.pitch * Vec2{std::cos(turn), std::sin(turn)});
  const Mat3 array_turn = camera.array_pose().rotation * rotation_xyz({0, 0, turn});
  // The sensor is numbered from its last pixel, as its image is upside down.
  const Vec2 last =
      camera.sensor_point(window.x + window.width - 0.5, window.y + window.height - 0.5) -
      Vec2{middle.x, middle.y};
  // Their type t of a node is (c - ours) mod 3.
  std::vector<double> focal;
  const int c = (((nodes.j0 - nodes.i0) % 3) + 3) % 3;
  for (int t = 0; t < types; ++t) {
    const int ours = types == 3 ? (c - t + 3) % 3 : 0;
    focal.push_back(1e3 *
                    camera.microlenses()[static_cast<std::size_t>(ours)].first_order.focal_length);
  }
  const Json focal_lengths = focal;
  const int mode = is_unfocused(camera) ? 0 : 1e-3 * focal[0] < gap ? 1 : 2;
  Json camera_js{
      {"mode", mode},
      {"I", types},
      {"dist_focus", spec.lens.distortion.none()
                         ? std::isfinite(object) && object > 0 ? 1e3 * object : 1e8
                         : std::min(1e3 * spec.lens.distortion.distance, 1e8)},
      {"main_lens",
       {{"f", 1e3 * main.focal_length},
        {"aperture", f_number},
        {"diameter", 1e3 * main.entrance_pupil_diameter},
        {"pose",
         {{"rotation", rotation3(camera.lens_pose().rotation)}, {"translation", row(0, 0, 0)}}}}},
      {"sensor",
       {{"width", window.width},
        {"height", window.height},
        {"scale", 1e3 * p},
        {"pose",
         {{"rotation", rotation3({})},
          {"translation", row(1e3 * last.x, 1e3 * last.y, -1e3 * (distance + gap))}}}}},
      {"mia", {{"mesh", mia_mesh}}},
      {"mla",
       {{"focal_lengths", focal_lengths},
        {"mesh",
         {{"geometry", grid.hexagonal ? 1 : 0},
          {"width", nodes.width},
          {"height", nodes.height},
          {"pitch", row(1e3 * spec.array.pitch, 1e3 * spec.array.pitch)},
          {"pose",
           {{"rotation", rotation3(array_turn)},
            {"translation",
             row(1e3 * lens_origin.x, 1e3 * lens_origin.y, 1e3 * lens_origin.z)}}}}}}},
      {"distortions", distortion_json(distortion_in_mm(camera))},
      {"distortions_inverse", distortion_json(inverse_in_mm(camera))}};
  job.text("camera.js", camera_js.dump(2) + "\n");

  // Radius of a micro-image in pixels: (m / N + q) / scale, over the main lens' f-number N.
  const double pitch_mm = 1e3 * grid.pitch * p;
  const double m = 0.5e3 * gap * main.focal_length / distance;
  std::vector<double> q, q_prime;
  for (const double f : focal) {
    // Half the width of the rim that the microlens' own aperture adds out of focus.
    const double blur = 0.5 * pitch_mm * std::fabs(1e3 * gap / f - 1);
    q.push_back(blur);
    q_prime.push_back(blur / pitch_mm);
  }
  job.text("params.js", Json{{"m", m},
                             {"q", q},
                             {"q_prime", q_prime},
                             {"dc", pitch_mm},
                             {"dC", 1e3 * spec.array.pitch},
                             {"lambda", spec.array.pitch / (grid.pitch * p)},
                             {"kappa", 1.0},
                             {"N", f_number},
                             {"I", types},
                             {"scale", 1e3 * p}}
                                .dump(2) +
                            "\n");

  // White images at several f-numbers: the tools calibrate from how micro-images shrink.
  Json whites = Json::array();
  for (int step = 0; step < 4; ++step) {
    const double factor = std::pow(2.0, 0.5 * step);
    char name[40];
    std::snprintf(name, sizeof name, "white_%02d.png", step);
    const auto write = [&](const MicroImages& micro) {
      const Image white = white_image(micro, window, job.execution);
      job.png(name, white, *std::max_element(white.pixels.begin(), white.pixels.end()), 8, 3);
    };
    if (step == 0)
      write(job.micro);
    else
      write(MicroImages(Camera(stopped_down(camera, factor)), true, job.execution));
    whites.push_back({{"path", name}, {"fnumber", factor * f_number}, {"frame", step}});
  }
  const std::string image = job.settings.name + ".png";
  // The tools turn colour into grey themselves, and know no other pictures than of 8 bits.
  job.raw_png(image, 8, 3);
  job.text("images.js",
           Json{{"meta", {{"debayer", true}, {"debayered", true}, {"rgb", true}, {"format", 8}}},
                {"whites", whites},
                {"checkerboards", Json::array()},
                {"images", Json::array({{{"path", image}, {"fnumber", f_number}, {"frame", 0}}})},
                {"mask", {{"path", "white_00.png"}, {"fnumber", f_number}, {"frame", 0}}}}
                   .dump(2) +
               "\n");
}

void export_plenopticam(const ExportJob& job) {
  const Camera& camera = job.micro.camera();
  const CameraSpec& spec = camera.spec();
  const PixelWindow& window = job.field.window;
  const double p = spec.sensor.pixel_pitch;
  const MicroImageGrid grid = fit_grid(job.micro, window);
  const Vec2 corner{window.x + 0.5, window.y + 0.5};

  // Every micro-image that lies wholly in the picture, at its row and column of the lattice.
  std::map<std::pair<int, int>, Vec2> centres;
  const Vec2 upper = camera.sensor_point(window.x, window.y);
  const Vec2 lower = camera.sensor_point(window.x + window.width, window.y + window.height);
  const double margin = 0.5 * grid.pitch;
  for (const LensIndex lens : camera.lattice().within(lower, upper)) {
    const MicroImages::Place place = job.micro.place(lens);
    if (place.dark) continue;
    const double column = 0.5 * spec.sensor.columns - place.centre.x / p - corner.x;
    const double row = 0.5 * spec.sensor.rows - place.centre.y / p - corner.y;
    if (column < margin || row < margin || column > window.width - 1 - margin ||
        row > window.height - 1 - margin)
      continue;
    const int i = -lens.q, j = -lens.r;
    // The column counts along a row of a hexagonal array, half steps to the right rounded down.
    const int along = grid.hexagonal ? i + (j - (j & 1)) / 2 : i;
    centres[{j, along}] = {column, row};
  }
  // The tool looks up every row and column up to the last ones, and stops at one that is missing.
  const LensRectangle whole = largest_rectangle(centres);
  Json list = Json::array();
  for (int j = 0; j < whole.rows; ++j)
    for (int i = 0; i < whole.columns; ++i) {
      const Vec2 at = centres.at({whole.row + j, whole.column + i});
      list.push_back({at.y, at.x, j, i});
    }
  const double row_pitch = grid.hexagonal ? std::sqrt(0.75) * grid.pitch : grid.pitch;
  const std::string name = job.settings.name;
  job.text(name + "_white.json", Json{{"pat_type", grid.hexagonal ? "hex" : "rec"},
                                      {"ptc_mean", {row_pitch, grid.pitch}},
                                      {"mic_list", list}}
                                         .dump() +
                                     "\n");
  const Image white = white_image(job.micro, window, job.execution);
  job.png(name + "_white.png", white, *std::max_element(white.pixels.begin(), white.pixels.end()),
          16, 3);
  job.raw_png(name + ".png", 16, 3);
}

}  // namespace plenoflame
