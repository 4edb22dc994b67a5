#include "progress_bar.h"

#include <gtest/gtest.h>

#include <chrono>
#include <sstream>
#include <thread>

namespace plenoflame::cli::progress_bar_test {
namespace {

TEST(FormatDuration, RoundsUpAndGroups) {
  EXPECT_EQ(format_duration(0), "0:00");
  EXPECT_EQ(format_duration(0.2), "0:01");
  EXPECT_EQ(format_duration(59.5), "1:00");
  EXPECT_EQ(format_duration(754), "12:34");
  EXPECT_EQ(format_duration(3 * 3600 + 5 * 60), "3:05:00");
  EXPECT_EQ(format_duration(-1), "unknown");
  EXPECT_EQ(format_duration(1e300), "unknown");
}

TEST(ProgressLine, ShowsWhatIsKnown) {
  EXPECT_EQ(progress_line({0.5, 1e9, 12.34e6, 0.0123, 35}, 200),
            " 50 % [############............]  12.3 M rays/s  error 1.2 %  0:35 left");
  EXPECT_EQ(progress_line({0.5, 0, 0, -1, -1}, 200), " 50 % [############............]");
  EXPECT_EQ(progress_line({0.999, 0, 950, -1, -1}, 200),
            " 99 % [#######################.]  950 rays/s");
  EXPECT_EQ(progress_line({1.5, 0, 0, -1, -1}, 200), "100 % [########################]");
}

TEST(ProgressLine, BeginsWithWhatIsUnderWay) {
  EXPECT_EQ(progress_line({0.5, 0, 0, -1, -1}, 200, "2 of 7, backward 16"),
            "2 of 7, backward 16:  50 % [############............]");
}

TEST(ProgressLine, FitsTheTerminal) {
  for (int columns = 1; columns < 80; ++columns)
    EXPECT_LE(progress_line({0.5, 1e9, 12.34e6, 0.0123, 35}, columns).size(),
              static_cast<std::size_t>(columns));
}

TEST(ProgressBar, DrawsNothingWithoutTerminal) {
  std::ostringstream stream;
  {
    ProgressBar bar(stream, false, false, 80);
    bar.update({0.5, 0, 0, -1, -1});
    bar.message(Severity::note, "two");
    bar.message(Severity::warning, "three");
  }
  EXPECT_EQ(stream.str(), "plenoflame: note: two\nplenoflame: warning: three\n");
}

TEST(ProgressBar, QuietKeepsWarnings) {
  std::ostringstream stream;
  {
    ProgressBar bar(stream, true, true, 80);
    bar.update({0.5, 0, 0, -1, -1});
    bar.message(Severity::note, "two");
    bar.message(Severity::warning, "three");
  }
  EXPECT_EQ(stream.str(), "plenoflame: warning: three\n");
}

TEST(ProgressBar, MessagesGetLinesOfTheirOwnAndNothingRemains) {
  std::ostringstream stream;
  {
    ProgressBar bar(stream, true, false, 80);
    bar.update({0.5, 0, 0, -1, -1});
    bar.message(Severity::warning, "careful");
    bar.update({0.75, 0, 0, -1, -1});
  }
  EXPECT_EQ(stream.str(),
            "\r 50 % [############............]\x1b[K"
            "\r\x1b[Kplenoflame: warning: careful\n"
            "\r 75 % [##################......]\x1b[K"
            "\r\x1b[K");
}

TEST(ProgressBar, TellsTheTimeThatIsLeftByTheShareThatIsDone) {
  std::ostringstream stream;
  ProgressBar bar(stream, true, false, 80);
  bar.update({0.5, 0, 0, -1, -1});
  EXPECT_EQ(stream.str().find("left"), std::string::npos);  // nobody knows yet
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  bar.update({0.5, 0, 0, -1, -1});
  EXPECT_NE(stream.str().find(" left"), std::string::npos) << stream.str();
  // Another part of the work begins.
  stream.str("");
  std::this_thread::sleep_for(std::chrono::milliseconds(150));
  bar.update({0.1, 0, 0, -1, -1});
  EXPECT_EQ(stream.str().find("left"), std::string::npos);
}

TEST(ProgressBar, DrawsSeldom) {
  std::ostringstream stream;
  ProgressBar bar(stream, true, false, 80);
  for (int i = 0; i < 100000; ++i) bar.update({i * 1e-5, 0, 0, -1, -1});
  // A line has 32 characters and more: 100000 of them would take 3 MB.
  EXPECT_LT(stream.str().size(), 10000U);
  bar.update({1, 0, 0, -1, -1});
  EXPECT_NE(stream.str().find("100 %"), std::string::npos);
}

// The first report of a part is drawn, however soon it follows.
TEST(ProgressBar, ShowsEachPartOfTheWork) {
  std::ostringstream stream;
  {
    ProgressBar bar(stream, true, false, 80);
    for (const char* part : {"one", "two"}) {
      bar.begin(part);
      bar.update({0, 0, 0, -1, -1});
    }
  }
  EXPECT_EQ(stream.str(),
            "\rone:   0 % [........................]\x1b[K"
            "\rtwo:   0 % [........................]\x1b[K"
            "\r\x1b[K");
}

TEST(ProgressBar, ServesSeveralThreads) {
  std::ostringstream stream;
  {
    ProgressBar bar(stream, true, false, 80);
    Execution execution;
    bar.connect(execution);
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&execution] {
        for (int i = 0; i < 200; ++i) {
          execution.progress({i / 200.0, 0, 0, -1, -1});
          execution.warn("w");
        }
      });
  }
  const std::string text = stream.str();
  const std::string line = "plenoflame: warning: w\n";
  std::size_t count = 0;
  for (std::size_t at = text.find(line); at != std::string::npos; at = text.find(line, at + 1))
    ++count;
  EXPECT_EQ(count, 800U);
}

}  // namespace
}  // namespace plenoflame::cli::progress_bar_test
