#include "options.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include <limits>

#include "commands/command.h"
#include "inverse_settings.h"
#include "plenoflame/base/error.h"

namespace plenoflame::cli::options_test {
namespace {

TEST(Options, Window) {
  EXPECT_EQ(window_option("--window", "1,2,30,40"), (PixelWindow{1, 2, 30, 40}));
  EXPECT_EQ(window_option("--window", "0,0,1,1"), (PixelWindow{0, 0, 1, 1}));
  for (const char* wrong :
       {"", ",", "1,2,3", "1,2,3,4,", "1,2,3,4,5", "1, 2,3,4", "a,2,3,4", "1,2,3,4x", "1.5,2,3,4",
        "-1,2,3,4", "1,2,0,4", "1,2,3,-4", "1;2;3;4", "1,2,3,99999999999"})
    EXPECT_THROW(window_option("--window", wrong), UsageError) << wrong;
}

TEST(Options, QuantityNamesTheOption) {
  EXPECT_EQ(quantity_option("--time-limit", "2min", Dimension::time), 120);
  try {
    quantity_option("--time-limit", "2", Dimension::time);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("--time-limit: ", 0), 0U) << error.what();
  }
}

TEST(Options, Durations) {
  const auto seconds = [](const char* text) { return duration_option("--time", text); };
  EXPECT_EQ(seconds("10m"), 600);
  EXPECT_EQ(seconds("10 m"), 600);
  EXPECT_EQ(seconds("1.5min"), 90);
  EXPECT_EQ(seconds("90s"), 90);
  EXPECT_EQ(seconds("2h"), 7200);
  EXPECT_EQ(seconds("20ms"), 0.02);
  EXPECT_EQ(seconds("1-02:03:04"), 86400 + 2 * 3600 + 3 * 60 + 4);
  EXPECT_EQ(seconds("1-02:03"), 86400 + 2 * 3600 + 3 * 60);
  EXPECT_EQ(seconds("2-12"), 2.5 * 86400);
  EXPECT_EQ(seconds("36:00:00"), 36 * 3600);
  EXPECT_EQ(seconds("90:30"), 5430);
  for (const char* wrong :
       {"", "10", "10km", "m", "1:2:3:4", ":10", "10:", "1-", "-1-00:00:00", "1:60", "1:60:00",
        "1-24:00:00", "1-2-3", "1.5:00", "a:10", "1e3:00", "1:-5"})
    EXPECT_THROW(duration_option("--time", wrong), UsageError) << wrong;
}

TEST(Options, NearestName) {
  const std::vector<std::string> names{"render", "refocus", "info", "views"};
  EXPECT_EQ(nearest_name("rendr", names), "render");
  EXPECT_EQ(nearest_name("redner", names), "render");
  EXPECT_EQ(nearest_name("inof", names), "info");
  EXPECT_EQ(nearest_name("view", names), "views");
  EXPECT_EQ(nearest_name("bench", names), "");
  EXPECT_EQ(nearest_name("", names), "");
}

TEST(Options, ReadableHasFourDigits) {
  EXPECT_EQ(readable(1.23456e-6, Dimension::length), "1.235 um");
  EXPECT_EQ(readable(4999.6e-9, Dimension::flux), "5 uW");
  EXPECT_EQ(readable_percent(0.0123456), "1.235 %");
  EXPECT_EQ(readable(std::numeric_limits<double>::infinity(), Dimension::length), "inf");
}

TEST(Options, ReadablePointsHaveOneUnit) {
  EXPECT_EQ(readable_point({0.75, 0, -0.016}), "750 mm, 0 mm, -16 mm");
  EXPECT_EQ(readable_point({-1.25, 0.03, 0}), "-1.25 m, 0.03 m, 0 m");
  EXPECT_EQ(readable_point({0, 0, 0}), "0 m, 0 m, 0 m");
  EXPECT_EQ(readable_point({2e-6, -3e-9, 0}), "2 um, -0.003 um, 0 um");
}

TEST(Options, MissingPart) {
  CLI::App app;
  app.name("plenoflame");
  add_missing(app, "picture", "VTK", "Draw a scene");
  EXPECT_NE(app.get_subcommand("picture")->get_description().find("(needs VTK, which"),
            std::string::npos);
  const char* const arguments[] = {"plenoflame", "picture", "a.toml", "--view", "flame", "-o", "a"};
  try {
    app.parse(7, arguments);
    FAIL();
  } catch (const UsageError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.rfind("'picture' needs VTK, which this build was made without; get it with "
                         "tools/setup.sh python && cmake --preset python",
                         0),
              0U)
        << text;
  }
}

TEST(Options, SettingsAreValuesAndTextsOfThem) {
  UnknownsRequest unknowns;
  OperatorRequest request;
  for (const auto& [name, text] :
       {std::pair{"grid", "4,5,6"}, {"center", "1 m, -2 mm, 0.1 m"}, {"size", "auto"}})
    EXPECT_TRUE(set_setting(unknowns, {}, name, text));
  EXPECT_EQ(unknowns.grid, (std::vector{4, 5, 6}));
  EXPECT_FALSE(unknowns.size);
  EXPECT_TRUE(set_setting(request, {}, "bin", "view"));
  UnknownsRequest again;
  for (const auto& row : setting_rows<UnknownsRequest>())
    if (const std::string text = text_of_row(row, unknowns); !text.empty())
      set_setting(again, {}, std::string(row.name), text);
  EXPECT_EQ(again.grid, unknowns.grid);
  ASSERT_TRUE(again.centre);
  EXPECT_EQ(again.centre->y, -2e-3);
  EXPECT_EQ(again.kind, UnknownKind::voxels);
  for (const auto& row : setting_rows<OperatorRequest>())
    EXPECT_TRUE(row.name != "bin" || text_of_row(row, request) == "view");
  EXPECT_THROW(set_setting(unknowns, {}, "grid", "4,0"), UsageError);
  EXPECT_THROW(set_setting(unknowns, {}, "center", "1 m, 2 m"), UsageError);
  EXPECT_THROW(set_setting(request, {}, "bin", "views"), UsageError);
}

}  // namespace
}  // namespace plenoflame::cli::options_test
