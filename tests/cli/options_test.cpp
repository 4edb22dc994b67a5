#include "options.h"

#include <gtest/gtest.h>

#include <limits>

#include "plenoflame/base/error.h"

namespace plenoflame::cli {
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

}  // namespace
}  // namespace plenoflame::cli
