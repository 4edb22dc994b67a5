#include "plenoflame/scene/timeline.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "plenoflame/scene/validate.h"
#include "support/approx.h"
#include "support/temporary_folder.h"

namespace plenoflame::timeline_test {
namespace {

using test::TemporaryFolder;
using test::write_bytes;

/// A folder with a series of files, empty ones: what is in them does not matter here.
class Timeline : public ::testing::Test {
 protected:
  void files(int first, int last) {
    for (int i = first; i <= last; ++i) file(i);
  }
  std::string file(int number) {
    char name[32];
    std::snprintf(name, sizeof name, "run_%04d.vdb", number);
    write_bytes(folder_.file(name), "");
    return name;
  }
  SceneDocument scene(const std::string& flame, const std::string& sensor = "") {
    return parse_scene("[camera]\npreset = \"paper-previous-60x60\"\n[camera.sensor]\n" + sensor +
                           "\n[[flames]]\nkind = \"vdb\"\nname = \"run\"\nposition = [\"1 m\", \"0 "
                           "m\", \"0 m\"]\n" +
                           flame,
                       folder_.file("s.toml"));
  }
  SceneDocument series(const std::string& more = "", const std::string& sensor = "") {
    return scene("file = \"run_####.vdb\"\nframe_rate = \"1 kHz\"\n" + more, sensor);
  }
  /// The line that a table of this text is refused with, from its line number on.
  std::string table_error(const std::string& text) {
    write_bytes(folder_.file("t.csv"), text);
    return error_of([&] { SceneTimeline(scene("file = \"a.vdb\"\ntime_table = \"t.csv\"\n")); });
  }
  template <class Call>
  std::string error_of(Call&& call) {
    try {
      call();
    } catch (const Error& error) {
      std::string text = error.what();
      for (std::size_t at; (at = text.find(folder_.path() + "/")) != std::string::npos;)
        text.erase(at, folder_.path().size() + 1);
      return text;
    }
    return "";
  }

  TemporaryFolder folder_;
};

std::string name_at(const SceneTimeline& timeline, int frame) {
  return timeline.at_frame(frame).flames[0].file;
}

TEST_F(Timeline, FramesAreFiles) {
  files(3, 7);
  write_bytes(folder_.file("run_12.vdb"), "");     // too few digits
  write_bytes(folder_.file("run_0008.vdb~"), "");  // another name
  const SceneTimeline timeline(series());
  EXPECT_EQ(timeline.first_frame(), 3);
  EXPECT_EQ(timeline.last_frame(), 7);
  EXPECT_EQ(timeline.frame_rate(), 1000);
  for (int i = 3; i <= 7; ++i)
    EXPECT_EQ(name_at(timeline, i), "run_000" + std::to_string(i) + ".vdb");
  // Nothing of the time is left: what follows is as with this file alone.
  Scene alone = scene("file = \"run_0005.vdb\"\n").scene;
  EXPECT_EQ(timeline.at_frame(5), alone);
  EXPECT_EQ(first_moment(series().scene).flames[0].file, "run_0003.vdb");
  EXPECT_EQ(SceneTimeline(series("first_frame = 5\n")).first_frame(), 5);
  EXPECT_FALSE(changes_with_time(alone));
}

// Numbers beyond the digits of the pattern make the names longer.
TEST_F(Timeline, LongNumbers) {
  for (const int number : {9998, 9999, 10000, 10001}) file(number);
  const SceneTimeline timeline(series());
  EXPECT_EQ(timeline.last_frame(), 10001);
  EXPECT_EQ(name_at(timeline, 10000), "run_10000.vdb");
}

// A frame's own time, made of decimal numbers, is its begin for rates of all kinds.
TEST_F(Timeline, EveryFrameOfOddRatesIsItsOwn) {
  files(0, 2999);
  for (const char* rate : {"29.97 Hz", "3 Hz", "7 kHz", "1.1 MHz", "0.3 Hz"}) {
    const SceneTimeline timeline(
        scene("file = \"run_####.vdb\"\nframe_rate = \"" + std::string(rate) + "\"\n"));
    const double hertz = timeline.frame_rate();
    for (int i = 0; i < 3000; i += 7) {
      char name[32];
      std::snprintf(name, sizeof name, "run_%04d.vdb", i);
      ASSERT_EQ(name_at(timeline, i), name) << rate;
      ASSERT_EQ(timeline.at_time(i / hertz).flames[0].file, name) << rate;
      ASSERT_EQ(timeline.at_time((i + 0.999) / hertz).flames[0].file, name) << rate;
    }
  }
}

// Shares by hand: 1.6 ms from 2.5 ms on are 0.5 ms of file 3, all of 4, 0.1 ms of 5.
TEST_F(Timeline, AnExposureIsSharedByItsFiles) {
  files(1, 10);
  const SceneTimeline timeline(
      series("", "exposure_begin = \"0.5 ms\"\nexposure_time = \"1.6 ms\"\n"));
  const std::vector<SceneMoment> moments = timeline.exposure_of_frame(3);
  ASSERT_EQ(moments.size(), 3u);
  const double shares[] = {0.5 / 1.6, 1 / 1.6, 0.1 / 1.6};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(moments[i].scene.flames[0].file, "run_000" + std::to_string(3 + i) + ".vdb");
    EXPECT_TRUE(test::relative(moments[i].share, shares[i], 1e-12));
  }
  EXPECT_EQ(timeline.last_frame(), 8);  // 8.5 ms + 1.6 ms is beyond 10 ms
  // An exposure as long as a file lasts is that file alone.
  const SceneTimeline whole(series("", "exposure_time = \"1 ms\"\n"));
  for (int frame = 1; frame <= 10; ++frame) {
    const auto one = whole.exposure_of_frame(frame);
    ASSERT_EQ(one.size(), 1u) << frame;
    EXPECT_EQ(one.front().share, 1);
    EXPECT_EQ(one.front().scene.flames[0].file,
              "run_00" + std::string(frame < 10 ? "0" : "") + std::to_string(frame) + ".vdb");
  }
}

TEST_F(Timeline, TheCameraHasItsOwnRate) {
  files(1, 100);  // 100 ms
  const SceneTimeline timeline(series("", "frame_rate = \"50 Hz\"\n"));
  EXPECT_EQ(timeline.first_frame(), 1);
  EXPECT_EQ(timeline.last_frame(), 5);
  EXPECT_EQ(name_at(timeline, 3), "run_0041.vdb");  // 40 ms
  EXPECT_EQ(timeline.frame_at(0.0401), 3);
  EXPECT_EQ(timeline.frame_at(0.0399), 2);
}

TEST_F(Timeline, ATableIsInterpolated) {
  write_bytes(folder_.file("t.csv"),
              "# a burner on a slide\ntime [ms]; x (mm); z_mm ;brightness;scale\n"
              "0; 1000; -10; 1; 1\n\n2;1004;-20; 0.5;2 # half as bright\n4;1004;-20;0;2\n");
  const SceneTimeline timeline(
      scene("file = \"a.vdb\"\ntime_table = \"t.csv\"\n", "frame_rate = \"1 kHz\"\n"));
  EXPECT_EQ(timeline.first_frame(), 0);
  EXPECT_EQ(timeline.last_frame(), 4);
  const struct {
    double time, x, z, brightness, scale;
  } rows[] = {{0, 1, -0.01, 1, 1},
              {0.5e-3, 1.001, -0.0125, 0.875, 1.25},
              {2e-3, 1.004, -0.02, 0.5, 2},
              {3e-3, 1.004, -0.02, 0.25, 2},
              {4e-3, 1.004, -0.02, 0, 2}};
  for (const auto& row : rows) {
    const FlameSpec flame = timeline.at_time(row.time).flames[0];
    EXPECT_TRUE(test::relative(flame.position.x, row.x, 1e-14)) << row.time;
    EXPECT_TRUE(test::relative(flame.position.z, row.z, 1e-14)) << row.time;
    EXPECT_TRUE(test::relative(flame.brightness, row.brightness, 1e-14)) << row.time;
    EXPECT_TRUE(test::relative(flame.scale, row.scale, 1e-14)) << row.time;
    EXPECT_EQ(flame.position.y, 0);  // no column: as the scene says
  }
}

// Midpoints of a straight line have its mean.
TEST_F(Timeline, AnExposureOfATableIsDivided) {
  write_bytes(folder_.file("t.csv"), "time [ms],brightness\n0,1\n10,2\n20,2\n");
  const SceneTimeline timeline(
      scene("file = \"a.vdb\"\ntime_table = \"t.csv\"\n",
            "frame_rate = \"100 Hz\"\nexposure_time = \"8 ms\"\nexposure_steps = 5\n"));
  const auto moments = timeline.exposure_of_frame(0);
  ASSERT_EQ(moments.size(), 5u);
  double mean = 0, shares = 0;
  for (const SceneMoment& moment : moments) {
    mean += moment.share * moment.scene.flames[0].brightness;
    shares += moment.share;
  }
  EXPECT_TRUE(test::relative(shares, 1, 1e-14));
  EXPECT_TRUE(test::relative(mean, 1.4, 1e-14));
  EXPECT_EQ(timeline.exposure_of_frame(1).size(), 1u);  // nothing changes there
  // Moments that are alike become one: the first half of these 8 ms, then two quarters.
  write_bytes(folder_.file("t.csv"), "time [ms],brightness\n0,1\n4,1\n8,2\n");
  const auto half = SceneTimeline(scene("file = \"a.vdb\"\ntime_table = \"t.csv\"\n",
                                        "exposure_time = \"8 ms\"\nexposure_steps = 4\n"))
                        .exposure(0);
  ASSERT_EQ(half.size(), 3u);
  EXPECT_TRUE(test::relative(half[0].share, 0.5, 1e-14));
  EXPECT_TRUE(test::relative(half[2].share, 0.25, 1e-14));
}

TEST_F(Timeline, WhatASeriesCanLack) {
  files(1, 9);
  for (const int gone : {4, 7})
    std::filesystem::remove(folder_.file("run_000" + std::to_string(gone) + ".vdb"));
  const SceneTimeline timeline(series());
  EXPECT_EQ(timeline.flames()[0].missing, (std::vector<int>{4, 7}));
  EXPECT_EQ(timeline.flames()[0].first_file, "run_0001.vdb");
  EXPECT_EQ(SceneTimeline(series("first_frame = 4\n")).flames()[0].first_file, "run_0005.vdb");
  EXPECT_EQ(error_of([&] { timeline.at_frame(4); }),
            "s.toml:9:8: the series \"run_####.vdb\" lacks the file \"run_0004.vdb\"");
  EXPECT_EQ(timeline.missing_files(1, 9, 1),
            (std::vector<std::string>{"run_0004.vdb", "run_0007.vdb"}));
  EXPECT_EQ(timeline.missing_files(1, 9, 2), (std::vector<std::string>{"run_0007.vdb"}));
  EXPECT_EQ(error_of([&] { timeline.at_frame(10); }),
            "s.toml:5:1: there is no frame 10: the flames are known until 9 ms, for frames 1 to 9");
  EXPECT_EQ(error_of([&] { timeline.at_time(9e-3); }),
            "s.toml:9:8: 9 ms is beyond the end of the series \"run_####.vdb\", whose files 1 to 9 "
            "last until 9 ms");
  EXPECT_NE(error_of([&] { timeline.at_time(-1e-3); }).find("before the beginning of"),
            std::string::npos);
  EXPECT_EQ(error_of([&] { SceneTimeline(series("first_frame = 20\n")); }),
            "s.toml:9:8: there is no file \"run_####.vdb\" with a number from 20");
  EXPECT_NE(error_of([&] {
              SceneTimeline(scene("file = \"none/run_####.vdb\"\nframe_rate = \"1 Hz\"\n"));
            }).find("cannot read the folder"),
            std::string::npos);
  // An exposure that is longer than all that is known.
  const SceneTimeline longer(series("", "exposure_time = \"10 ms\"\n"));
  EXPECT_NE(error_of([&] { longer.at_frame(1); }).find("is shorter than an exposure"),
            std::string::npos);
}

TEST_F(Timeline, WhatATableMayNotBe) {
  EXPECT_EQ(table_error(""),
            "t.csv: the table is empty; its first line names the columns, such as \"time [ms], x "
            "[mm], brightness\"");
  EXPECT_EQ(table_error("time [ms],x [mm]\n"), "t.csv: the table has no rows");
  EXPECT_EQ(table_error("time [ms],x [mm]\n0,1\n1,nan\n"),
            "t.csv:3:3: x is \"nan\"; it must be a finite number");
  EXPECT_EQ(table_error("time [ms],x [mm]\n0, one\n"),
            "t.csv:2:4: x is \"one\"; it must be a finite number");
  EXPECT_EQ(table_error("time [ms],x [mm]\n0,\n"),
            "t.csv:2:3: x is missing; it must be a finite number");
  EXPECT_EQ(table_error("time [ms],x [mm]\n1,1\n0.5,1\n"),
            "t.csv:3:1: the times must increase, but 500 us follows 1 ms");
  EXPECT_EQ(table_error("time [ms],x [mm]\n1,1\n1,2\n"),
            "t.csv:3:1: the times must increase, but 1 ms follows 1 ms");
  EXPECT_EQ(table_error("time [ms],x [mm]\n1,1,1\n"),
            "t.csv:2: the row has 3 cells, and the header 2");
  EXPECT_NE(table_error("time [ms],w [mm]\n").find("t.csv:1:11: unknown column \"w [mm]\""),
            std::string::npos);
  EXPECT_NE(table_error("0,1\n1,2\n").find("t.csv:1:1: unknown column \"0\""), std::string::npos);
  EXPECT_NE(table_error("x [mm],time [ms]\n").find("the first column must be the time"),
            std::string::npos);
  EXPECT_NE(table_error("time,x [mm]\n").find("t.csv:1:1: column \"time\" needs a unit (s, ms"),
            std::string::npos);
  EXPECT_NE(table_error("time [ms],x [s]\n").find("column \"x\" has the unit \"s\""),
            std::string::npos);
  EXPECT_NE(table_error("time [ms],x [mm],x [m]\n").find("t.csv:1:18: column \"x\" is there twice"),
            std::string::npos);
  EXPECT_NE(table_error("time [ms]\n0\n").find("the time is the only column"), std::string::npos);
  EXPECT_NE(table_error("time [ms],scale\n0,0\n").find("t.csv:2:3: scale is 0"), std::string::npos);
  EXPECT_NE(table_error("time [ms],brightness\n0,-1\n").find("brightness is -1"),
            std::string::npos);
  write_bytes(folder_.file("t.csv"), "time [ms],scale\n0,1\n2,1\n");
  const SceneTimeline timeline(scene("file = \"a.vdb\"\ntime_table = \"t.csv\"\n"));
  EXPECT_EQ(error_of([&] { timeline.at_time(3e-3); }),
            "s.toml:10:14: 3 ms is beyond the end of \"t.csv\", which holds from 0 s to 2 ms");
  EXPECT_NE(error_of([&] { timeline.at_frame(0); }).find("camera.sensor.frame_rate"),
            std::string::npos);
  EXPECT_NE(error_of([&] {
              SceneTimeline(scene("file = \"a.vdb\"\ntime_table = \"none.csv\"\n"));
            }).find("s.toml:10:14: "),
            std::string::npos);
}

TEST_F(Timeline, WhatDoesNotGoTogether) {
  const auto refused = [&](const std::string& flame) {
    return error_of([&] { validate(scene(flame)); });
  };
  EXPECT_NE(refused("file = \"a.vdb\"\nframe_rate = \"1 Hz\"\n").find("write # for each digit"),
            std::string::npos);
  EXPECT_NE(refused("file = \"a_##.vdb\"\n").find("frame_rate = \"1 kHz\""), std::string::npos);
  EXPECT_NE(refused("file = \"a.vdb\"\nfirst_frame = 1\n").find("no frame_rate"),
            std::string::npos);
  EXPECT_EQ(refused("file = \"a#1.vdb\"\n"), "");  // a name like any other
  EXPECT_NE(error_of([&] {
              SceneTimeline(scene("file = \"a_##_##.vdb\"\nframe_rate = \"1 Hz\"\n"));
            }).find("is not a series of files"),
            std::string::npos);
}

}  // namespace
}  // namespace plenoflame::timeline_test
