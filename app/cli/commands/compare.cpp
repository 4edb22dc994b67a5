#include "plenoflame/film/compare.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <memory>

#include "commands/commands.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {
namespace {

struct Settings {
  std::string a;
  std::string reference;
  std::string channel;
  std::string limit;
  bool json = false;
};

std::string at_pixel(int column, int row) {
  return " at pixel " + std::to_string(column) + "," + std::to_string(row);
}

void add_statistics(Report& report, const Comparison& c) {
  report.add_json("has_standard_errors", c.has_standard_errors);
  if (!c.has_standard_errors) {
    report.add_text("noise", "unknown: neither image holds standard errors");
    return;
  }
  report.add_json("dark_in_one_share", c.dark_in_one_share);
  if (c.dark_in_one_share > 0.01)
    report.add_text("dark in one only",
                    readable_percent(c.dark_in_one_share) +
                        " of the lit pixels: if rays are few there, the noise is underestimated");
  report.add("expected from noise", readable_percent(c.expected_rmse), "expected_rmse",
             c.expected_rmse);
  report.add("bias / its error",
             c.relative_bias_error > 0 ? readable_number(c.relative_bias / c.relative_bias_error)
                                       : "unknown: no noise",
             "relative_bias_error", c.relative_bias_error);
  report.add("largest / error",
             readable_number(c.largest_z) + at_pixel(c.largest_z_column, c.largest_z_row) +
                 ", probability " + readable_number(c.largest_z_probability),
             "largest_z", c.largest_z);
  report.add_json("largest_z_pixel", {c.largest_z_column, c.largest_z_row});
  report.add_json("largest_z_probability", c.largest_z_probability);
  if (std::isfinite(c.freedom)) report.add_json("degrees_of_freedom", c.freedom);
  report.add("chi-square, pixels",
             readable_number(c.chi_square) + " over " + std::to_string(c.chi_square_pixels),
             "chi_square", c.chi_square);
  report.add_json("chi_square_pixels", c.chi_square_pixels);
  report.add("chi-square, blocks",
             readable_number(c.block_chi_square) + " over " + std::to_string(c.blocks) +
                 ", score " + readable_number(c.block_score) + " (above 5: more than noise)",
             "block_chi_square", c.block_chi_square);
  report.add_json("blocks", c.blocks);
  report.add_json("block_score", c.block_score);
}

int run_compare(const Settings& settings) {
  double limit = -1;
  if (!settings.limit.empty()) {
    limit = quantity_option("--limit", settings.limit, Dimension::none);
    if (!(limit >= 0)) throw UsageError("--limit: a share that is not negative, e.g. 1%");
  }
  const LightField a = read_light_field(settings.a);
  const LightField reference = read_light_field(settings.reference);
  const Comparison c = compare(a, reference, settings.channel);

  Report report;
  const std::string channel = find_channel(reference, settings.channel).name;
  report.add("channel", channel, "channel", channel);
  report.add("window",
             std::to_string(c.window.width) + " x " + std::to_string(c.window.height) + " at " +
                 std::to_string(c.window.x) + "," + std::to_string(c.window.y),
             "window", {c.window.x, c.window.y, c.window.width, c.window.height});
  report.add("lit pixels", std::to_string(c.lit_pixels), "lit_pixels", c.lit_pixels);
  report.add("mean flux",
             readable(c.mean, Dimension::flux) + ", reference " +
                 readable(c.reference_mean, Dimension::flux),
             "mean_W", c.mean);
  report.add_json("reference_mean_W", c.reference_mean);
  report.add("relative RMSE", readable_percent(c.relative_rmse), "relative_rmse", c.relative_rmse);
  report.add("relative bias",
             readable_percent(c.relative_bias) +
                 (c.has_standard_errors ? " +- " + readable_percent(c.relative_bias_error) : ""),
             "relative_bias", c.relative_bias);
  report.add(
      "largest difference",
      readable(c.largest_difference, Dimension::flux) + at_pixel(c.largest_column, c.largest_row),
      "largest_difference_W", c.largest_difference);
  report.add_json("largest_difference_pixel", {c.largest_column, c.largest_row});
  report.add("flux in unlit pixels", readable_percent(c.stray_share), "stray_share", c.stray_share);
  add_statistics(report, c);
  report.print(settings.json);
  if (limit < 0 || c.relative_rmse <= limit) return kSuccess;
  throw Error("the relative RMSE of " + readable_percent(c.relative_rmse) +
              " exceeds the limit of " + readable_percent(limit));
}

}  // namespace

void register_compare(const Registry& registry) {
  auto settings = std::make_shared<Settings>();
  CLI::App& command = add_command(
      registry, "compare", "Compare two light fields: error, bias, and whether noise explains them",
      "plenoflame compare fast.exr converged.exr --limit 1%");
  command.add_option("A", settings->a, "Light field (.exr) to judge")->required();
  command
      .add_option(
          "REFERENCE", settings->reference,
          "Light field (.exr) that it should equal; pixels above 1 % of its largest flux are lit")
      ->required();
  command.add_option("--channel", settings->channel, "Channel; without it, the reference's first")
      ->option_text("NAME");
  command
      .add_option("--limit", settings->limit,
                  "Fail (status 1) when the relative RMSE, sqrt(mean((A - REFERENCE)^2)) / "
                  "mean(REFERENCE) over lit pixels, exceeds this, e.g. 1%")
      ->option_text("SHARE");
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry, [settings] { return run_compare(*settings); });
}

}  // namespace plenoflame::cli
