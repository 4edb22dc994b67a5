#include "commands/scene/info.h"

#include <nlohmann/json.hpp>
#include "options.h"
#include "plenoflame/volumes/vdb_info.h"

namespace plenoflame::cli {
namespace {

std::string point_text(Vec3 p) {
  return "(" + readable_point(p) + ")";
}

std::string grid_text(const GridInfo& grid) {
  std::string text = grid.value_type + (grid.half ? " (16 bits)" : "");
  if (grid.active_voxels == 0) return text + ", no active voxels";
  text += ", " + std::to_string(grid.active_voxels) + " active voxels";
  const std::string unit = grid.unit.empty() ? " (no unit)" : " " + grid.unit;
  if (grid.readable)
    text += " of " + readable(grid.voxel_size, Dimension::length) + ", " +
            readable_number(grid.minimum) + " to " + readable_number(grid.maximum) + unit +
            ", background " + readable_number(grid.background) + unit;
  if (!grid.world_bounds.empty()) {
    text += ", from ";
    text += point_text(grid.world_bounds.lower);
    text += " to ";
    text += point_text(grid.world_bounds.upper);
  }
  return text;
}

nlohmann::json grid_json(const GridInfo& grid) {
  const auto vector = [](Vec3 v) { return nlohmann::json{v.x, v.y, v.z}; };
  nlohmann::json json{{"name", grid.name},           {"value_type", grid.value_type},
                      {"readable", grid.readable},   {"half", grid.half},
                      {"unit", grid.unit},           {"class", grid.grid_class},
                      {"metadata", grid.metadata},   {"transform_type", grid.transform_type},
                      {"voxels", grid.active_voxels}};
  if (!grid.readable) return json;
  json["background"] = grid.background;
  json["minimum"] = grid.minimum;
  json["maximum"] = grid.maximum;
  json["voxel_size_m"] = grid.voxel_size;
  const auto& rows = grid.index_to_world.linear.rows;
  json["index_to_world"] = {{"linear", {vector(rows[0]), vector(rows[1]), vector(rows[2])}},
                            {"translation_m", vector(grid.index_to_world.translation)}};
  if (grid.world_bounds.empty()) return json;
  json["index_lower"] = grid.index_lower;
  json["index_upper"] = grid.index_upper;
  json["lower_m"] = vector(grid.world_bounds.lower);
  json["upper_m"] = vector(grid.world_bounds.upper);
  return json;
}

}  // namespace

void describe_vdb(const std::string& path, Report& report) {
  const VdbInfo info = vdb_info(path);
  report.add("type", "flame", "type", "flame");
  report.add_json("size_bytes", info.file_size);
  nlohmann::json grids = nlohmann::json::array();
  for (const GridInfo& grid : info.grids) {
    report.add_text("grid " + grid.name, grid_text(grid));
    grids.push_back(grid_json(grid));
  }
  report.add_json("grids", grids);
  const auto add_source = [&](const std::string& label, const std::string& grid) {
    report.add_json(label + "_grid", grid);
    if (!info.emission_alone) report.add_text(label + " from", grid.empty() ? "none" : grid);
  };
  add_source("temperature", info.temperature_grid);
  add_source("absorption", info.absorption_grid);
  nlohmann::json lines = nlohmann::json::array();
  for (const VdbInfo::Line& line : info.lines) {
    report.add_text("emission line from", line.grid + " (kind = \"" + line.kind + "\")");
    lines.push_back({{"grid", line.grid}, {"kind", line.kind}});
  }
  report.add_json("lines", lines);
  for (const std::string& remark : info.remarks) report.add_text("remark", remark);
  report.add_json("remarks", info.remarks);
}

}  // namespace plenoflame::cli
