#include "plenoflame/film/compare.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands/add_option.h"
#include "commands/commands.h"
#include "commands/light_field/compare_lenses.h"
#include "messages.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {
namespace {

struct CompareArguments {
  std::string a;
  std::string reference;
  std::string channel;
  std::string limit;
  LensComparison lenses;
  bool json = false;
};

std::string at_pixel(int column, int row) {
  return " at pixel " + std::to_string(column) + "," + std::to_string(row);
}

std::string errors_text(double count) {
  constexpr double kDecimals = 100;  // beyond them, two decimals say nothing
  return fmt::format("{:+.{}f} standard errors", count + 0.0, std::fabs(count) < kDecimals ? 2 : 0);
}

/// Says what the largest difference in units of its error means, without digits that say nothing.
std::string largest_text(const Comparison& c) {
  if (c.freedom < kFreedomForPixels)
    return fmt::format("not judged: errors from {:g} replicates are too rough for single pixels",
                       c.freedom + 1);
  const std::string size = fmt::format("{:.1f} of its errors", c.largest_z) +
                           at_pixel(c.largest_z_column, c.largest_z_row);
  if (c.largest_z_probability > 0.05) return size + ", as is usual among so many pixels";
  if (c.largest_z_probability < kVerdictProbability) return size + ", more than noise";
  return size +
         fmt::format(", which noise reaches in {:.2g} % of cases", 100 * c.largest_z_probability);
}

/// Mean square of the differences, in units of what the errors let expect (Student's distribution
/// has the variance n / (n - 2)).
std::string pixels_text(const Comparison& c) {
  if (c.freedom < kFreedomForPixels) return largest_text(c);
  const double expected = std::isfinite(c.freedom) ? c.freedom / (c.freedom - 2) : 1;
  return fmt::format("{:.3g} times the expected mean square", c.chi_square / expected);
}

std::string verdict_text(const Comparison& c) {
  switch (verdict(c)) {
    case Verdict::unknown:
      return readable_percent(c.dark_in_one_share) +
             " of the lit pixels are dark in only one image: there are too few rays to know the "
             "noise; no difference beyond it is seen";
    case Verdict::noise:
      return "nothing more than noise is seen";
    case Verdict::more_than_noise:
      return "the images differ by more than noise";
  }
  return "";
}

void add_statistics(Report& report, const Comparison& c) {
  report.add_json("has_standard_errors", c.has_standard_errors);
  if (!c.has_standard_errors) {
    report.add_text("noise", "unknown: neither image holds standard errors");
    return;
  }
  report.add("expected from noise", readable_percent(c.expected_rmse), "expected_rmse",
             c.expected_rmse);
  report.add("bias",
             c.relative_bias_error > 0 ? errors_text(c.relative_bias / c.relative_bias_error)
                                       : "unknown: no noise",
             "relative_bias_error", c.relative_bias_error);
  report.add("single pixels", pixels_text(c), "chi_square", c.chi_square);
  report.add_json("chi_square_pixels", c.chi_square_pixels);
  if (c.freedom >= kFreedomForPixels) report.add_text("largest", largest_text(c));
  report.add_json("largest_z", c.largest_z);
  report.add_json("largest_z_pixel", {c.largest_z_column, c.largest_z_row});
  report.add_json("largest_z_probability", c.largest_z_probability);
  if (std::isfinite(c.freedom)) report.add_json("degrees_of_freedom", c.freedom);
  report.add("neighbours",
             fmt::format("score {:.1f} in {} blocks; above {:g} their differences are alike",
                         c.block_score, c.blocks, kVerdictLimit),
             "block_chi_square", c.block_chi_square);
  report.add_json("blocks", c.blocks);
  report.add_json("block_score", c.block_score);
  report.add_json("dark_in_one_share", c.dark_in_one_share);
  const Verdict decided = verdict(c);
  report.add("verdict", verdict_text(c), "more_than_noise",
             decided == Verdict::unknown ? nlohmann::json()
                                         : nlohmann::json(decided == Verdict::more_than_noise));
}

int run_compare(const CompareArguments& settings) {
  double limit = -1;
  if (!settings.limit.empty()) {
    limit = quantity_option("--limit", settings.limit, Dimension::none);
    if (!(limit >= 0)) throw UsageError("--limit must be a share of at least 0, e.g. 1%");
  }
  const LightField a = read_light_field(settings.a);
  const LightField reference = read_light_field(settings.reference);
  const Comparison c = compare(a, reference, settings.channel);
  if (!c.caution.empty()) warn(c.caution);

  Report report;
  const std::string channel = find_channel(reference, settings.channel).name;
  report.add("channel", channel, "channel", channel);
  report.add("window",
             std::to_string(c.window.width) + " x " + std::to_string(c.window.height) + " at " +
                 std::to_string(c.window.x) + "," + std::to_string(c.window.y),
             "window", {c.window.x, c.window.y, c.window.width, c.window.height});
  report.add("lit pixels", std::to_string(c.lit_pixels), "lit_pixels", c.lit_pixels);
  report.add("mean flux",
             readable_in(c.mean, reference.unit) + ", reference " +
                 readable_in(c.reference_mean, reference.unit),
             "mean_W", c.mean);
  report.add_json("reference_mean_W", c.reference_mean);
  report.add("relative RMSE", readable_percent(c.relative_rmse), "relative_rmse", c.relative_rmse);
  report.add("relative bias",
             readable_percent(c.relative_bias) +
                 (c.has_standard_errors ? " +- " + readable_percent(c.relative_bias_error) : ""),
             "relative_bias", c.relative_bias);
  report.add(
      "largest difference",
      readable_in(c.largest_difference, reference.unit) + at_pixel(c.largest_column, c.largest_row),
      "largest_difference_W", c.largest_difference);
  report.add_json("largest_difference_pixel", {c.largest_column, c.largest_row});
  report.add("flux in unlit pixels", readable_percent(c.stray_share), "stray_share", c.stray_share);
  add_statistics(report, c);
  if (settings.lenses.asked())
    compare_lenses(a, reference, channel, settings.reference, settings.lenses, report);
  print(report, settings.json);
  if (limit < 0 || c.relative_rmse <= limit) return kSuccess;
  throw Error("the relative RMSE of " + readable_percent(c.relative_rmse) +
              " exceeds the limit of " + readable_percent(limit));
}

}  // namespace

void register_compare(const Registry& registry) {
  auto settings = std::make_shared<CompareArguments>();
  CLI::App& command = add_command(
      registry, "compare", "Compare two light fields: error, bias, and whether noise explains them",
      "plenoflame compare fast.exr converged.exr --limit 1%");
  command.add_option("A", settings->a, "Light field (.exr) to judge")->required();
  command
      .add_option(
          "REFERENCE", settings->reference,
          "Light field (.exr) to compare with; pixels above 1 % of the largest value are lit")
      ->required();
  add_option(command, "--channel", settings->channel, "NAME",
             "Channel; without it, the reference's first");
  add_option(command, "--limit", settings->limit, "SHARE",
             "Fail (status 1) when the relative RMSE over lit pixels exceeds this, e.g. 1%");
  command.add_flag("--by-lens", settings->lenses.wanted,
                   "Subpixel shift and gain of A, overall and for each micro-image");
  add_option(command, "--lenses", settings->lenses.csv, "FILE.csv",
             "Like --by-lens, with a table of all micro-images: gain, shift and residual")
      ->check(written());
  add_option(command, "--map", settings->lenses.map, "FILE.png",
             "Like --by-lens, with a picture of the residual: red where A is brighter, full colour "
             "at a tenth of the brightest light")
      ->check(written());
  command.add_flag("--json", settings->json, "Print the figures as JSON");
  on_chosen(command, registry, [settings] { return run_compare(*settings); });
}

}  // namespace plenoflame::cli
