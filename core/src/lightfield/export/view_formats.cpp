/// Formats made of views: HCI benchmark, LFToolbox.
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

#include "lightfield/export/export_files.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"

namespace plenoflame {
namespace {

std::string numbered(const char* format, int a, int b = 0) {
  char text[60];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

/// Greyscale PFM: bottom row first, little endian (the negative scale says so).
std::string pfm(const Image& image) {
  std::string bytes =
      "Pf\n" + std::to_string(image.width) + " " + std::to_string(image.height) + "\n-1.0\n";
  for (int row = image.height - 1; row >= 0; --row)
    for (int column = 0; column < image.width; ++column) {
      const auto word = std::bit_cast<std::uint32_t>(image.at(column, row));
      for (int shift = 0; shift < 32; shift += 8)
        bytes.push_back(static_cast<char>(word >> shift & 0xff));
    }
  return bytes;
}

/// LFToolbox counts a grid's columns and rows from the micro-image at its top left.
struct FirstCentre {
  Vec2 at;  ///< [pixel] of the whole sensor
  int columns = 0, rows = 0;
};

FirstCentre first_centre(const MicroImageGrid& grid, const PixelWindow& window) {
  const auto is_in = [&](Vec2 p) {
    return p.x >= window.x && p.y >= window.y && p.x < window.x + window.width &&
           p.y < window.y + window.height;
  };
  // Steps to the middle of the window, then outwards as long as there is a centre.
  const double row_step = grid.pitch * (grid.hexagonal ? std::sqrt(0.75) : 1.0);
  const Vec2 to_middle =
      Vec2{window.x + 0.5 * window.width, window.y + 0.5 * window.height} - grid.origin;
  const double c = std::cos(grid.rotation), s = std::sin(grid.rotation);
  const int j = static_cast<int>(std::lround((c * to_middle.y - s * to_middle.x) / row_step));
  const int i = static_cast<int>(std::lround((c * to_middle.x + s * to_middle.y) / grid.pitch -
                                             (grid.hexagonal ? 0.5 * j : 0.0)));
  // Two rows down and one step back is straight down where rows are shifted by half a step.
  const auto point = [&](int column, int row) {
    return grid.point(i + column - (grid.hexagonal ? (row >= 0 ? row / 2 : -((1 - row) / 2)) : 0),
                      j + row);
  };
  int left = 0, right = 0, top = 0, bottom = 0;
  while (is_in(point(left - 1, 0))) --left;
  while (is_in(point(right + 1, 0))) ++right;
  while (is_in(point(0, top - 1))) --top;
  while (is_in(point(0, bottom + 1))) ++bottom;
  if (grid.hexagonal && top % 2 != 0) ++top;  // every second row is shifted, the first is not
  return {point(left, top), right - left + 1, bottom - top + 1};
}

}  // namespace

void export_hci(const ExportJob& job) {
  const Views views = job.views(9);
  const int grid = static_cast<int>(std::lround(std::sqrt(views.views.size())));
  if (grid < 2)
    throw mended_by(InputError("the HCI format needs at least 2 x 2 views; usual are 9"), {"grid"});
  const std::vector<Views> colours = job.colour_views(views);
  const double white = views_white(colours);
  for (std::size_t k = 0; k < views.views.size(); ++k) {
    const View& view = views.views[k];
    job.png(numbered("input_Cam%03d.png", view.row * grid + view.column), view_images(colours, k),
            white, 8, 3);
  }

  const Camera& camera = job.micro.camera();
  const ViewGeometry geometry = fit_view_geometry(job.micro, views.lens_step);
  if (!std::isfinite(geometry.focus))
    throw InputError(
        "the views of this camera agree at infinity, which the HCI format cannot say: it wants a "
        "focus distance");
  const Image& first = views.views.front().image;
  const double step = views.views[1].offset.x - views.views[0].offset.x;
  const double baseline = geometry.centre_step * step;
  // Any sensor width gives the same picture as long as focal length / width does.
  const int larger = std::max(first.width, first.height);
  const double sensor = 1e3 * views.lens_step * larger;
  const double focal = geometry.focal * sensor / larger;
  // The range of resolvable depths: objects from half the distance in focus to infinity.
  const double far = geometry.focal * baseline * (0 - 1 / (geometry.focus - geometry.plane));
  const double near =
      geometry.disparity(geometry.plane + 0.5 * (geometry.focus - geometry.plane), step);
  const Vec3 centre = camera.to_world().point({0, 0, geometry.plane});
  std::string text = "[intrinsics]\n";
  const auto add = [&text](const char* key, const std::string& value) {
    text += std::string(key) + " = " + value + "\n";
  };
  add("focal_length_mm", number(focal));
  add("image_resolution_x_px", std::to_string(first.width));
  add("image_resolution_y_px", std::to_string(first.height));
  add("sensor_size_mm", number(sensor));
  add("fstop", "100.0");  // the views represent pinholes
  text += "\n[extrinsics]\n";
  add("num_cams_x", std::to_string(grid));
  add("num_cams_y", std::to_string(grid));
  add("baseline_mm", number(1e3 * baseline));
  add("focus_distance_m", number(geometry.focus - geometry.plane));
  add("center_cam_x_m", number(centre.x));
  add("center_cam_y_m", number(centre.y));
  add("center_cam_z_m", number(centre.z));
  for (const char* key : {"center_cam_rx_rad", "center_cam_ry_rad", "center_cam_rz_rad"})
    add(key, "0.0");
  text += "\n[meta]\n";
  add("scene", job.settings.name);
  add("category", "plenoflame");
  add("date", "");
  add("version", job.field.version);
  add("authors", "");
  add("contact", "");
  add("cycles_seed", std::to_string(job.field.seed));
  add("disp_min", number(far));
  add("disp_max", number(near));
  add("frustum_disp_min", number(far));
  add("frustum_disp_max", number(near));
  add("depth_map_scale", "1.0");

  // Ground truth of the middle view, where the raw image holds it.
  const auto truth = job.field.layers.find("truth.distance");
  if (truth != job.field.layers.end()) {
    ViewSettings how = job.settings.views;
    how.grid = 1;
    how.resampling = ViewResampling::nearest;
    LightField layer;
    layer.sensor_width = job.field.sensor_width;
    layer.sensor_height = job.field.sensor_height;
    layer.window = job.field.window;
    layer.channels.push_back({"distance", truth->second, {}});
    how.channel = "distance";
    how.white_correction = false;
    Image depth = extract_views(layer, job.micro, how, job.execution).views[0].image;
    // Disparity 0 is that of what is in focus: which pixels have one at all stands in a mask.
    Image disparity(depth.width, depth.height), known(depth.width, depth.height);
    for (std::size_t k = 0; k < depth.pixels.size(); ++k) {
      if (!(depth.pixels[k] > 0)) continue;
      const auto z = static_cast<double>(depth.pixels[k]);
      disparity.pixels[k] = static_cast<float>(geometry.disparity(z, step));
      known.pixels[k] = 1;
      depth.pixels[k] = static_cast<float>(z - geometry.plane);
    }
    job.text("gt_depth_lowres.pfm", pfm(depth));
    job.text("gt_disp_lowres.pfm", pfm(disparity));
    job.png("gt_mask_lowres.png", known, 1, 8, 1);
    const bool solid = job.field.layers.contains("truth.surface_distance");
    add("ground_truth", solid ? "distance_of_surfaces_or_emission_weighted_of_flames_centre_view"
                              : "emission_weighted_mean_distance_of_the_centre_view");
    job.result.notes.push_back(
        solid ? "gt_*.pfm hold the distance of the surfaces; where a flame glows before them its "
                "emission-weighted mean distance; where there is nothing they hold 0 and "
                "gt_mask_lowres.png is black"
              : "gt_*.pfm hold the emission-weighted mean distance: a flame has no single one; "
                "where nothing glows they hold 0 and gt_mask_lowres.png is black");
  } else {
    add("ground_truth", "none");
    job.result.notes.push_back("no ground truth: the raw image was rendered without its truth");
  }
  job.text("parameters.cfg", text);
}

void export_eslf(const ExportJob& job) {
  const Views views = job.views(14);
  const int grid = static_cast<int>(std::lround(std::sqrt(views.views.size())));
  const Image& first = views.views.front().image;
  const std::vector<Views> colours = job.colour_views(views);
  std::vector<Image> all(colours.size(), Image(first.width * grid, first.height * grid));
  std::vector<const Image*> images;
  for (std::size_t c = 0; c < colours.size(); ++c) {
    for (const View& view : colours[c].views)
      for (int row = 0; row < first.height; ++row)
        for (int column = 0; column < first.width; ++column)
          all[c].at(column * grid + view.column, row * grid + view.row) =
              view.image.at(column, row);
    images.push_back(&all[c]);
  }
  job.png(job.settings.name + ".eslf.png", images, views_white(colours), 16, 3);
  if (grid != 14)
    job.result.notes.push_back("LFReadESLF wants to be told: LensletSize_pix = [" +
                               std::to_string(grid) + "," + std::to_string(grid) + "]");
}

void export_view_grid(const ExportJob& job) {
  const Views views = job.views(9);
  const int grid = static_cast<int>(std::lround(std::sqrt(views.views.size())));
  const std::vector<Views> colours = job.colour_views(views);
  const double white = views_white(colours);
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < views.views.size(); ++k) {
    const View& view = views.views[k];
    const std::string name = numbered("view_%02d_%02d.png", view.row, view.column);
    job.png(name, view_images(colours, k), white, 16, 3);
    list.push_back({{"file", name},
                    {"row", view.row},
                    {"column", view.column},
                    {"offset_px", {view.offset.x, view.offset.y}}});
  }
  const MicroImageGrid fit = fit_grid(job.micro, job.field.window);
  const FirstCentre first = first_centre(fit, job.field.window);
  const ViewGeometry geometry = fit_view_geometry(job.micro, views.lens_step);
  nlohmann::ordered_json focus = nullptr;
  if (std::isfinite(geometry.focus)) focus = geometry.focus;
  const nlohmann::ordered_json description{
      {"STSize", {grid, grid}},
      {"Order", "RowMajor"},
      {"LensletGridModel",
       {{"HSpacing", fit.pitch},
        {"VSpacing", fit.hexagonal ? std::sqrt(0.75) * fit.pitch : fit.pitch},
        {"HOffset", first.at.x - job.field.window.x + 0.5},
        {"VOffset", first.at.y - job.field.window.y + 0.5},
        {"Rot", fit.rotation},
        {"UMax", first.columns},
        {"VMax", first.rows},
        {"FirstPosShiftRow", 2},
        {"Orientation", "horz"}}},
      {"geometry",
       {{"pinhole_plane_m", geometry.plane},
        {"focus_distance_m", focus},
        {"focal_length_px", geometry.focal},
        {"viewpoint_per_offset_m", geometry.centre_step}}},
      {"views", list}};
  job.text("views.json", description.dump(2) + "\n");
}

}  // namespace plenoflame
