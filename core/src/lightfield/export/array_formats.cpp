/// Arrays: npz and HDF5 for Python, HDF5 of plenoptomos.
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "lightfield/export/array_files.h"
#include "lightfield/export/export_files.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

using Size = std::vector<std::size_t>;

std::size_t size(int n) {
  return static_cast<std::size_t>(n);
}

/// Unit of a layer of a light field; empty: a number without one.
std::string layer_unit(const std::string& name) {
  if (name == "truth.temperature") return "K";
  if (name == "sensor.raw") return "e-";
  for (const char* metres : {"truth.distance", "truth.first_hit", "truth.last_hit",
                             "truth.surface_distance", "chief.x", "chief.y", "chief.z"})
    if (name == metres) return "m";
  return "";
}

/// The facts that an npz file has no place for: unit and axes of each of its arrays, as JSON.
std::string units_json(const std::vector<NamedArray>& arrays) {
  nlohmann::ordered_json units;
  for (const NamedArray& array : arrays)
    units[array.name] = {{"units", array.unit}, {"axes", array.axes}};
  return units.dump(2) + "\n";
}

/// Views as one block: rows, columns of the grid, then rows, columns of the pictures.
NamedArray views_array(const Views& views) {
  const auto grid = static_cast<std::size_t>(std::lround(std::sqrt(views.views.size())));
  const Image& first = views.views.front().image;
  NamedArray array{"views", views.unit, "v:u:t:s", {}, {}};
  array.shape = {grid, grid, size(first.height), size(first.width)};
  PixelValues values;
  values.reserve(views.views.size() * first.pixels.size());
  for (const View& view : views.views)
    values.insert(values.end(), view.image.pixels.begin(), view.image.pixels.end());
  array.values = std::move(values);
  return array;
}

/// Raw image, places of its micro-images, and the views with their geometry.
std::vector<NamedArray> all_arrays(const ExportJob& job) {
  const Views views = job.views(9);
  const PixelWindow& window = job.field.window;
  const Camera& camera = job.micro.camera();
  const CameraSpec& spec = camera.spec();
  const Vec2 p = spec.sensor.pixel();
  std::vector<NamedArray> arrays;
  arrays.push_back({"raw",
                    job.field.unit,
                    "row:column",
                    {size(window.height), size(window.width)},
                    job.flux.pixels});
  const Image white = white_image(job.micro, window, job.execution);
  arrays.push_back(
      {"white", "m^2 sr", "row:column", {size(window.height), size(window.width)}, white.pixels});
  for (const auto& [name, image] : job.field.layers)
    arrays.push_back({name,
                      layer_unit(name),
                      "row:column",
                      {size(image.height), size(image.width)},
                      image.pixels});

  std::vector<double> centres, radius;
  std::vector<std::int32_t> index, type;
  const Vec2 upper = camera.sensor_point(window.x, window.y);
  const Vec2 lower = camera.sensor_point(window.x + window.width, window.y + window.height);
  for (const LensIndex lens : camera.lattice().within(lower, upper)) {
    const MicroImages::Place place = job.micro.place(lens);
    if (place.dark) continue;
    const Vec2 centre = camera.image_point(place.centre);
    centres.push_back(centre.x - window.x);
    centres.push_back(centre.y - window.y);
    radius.push_back(place.radius / p.x);
    index.push_back(lens.q);
    index.push_back(lens.r);
    type.push_back(place.type);
  }
  const std::size_t count = type.size();
  arrays.push_back({"centres", "pixel", "lens:xy", {count, 2}, std::move(centres)});
  arrays.push_back({"radius", "pixel", "lens", {count}, std::move(radius)});
  arrays.push_back({"lens", "", "lens:qr", {count, 2}, std::move(index)});
  arrays.push_back({"type", "", "lens", {count}, std::move(type)});

  std::vector<double> offsets;
  for (const View& view : views.views) {
    offsets.push_back(view.offset.x);
    offsets.push_back(view.offset.y);
  }
  arrays.push_back(views_array(views));
  const Size grid{arrays.back().shape[0], arrays.back().shape[1]};
  arrays.push_back({"offsets", "pixel", "v:u:xy", {grid[0], grid[1], 2}, std::move(offsets)});
  const ViewGeometry geometry = fit_view_geometry(job.micro, views.lens_step);
  const auto scalar = [&arrays](const char* name, const char* unit, double value) {
    arrays.push_back({name, unit, "", {}, std::vector<double>{value}});
  };
  scalar("pixel_pitch", "m", p.x);
  if (!spec.sensor.square_pixels()) scalar("pixel_pitch_y", "m", p.y);
  scalar("pinhole_plane", "m", geometry.plane);
  scalar("focus_distance", "m", geometry.focus);
  scalar("focal_length", "view pixel", geometry.focal);
  scalar("viewpoint_per_offset", "m/pixel", geometry.centre_step);
  return arrays;
}

}  // namespace

void export_npz(const ExportJob& job) {
  const std::vector<NamedArray> arrays = all_arrays(job);
  job.text(job.settings.name + ".npz", npz_bytes(arrays));
  job.text(job.settings.name + ".json", units_json(arrays));
  if (!job.field.scene_text.empty()) job.text(job.settings.name + ".toml", job.field.scene_text);
}

void export_hdf5(const ExportJob& job) {
  Hdf5File file;
  file.attribute("/", "description", "Plenoflame light field");
  file.attribute("/", "version", job.field.version);
  file.attribute("/", "scene", job.field.scene_text);
  for (const NamedArray& array : all_arrays(job)) file.dataset("/" + array.name, array);
  job.text(job.settings.name + ".h5", file.bytes());
}

void export_plenoptomos(const ExportJob& job) {
  const Views views = job.views(9);
  const Camera& camera = job.micro.camera();
  const CameraSpec& spec = camera.spec();
  const FirstOrder& main = camera.lens_first_order();
  const Microlens& first = camera.microlenses()[0];
  const double pixel = 1e3 * spec.sensor.pixel_pitch;
  const MicroImageGrid grid = fit_grid(job.micro, job.field.window);
  const ViewGeometry geometry = fit_view_geometry(job.micro, views.lens_step);
  NamedArray image = views_array(views);
  const int across = static_cast<int>(image.shape[1]);
  const int width = static_cast<int>(image.shape[3]), height = static_cast<int>(image.shape[2]);
  const double offset_step =
      views.views.size() > 1 ? views.views[1].offset.x - views.views[0].offset.x : 1.0;

  Hdf5File file;
  file.attribute("/", "description", "VoxelDataFormat");
  file.attribute("/", "version", "v0");
  const auto numbers = [&file](const std::string& path, const char* axes, const char* unit,
                               std::vector<double> values) {
    const Size shape = values.size() == 1 ? Size{} : Size{values.size()};
    file.dataset(path, {"", unit, axes, shape, std::move(values)});
  };
  const auto counts = [&file](const std::string& path, const char* axes, const char* unit,
                              std::vector<std::int32_t> values) {
    const std::size_t n = values.size();
    file.dataset(path, {"", unit, axes, {n}, std::move(values)});
  };
  image.unit = "counts";
  image.axes = "v:u:t:s";
  file.dataset("/data/image", image);
  file.attribute("/data/image", "mode", "sub-aperture");
  const std::string root = "/instrument/camera";
  file.group(root);
  file.attribute(root, "manufacturer", "Plenoflame");
  file.attribute(root, "model", is_unfocused(camera) ? "unfocused" : "focused");
  const double z_array = 1e3 * (camera.rear_vertex() - main.rear_principal - first.front_principal);
  const double step = 1e3 * views.lens_step;
  counts(root + "/micro_lenses_array/size", "tau:sigma", "", {height, width});
  numbers(root + "/micro_lenses_array/position", "x:y:z", "mm", {0, 0, z_array});
  counts(root + "/micro_lens/size", "tau:sigma", "pixels", {across, across});
  numbers(root + "/micro_lens/physical_size", "t:s", "mm", {step, step});
  numbers(root + "/micro_lens/micro_image_size", "tau:sigma", "mm",
          {grid.pitch * pixel, grid.pitch * pixel});
  numbers(root + "/micro_lens/f2", "", "mm", {1e3 * first.first_order.focal_length});
  numbers(root + "/micro_lens/aperture", "", "mm", {1e3 * spec.array.diameter});
  const double viewpoint = 1e3 * geometry.centre_step * offset_step;
  numbers(root + "/main_lens/pixel_size", "v:u", "mm", {viewpoint, viewpoint});
  numbers(root + "/main_lens/f1", "", "mm", {1e3 * main.focal_length});
  numbers(root + "/main_lens/aperture", "", "mm", {1e3 * main.entrance_pupil_diameter});
  counts(root + "/sensor/size", "tau:sigma", "pixels", {height * across, width * across});
  numbers(root + "/sensor/pixel_size", "tau:sigma", "mm",
          {pixel * offset_step, pixel * offset_step});
  numbers(root + "/sensor/position", "x:y:z", "mm", {0, 0, z_array + 1e3 * first.sensor_distance});
  job.text(job.settings.name + ".vox", file.bytes());
}

}  // namespace plenoflame
