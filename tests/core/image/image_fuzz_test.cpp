#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <string>

#include "plenoflame/base/error.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/image/png_file.h"
#include "support/temporary_folder.h"

// Damaged files must end in an Error or in a result that is consistent in itself; the sanitizer
// builds make every stray access visible.
namespace plenoflame {
namespace {

using test::TemporaryFolder;

/// Overwrites, flips, inserts, removes or cuts bytes at random. Only std::mt19937_64's own numbers
/// are used: the distributions of the library differ between systems.
std::string mutate(std::string bytes, std::size_t header_size, std::mt19937_64& random) {
  const auto below = [&random](std::size_t limit) {
    return static_cast<std::size_t>(random() % limit);
  };
  // Most damage goes where the structure is.
  const auto place = [&] {
    const bool in_header = below(4) != 0 && header_size < bytes.size();
    return below(in_header ? header_size : bytes.size());
  };
  const std::size_t changes = 1 + below(6);
  for (std::size_t i = 0; i < changes && bytes.size() > 8; ++i) {
    const std::size_t at = place();
    switch (below(7)) {
      case 0:
        bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        bytes[at] = static_cast<char>(0xff);
        break;
      case 3:
        bytes[at] = 0;
        break;
      case 4:
        bytes.insert(at, 1 + below(8), static_cast<char>(random()));
        break;
      case 5:
        bytes.erase(at, 1 + below(8));
        break;
      default:
        if (below(8) == 0)
          bytes.resize(at);
        else
          for (std::size_t k = at; k < std::min(at + 4, bytes.size()); ++k)
            bytes[k] = static_cast<char>(random());
    }
  }
  return bytes;
}

struct Outcomes {
  int read = 0;
  int refused = 0;
};

Outcomes fuzz(const std::string& path, std::size_t header_size, int runs, std::uint64_t seed,
              const std::function<void()>& read) {
  const std::string whole = test::read_bytes(path);
  std::mt19937_64 random(seed);
  Outcomes outcomes;
  for (int run = 0; run < runs; ++run) {
    test::write_bytes(path, mutate(whole, header_size, random));
    try {
      read();
      ++outcomes.read;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      ++outcomes.refused;
    } catch (const std::exception& other) {
      ADD_FAILURE() << "run " << run << " of seed " << seed << ": " << other.what();
    }
  }
  return outcomes;
}

TEST(Fuzz, LightFieldFile) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  LightField field;
  field.sensor_width = 12;
  field.sensor_height = 9;
  field.window = {2, 1, 7, 6};
  field.channels = {{"total", Image(7, 6, 1e-9F), Image(7, 6, 1e-11F)}};
  field.layers["depth"] = Image(7, 6, 1);
  field.scene_text = "[camera]\n";
  field.numbers["array.pitch"] = 1e-4;
  write_light_field(path, field);
  const std::size_t pixels = 3 * 7 * 6 * sizeof(float);
  const std::size_t header = test::read_bytes(path).size() - pixels;
  const Outcomes outcomes = fuzz(path, header, 2500, 20240611, [&] {
    const LightField back = read_light_field(path);
    const PixelWindow& window = back.window;
    ASSERT_GT(window.width, 0);
    ASSERT_GT(window.height, 0);
    ASSERT_LE(window.x + window.width, back.sensor_width);
    ASSERT_LE(window.y + window.height, back.sensor_height);
    for (const auto& channel : back.channels)
      ASSERT_EQ(channel.flux.pixels.size(),
                static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height));
  });
  // Both kinds must occur, or the mutations test nothing.
  EXPECT_GT(outcomes.read, 100);
  EXPECT_GT(outcomes.refused, 500);
}

TEST(Fuzz, PngFile) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  PngImage image;
  image.width = 9;
  image.height = 6;
  image.bits = 16;
  image.channels = 3;
  image.samples.assign(image.sample_count(), 300);
  image.texts["Comment"] = "text";
  write_png(path, image);
  const Outcomes outcomes = fuzz(path, 120, 2000, 7351, [&] {
    const PngImage back = read_png(path);
    ASSERT_EQ(back.samples.size(), back.sample_count());
    ASSERT_GT(back.width, 0);
  });
  EXPECT_GT(outcomes.read, 20);
  EXPECT_GT(outcomes.refused, 500);
}

}  // namespace
}  // namespace plenoflame
