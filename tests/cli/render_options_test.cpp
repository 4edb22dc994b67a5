#include "commands/render/render_options.h"
#include "commands/render/run_record.h"

#include <gtest/gtest.h>
#include <CLI/CLI.hpp>

#include "plenoflame/base/error.h"
#include "support/temporary_folder.h"

namespace plenoflame::cli::render_options_test {
namespace {

RenderOptions parse(std::vector<std::string> line) {
  CLI::App app;
  RenderArguments arguments;
  add_render_options(app, arguments);
  line.insert(line.begin(), "flames/candle.toml");
  std::reverse(line.begin(), line.end());
  app.parse(line);
  return checked_options(arguments);
}

TEST(RenderOptions, NothingGivenLeavesTheScene) {
  const RenderOptions options = parse({});
  EXPECT_EQ(options.scene, "flames/candle.toml");
  EXPECT_EQ(options.output, "candle.exr");
  EXPECT_FALSE(options.samples || options.target_error || options.time_limit || options.estimator ||
               options.seed || options.window);
  EXPECT_EQ(options.threads, 0);
  EXPECT_TRUE(options.skip);
  EXPECT_FALSE(options.quiet || options.json);
  EXPECT_TRUE(options.stats.empty() && options.resume.empty());
}

TEST(RenderOptions, EverythingGiven) {
  const RenderOptions options = parse({"-o",
                                       "out/a.exr",
                                       "--samples",
                                       "1e3",
                                       "--target-error",
                                       "0.5 %",
                                       "--time-limit",
                                       "2min",
                                       "--estimator",
                                       "forward",
                                       "--threads",
                                       "3",
                                       "--seed",
                                       "18446744073709551615",
                                       "--window",
                                       "1,2,30,40",
                                       "--stats",
                                       "s.json",
                                       "--resume",
                                       "b.exr",
                                       "--quiet",
                                       "--no-skip",
                                       "--json"});
  EXPECT_EQ(options.output, "out/a.exr");
  EXPECT_EQ(options.samples, 1000);
  EXPECT_EQ(options.target_error, 0.005);
  EXPECT_EQ(options.time_limit, 120);
  EXPECT_EQ(options.estimator, Estimator::forward);
  EXPECT_EQ(options.threads, 3);
  EXPECT_EQ(options.seed, 18446744073709551615ULL);
  EXPECT_EQ(options.window, (PixelWindow{1, 2, 30, 40}));
  EXPECT_EQ(options.stats, "s.json");
  EXPECT_EQ(options.resume, "b.exr");
  EXPECT_FALSE(options.skip);
  EXPECT_TRUE(options.quiet && options.json);
}

TEST(RenderOptions, RefusesWhatMakesNoSense) {
  const auto refused = [](std::vector<std::string> line, const std::string& part) {
    try {
      parse(line);
      ADD_FAILURE() << line.back();
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  for (const char* target : {"0", "0%", "100%", "1", "2", "-1%", "nan"})
    refused({std::string("--target-error=") + target}, "--target-error");
  for (const char* limit : {"0s", "0", "60", "-1s", "inf s", "1 mm"})
    refused({std::string("--time-limit=") + limit}, "--time-limit");
  for (const char* samples : {"0", "-1", "1.5", "1e10", "64x", "1e-3"})
    refused({std::string("--samples=") + samples}, "--samples takes a whole number from 1");
  for (const char* seed : {"-1", "x", "18446744073709551616", "0.5"})
    refused({std::string("--seed=") + seed}, "--seed takes a whole number from 0");
  refused({"--window", "0,0,0,5"}, "--window");
  refused({"-o", "a.png"}, "develop");
  refused({"-o", "flames/candle.exr", "--stats", "flames/candle.exr"}, "--stats");
}

TEST(RenderOptions, UnwritableFilesAreFoundBeforeRendering) {
  const test::TemporaryFolder folder;
  RenderOptions options = parse({"-o", folder.file("a.exr")});
  check_files(options);
  EXPECT_TRUE(folder.names().empty());
  options.output = folder.file("none/a.exr");
  EXPECT_THROW(check_files(options), FileError);
  options.output = folder.file("a.exr");
  options.stats = folder.file("none/s.json");
  EXPECT_THROW(check_files(options), FileError);
  options.stats.clear();
  options.scene.clear();
  options.resume = folder.file("b.exr");
  EXPECT_THROW(read_continuation(options), FileError);
}

TEST(RenderOptions, WindowLiesOnTheSensor) {
  RenderOptions options = parse({"--window", "90,40,10,10"});
  check_window(options, {100, 50, 1e-5});
  EXPECT_THROW(check_window(options, {99, 50, 1e-5}), UsageError);
  EXPECT_THROW(check_window(options, {100, 49, 1e-5}), UsageError);
  options.window = PixelWindow{2147483647, 0, 2147483647, 1};
  EXPECT_THROW(check_window(options, {100, 50, 1e-5}), UsageError);
}

}  // namespace
}  // namespace plenoflame::cli::render_options_test
