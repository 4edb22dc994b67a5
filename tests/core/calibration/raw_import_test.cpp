// Pictures that correct others are what they are taken for, or are refused.
#include "plenoflame/calibration/raw_import.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "plenoflame/base/error.h"

namespace plenoflame::test::raw_import_test {
namespace {

constexpr int kSide = 60;

/// A frame without noise. @param counts of the pixel in a column and a row
CountFrames frame(const std::function<double(int, int)>& counts) {
  CountFrames made;
  made.width = made.height = kSide;
  made.bits = 12;
  made.frames = 1;
  made.mean = {Image(kSide, kSide)};
  made.variance = {Image(kSide, kSide)};
  made.state.assign(made.pixel_count(), 0);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) made.mean[0].at(x, y) = static_cast<float>(counts(x, y));
  return made;
}

/// Discs of 10 pixels, dark between them.
double micro_images(int x, int y) {
  const double dx = x % 10 - 4.5, dy = y % 10 - 4.5;
  return dx * dx + dy * dy < 20 ? 1 : 0;
}

/// Message of the import of an even picture with a correction; empty: it succeeded.
std::string refusal(const CountFrames* flat, const CountFrames* white,
                    std::vector<std::uint8_t> defects = {}) {
  ImportSettings settings;
  settings.response = {2, 5, 100, 0, 0.01};
  settings.window = {0, 0, kSide, kSide};
  settings.names = {"grey"};
  settings.model_white = Image(kSide, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      settings.model_white.at(x, y) = static_cast<float>(micro_images(x, y));
  RawCorrections corrections;
  corrections.flat = flat;
  corrections.white = white;
  corrections.defects = std::move(defects);
  ImportSummary summary;
  try {
    import_counts(frame([](int x, int y) { return 100 + 900 * micro_images(x, y); }), corrections,
                  settings, summary);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RawImport, TakesNothingElseForAWhitePicture) {
  const CountFrames good = frame([](int x, int y) { return 100 + 3000 * micro_images(x, y); });
  EXPECT_EQ(refusal(nullptr, &good), "");
  // Dust over a single micro-image.
  const CountFrames dusty =
      frame([](int x, int y) { return 100 + (x < 10 && y < 10 ? 0 : 3000 * micro_images(x, y)); });
  EXPECT_EQ(refusal(nullptr, &dusty), "");
  const CountFrames dark = frame([](int, int) { return 100; });
  EXPECT_NE(refusal(nullptr, &dark).find("too dark in the white picture"), std::string::npos);
  const CountFrames flame = frame([](int x, int y) {
    return 100 + 3000 * micro_images(x, y) * std::exp(-std::pow((x - 30) / 6.0, 2));
  });
  EXPECT_NE(refusal(nullptr, &flame).find("too dark in the white picture"), std::string::npos);
  const CountFrames even = frame([](int, int) { return 2000; });
  EXPECT_NE(refusal(nullptr, &even).find("no micro-images"), std::string::npos);
  const CountFrames moved = frame([](int x, int y) { return 100 + 3000 * micro_images(x + 5, y); });
  EXPECT_NE(refusal(nullptr, &moved), "");
}

TEST(RawImport, TakesNothingElseForAFlatField) {
  const CountFrames good = frame([](int x, int y) { return 100 + 2000 + 10 * x + 3 * y; });
  EXPECT_EQ(refusal(&good, nullptr), "");
  const CountFrames dark = frame([](int, int) { return 100; });
  EXPECT_NE(refusal(&dark, nullptr).find("too dark in the flat field"), std::string::npos);
  const CountFrames white = frame([](int x, int y) { return 100 + 3000 * micro_images(x, y); });
  EXPECT_NE(refusal(&white, nullptr).find("too dark in the flat field"), std::string::npos);
}

TEST(RawImport, HasAFewDefectsAtMost) {
  std::vector<std::uint8_t> defects(kSide * kSide, 0);
  for (int i = 0; i < kSide * kSide * 4 / 100; ++i) defects[static_cast<std::size_t>(20 * i)] = 1;
  EXPECT_EQ(refusal(nullptr, nullptr, defects), "");
  for (int i = 0; i < kSide * kSide * 6 / 100; ++i) defects[static_cast<std::size_t>(10 * i)] = 1;
  EXPECT_NE(refusal(nullptr, nullptr, defects).find("defective"), std::string::npos);
}

}  // namespace
}  // namespace plenoflame::test::raw_import_test
