/// Raw images with their grid as XML: PlenopticToolbox2.0 and PlenopticImageProcessing.
#include <algorithm>
#include <cmath>
#include <pugixml.hpp>
#include <sstream>

#include "lightfield/export/export_files.h"
#include "plenoflame/camera/design.h"

namespace plenoflame {
namespace {

std::string document_text(const pugi::xml_document& document) {
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

pugi::xml_node start(pugi::xml_document& document) {
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  return document;
}

/// <name units="..."><x>..</x><y>..</y></name>
void add_pair(pugi::xml_node parent, const char* name, const char* units, double x, double y) {
  pugi::xml_node node = parent.append_child(name);
  node.append_attribute("units") = units;
  node.append_child("x").text().set(number(x).c_str());
  node.append_child("y").text().set(number(y).c_str());
}

void add_value(pugi::xml_node parent, const char* name, const char* units, double value) {
  pugi::xml_node node = parent.append_child(name);
  node.append_attribute("units") = units;
  node.text().set(number(value).c_str());
}

void note_worst(const ExportJob& job, const MicroImageGrid& grid) {
  job.result.notes.push_back("traced centres of micro-images lie within " +
                             number(std::ceil(1e3 * grid.worst) / 1e3) +
                             " pixel of the regular grid that the tool assumes");
}

}  // namespace

void export_plenoptic_toolbox(const ExportJob& job) {
  const PixelWindow& window = job.field.window;
  const Camera& camera = job.micro.camera();
  const MicroImageGrid grid = fit_grid(job.micro, window);

  // The tool counts types from the lens at `offset`; ours are named from lens (0, 0). Take the
  // lens of the first type that is nearest to the middle of the picture.
  const Vec2 middle{window.x + 0.5 * window.width, window.y + 0.5 * window.height};
  const LensIndex near = camera.lattice().nearest(camera.sensor_point(middle.x, middle.y));
  Vec2 centre = grid.origin;
  double least = kInfinity;
  for (int j = -near.r - 3; j <= -near.r + 3; ++j)
    for (int i = -near.q - 3; i <= -near.q + 3; ++i) {
      if (camera.lattice().type({-i, -j}) != 0) continue;
      const double distance = length(grid.point(i, j) - middle);
      if (distance < least) {
        least = distance;
        centre = grid.point(i, j);
      }
    }

  pugi::xml_document document;
  pugi::xml_node root = start(document).append_child("RayCalibData");
  root.append_attribute("version") = "1.0";
  // From the middle of the picture, which is (width - 1) / 2 if pixels are centred on integers. The
  // reader's y points upwards, and its angles are counter-clockwise.
  add_pair(root, "offset", "pix", centre.x - middle.x, -(centre.y - middle.y));
  add_value(root, "diameter", "pix", grid.pitch);
  add_value(root, "rotation", "rad", -grid.rotation);
  add_value(root, "lens_border", "pix",
            std::max(1.0, 0.5 * grid.pitch - 0.9 * std::min(grid.mean_radius, 0.5 * grid.pitch)));
  add_value(root, "tcp", "virtual_depth", 2);
  add_pair(root, "lens_base_x", "lens", 1, 0);
  add_pair(root, "lens_base_y", "lens", 0.5, std::sqrt(0.75));
  add_pair(root, "sub_grid_base", "lens", 3, std::sqrt(3.0));
  pugi::xml_node distortion = root.append_child("distortion");
  distortion.append_attribute("type") = "radial";
  distortion.append_child("function").text().set("none");
  pugi::xml_node parameters = distortion.append_child("parameter");
  parameters.append_attribute("count") = 0;
  add_pair(distortion, "offset", "pix", 0, 0);
  // The reader needs three entries even for a camera of one type. Entry i is our type i. The
  // reader's type of lens (c0, c1) = (down-right, right) is (c1 - c0) mod 3, ours is (c0 - c1) mod
  // 3. It finds the types of the entries' offsets with x in the place of c0.
  const CameraDesign properties = design(camera);
  const int types = static_cast<int>(properties.types.size());
  for (int id = 0; id < 3; ++id) {
    const TypeDesign& type = properties.types[static_cast<std::size_t>(std::min(id, types - 1))];
    double low = std::fabs(type.array.near / type.sensor_distance);
    double high = std::fabs(type.array.far / type.sensor_distance);
    if (low > high) std::swap(low, high);
    // A range through infinity, or beyond the depth resolution of neighbours.
    if (type.array.near * type.array.far < 0 || !std::isfinite(high)) high = 100;
    low = std::clamp(low, 1.0, 99.0);
    high = std::clamp(high, low + 0.1, 100.0);
    pugi::xml_node node = root.append_child("lens_type");
    node.append_attribute("id") = id;
    add_pair(node, "offset", "lens", id == 0 ? 0 : id == 1 ? 1 : -1, 0);
    pugi::xml_node range = node.append_child("depth_range");
    range.append_attribute("units") = "virtual_depth";
    range.append_child("min").text().set(number(low).c_str());
    range.append_child("max").text().set(number(high).c_str());
  }
  job.text(job.settings.name + ".xml", document_text(document));
  job.raw_png(job.settings.name + ".png", 8, 3);
  note_worst(job, grid);
}

void export_pip(const ExportJob& job) {
  const PixelWindow& window = job.field.window;
  const Camera& camera = job.micro.camera();
  const CameraSpec& spec = camera.spec();
  const double p = spec.sensor.pixel_pitch;
  const MicroImageGrid grid = fit_grid(job.micro, window);
  // Pixels are centred on whole numbers there.
  const Vec2 corner{window.x + 0.5, window.y + 0.5};
  const Vec2 axis = Vec2{0.5 * spec.sensor.columns, 0.5 * spec.sensor.rows} - corner;
  const double scale = grid.pitch * p / spec.array.pitch;
  // The reader scales lens centres about the principal point: undo that, so that the micro-images
  // land on the grid.
  const Vec2 lens = axis + (1 / scale) * (grid.origin - corner - axis);
  const auto pair = [](Vec2 v) { return real(v.x) + " " + real(v.y); };

  pugi::xml_document document;
  pugi::xml_node node =
      start(document).append_child("opencv_storage").append_child("MlaDescription");
  const auto add = [&node](const char* name, const std::string& text) {
    node.append_child(name).text().set(text.c_str());
  };
  add("IsHexGrid", "1");
  add("GridRotRAD", real(-grid.rotation));
  add("MlaCenterPX", pair(lens));
  add("SensorResPX", std::to_string(window.width) + " " + std::to_string(window.height));
  add("MicroLensDistancePX", real(grid.pitch / scale));
  add("MainPrincipalPointPX", pair(axis));
  add("MlaImageScale", real(scale));
  add("MicroLensFocalLengthPX", real(camera.microlenses()[0].sensor_distance / p));
  const FirstOrder& main = camera.lens_first_order();
  add("MainLensFLengthMM", real(1e3 * main.focal_length));
  add("MainLensFDistMM", real(1e3 * (camera.lens_distance() - main.rear_principal)));
  add("PixelsizeMM", real(1e3 * p));
  job.text(job.settings.name + ".xml", document_text(document));
  job.raw_png(job.settings.name + ".png", 16, 1);
  note_worst(job, grid);
  if (spec.array.types.size() > 1)
    job.result.notes.push_back(
        "the tool knows one type of microlens; which type a lens has is not in its file");
}

}  // namespace plenoflame
