#include "figures_json.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <variant>

#include "plenoflame/base/execution.h"
#include "plenoflame/base/report.h"
#include "plenoflame/camera/design.h"
#include "plenoflame/camera/resolution.h"
#include "plenoflame/film/compare.h"
#include "plenoflame/scene/design_report.h"
#include "plenoflame/scene/scene_schema.h"

namespace plenoflame {

std::string design_json(const Scene& scene) {
  std::vector<std::string> warnings;
  const Camera camera(scene.camera, &warnings);
  const CameraDesign figures = design(camera);
  warnings.insert(warnings.end(), figures.warnings.begin(), figures.warnings.end());
  Report report;
  add_design(camera, figures, design_curve(camera, scene), report);
  report.add_json("warnings", warnings);
  return report.json_text();
}

std::string value_json(const Scene& scene, const std::string& path) {
  const std::string text = get_text(scene, path);  // refuses what is not there
  const ParsedPath parsed = parse_path(path);
  const SchemaKey& key = *find_schema_key(parsed.schema_path);
  const auto json = [](const auto& value) -> nlohmann::json {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, Vec2>)
      return {value.x, value.y};
    else if constexpr (std::is_same_v<Value, Vec3>)
      return {value.x, value.y, value.z};
    else if constexpr (std::is_same_v<Value, double>)
      // JSON has no infinity; the text has.
      return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
    else
      return value;
  };
  return nlohmann::json{{"value", std::visit(json, key.get(scene, parsed.indices))},
                        {"unit", si_unit(key.dimension)},
                        {"text", text}}
      .dump();
}

std::string comparison_json(const LightField& field, const LightField& reference,
                            const std::string& channel, const Execution& execution) {
  const Comparison c = compare(field, reference, channel);
  if (!c.caution.empty()) execution.warn(c.caution);
  nlohmann::ordered_json figures{
      {"window", {c.window.x, c.window.y, c.window.width, c.window.height}},
      {"lit_pixels", c.lit_pixels},
      {"mean_W", c.mean},
      {"reference_mean_W", c.reference_mean},
      {"relative_rmse", c.relative_rmse},
      {"relative_bias", c.relative_bias},
      {"largest_difference_W", c.largest_difference},
      {"has_standard_errors", c.has_standard_errors}};
  if (c.has_standard_errors) {
    figures["relative_bias_error"] = c.relative_bias_error;
    figures["expected_rmse"] = c.expected_rmse;
  }
  return figures.dump();
}

}  // namespace plenoflame
