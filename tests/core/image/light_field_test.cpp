#include "plenoflame/image/light_field.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>

#include "plenoflame/base/error.h"
#include "plenoflame/image/light_field_channel.h"
#include "support/approx.h"
#include "support/stop_on_read.h"
#include "support/temporary_folder.h"

namespace plenoflame::light_field_test {
namespace {

using test::read_bytes;
using test::StopOnRead;
using test::TemporaryFolder;
using test::write_bytes;

/// Every pixel of every image differs from every other.
LightField sample_light_field() {
  LightField field;
  field.sensor_width = 100;
  field.sensor_height = 80;
  field.window = {13, 7, 9, 6};
  float value = 1e-9F;
  const auto image = [&] {
    Image made(9, 6);
    for (float& pixel : made.pixels) pixel = value *= 1.01F;
    return made;
  };
  field.channels.push_back({"total", image(), image()});
  field.channels.push_back({"650nm", image(), {}});
  field.layers["truth.depth"] = image();
  field.scene_text = "# sc\xc3\xa8ne\n[camera]\nposition = [\"0 m\"]\n";
  field.estimator = "backward";
  field.seed = 18446744073709551615ULL;
  field.samples = 64;
  field.complete = false;
  field.version = "0.1.0";
  field.numbers = {{"array.pitch", 0.1e-3 / 3},
                   {"lens.focal_length", 0.0999},
                   {"lens.f_number", 3.3},
                   {"focus.object_distance", 1.25},
                   {"sensor.pixel_pitch", 5.5e-6}};
  field.texts = {{"note", "line one\nline two"}, {"empty", ""}};
  return field;
}

void expect_same(const Image& actual, const Image& expected) {
  EXPECT_EQ(actual.width, expected.width);
  EXPECT_EQ(actual.height, expected.height);
  ASSERT_EQ(actual.pixels.size(), expected.pixels.size());
  if (expected.pixels.empty()) return;  // memcmp takes no null pointers, whatever the length
  EXPECT_EQ(std::memcmp(actual.pixels.data(), expected.pixels.data(),
                        expected.pixels.size() * sizeof(float)),
            0);
}

void expect_same_header(const LightField& actual, const LightField& expected) {
  EXPECT_EQ(actual.sensor_width, expected.sensor_width);
  EXPECT_EQ(actual.sensor_height, expected.sensor_height);
  EXPECT_EQ(actual.window, expected.window);
  EXPECT_EQ(actual.scene_text, expected.scene_text);
  EXPECT_EQ(actual.estimator, expected.estimator);
  EXPECT_EQ(actual.seed, expected.seed);
  EXPECT_EQ(actual.samples, expected.samples);
  EXPECT_EQ(actual.complete, expected.complete);
  EXPECT_EQ(actual.version, expected.version);
  EXPECT_EQ(actual.numbers, expected.numbers);
  EXPECT_EQ(actual.texts, expected.texts);
  ASSERT_EQ(actual.channels.size(), expected.channels.size());
  for (std::size_t i = 0; i < expected.channels.size(); ++i)
    EXPECT_EQ(actual.channels[i].name, expected.channels[i].name);
  ASSERT_EQ(actual.layers.size(), expected.layers.size());
}

// Channels that are not asked for stay in the file; the others are the same as when all are read.
TEST(LightFieldFile, OneChannelIsReadByItself) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  const LightField field = sample_light_field();
  write_light_field(path, field);
  for (const char* name : {"", "total", "650nm"}) {
    const LightFieldChannel& expected = find_channel(field, name);
    const LightField back = read_light_field_channel(path, name);
    ASSERT_EQ(back.channels.size(), 1U);
    EXPECT_EQ(back.channels[0].name, expected.name);
    expect_same(back.channels[0].flux, expected.flux);
    EXPECT_TRUE(back.channels[0].standard_error.empty());
    EXPECT_TRUE(back.layers.empty());
    EXPECT_EQ(back.window, field.window);
    EXPECT_EQ(back.scene_text, field.scene_text);
    EXPECT_EQ(back.numbers, field.numbers);
    const LightField with_layers = read_light_field_channel(path, name, Layers::all);
    expect_same(with_layers.channels.at(0).flux, expected.flux);
    expect_same(with_layers.layers.at("truth.depth"), field.layers.at("truth.depth"));
    const LightField foreign = read_foreign_channel(path, name[0] == '\0' ? "total" : name);
    ASSERT_EQ(foreign.channels.size(), 1U);
    expect_same(foreign.channels[0].flux, expected.flux);
  }
  try {
    read_light_field_channel(path, "blue");
    FAIL() << "there is no such channel";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("has no channel 'blue'; it has: total, 650nm"),
              std::string::npos)
        << error.what();
  }
}

TEST(LightFieldFile, ComesBackBitByBit) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  LightField field = sample_light_field();
  field.layers.at("truth.depth").at(2, 3) = std::numeric_limits<float>::quiet_NaN();
  field.channels[0].flux.at(3, 3) = std::numeric_limits<float>::denorm_min();
  field.channels[0].flux.at(4, 3) = -0.0F;
  write_light_field(path, field);
  EXPECT_EQ(folder.names().size(), 1U);
  const LightField back = read_light_field(path);
  expect_same_header(back, field);
  for (std::size_t i = 0; i < field.channels.size(); ++i) {
    expect_same(back.channels[i].flux, field.channels[i].flux);
    expect_same(back.channels[i].standard_error, field.channels[i].standard_error);
  }
  expect_same(back.layers.at("truth.depth"), field.layers.at("truth.depth"));

  const LightField header = read_light_field_header(path);
  expect_same_header(header, field);
  EXPECT_TRUE(header.channels[0].flux.empty());

  // The same light field gives the same bytes.
  write_light_field(folder.file("b.exr"), back);
  EXPECT_EQ(read_bytes(folder.file("b.exr")), read_bytes(path));
}

TEST(LightFieldFile, LightIsAFiniteNumber) {
  const TemporaryFolder folder;
  LightField field = sample_light_field();
  field.channels[0].flux.at(2, 3) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(write_light_field(folder.file("a.exr"), field), Error);
  EXPECT_TRUE(folder.names().empty());
}

TEST(LightFieldFile, TallOneComesBackWhole) {
  const TemporaryFolder folder;
  LightField field;
  field.sensor_width = 30;
  field.sensor_height = 300;
  field.window = {3, 11, 5, 203};
  Image flux(5, 203);
  for (std::size_t i = 0; i < flux.pixels.size(); ++i) flux.pixels[i] = static_cast<float>(i);
  field.channels.push_back({"total", flux, {}});
  write_light_field(folder.file("a.exr"), field);
  const LightField read = read_light_field(folder.file("a.exr"));
  expect_same(read.channels[0].flux, flux);
}

TEST(LightFieldFile, StoppedWritingLeavesNothingBehind) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  std::stop_source stop;
  write_light_field(path, sample_light_field(), stop.get_token());  // nobody asks yet
  const std::string before = read_bytes(path);
  LightField other = sample_light_field();
  other.seed = 1;
  stop.request_stop();
  EXPECT_THROW(write_light_field(path, other, stop.get_token()), Cancelled);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.exr"});
  EXPECT_EQ(read_bytes(path), before);
  EXPECT_THROW(read_light_field(path, stop.get_token()), Cancelled);
}

TEST(LightFieldFile, WritingStoppedInItsMidstLeavesNothingBehind) {
  const TemporaryFolder folder;
  LightField field;
  field.sensor_width = field.sensor_height = 600;
  field.window = {0, 0, 600, 600};
  field.channels.push_back({"total", Image(600, 600), {}});
  const StopOnRead middle(&field.channels[0].flux.at(300, 300));
  EXPECT_THROW(write_light_field(folder.file("a.exr"), field, middle.token()), Cancelled);
  EXPECT_EQ(folder.names(), std::vector<std::string>{});
}

/// The file as other programs see it: read with OpenEXR alone.
TEST(LightFieldFile, IsAnOrdinaryExr) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  const LightField field = sample_light_field();
  write_light_field(path, field);
  Imf::InputFile file(path.c_str());
  const Imf::Header& header = file.header();
  EXPECT_EQ(header.displayWindow(), Imath::Box2i({0, 0}, {99, 79}));
  EXPECT_EQ(header.dataWindow(), Imath::Box2i({13, 7}, {21, 12}));
  EXPECT_FALSE(header.hasTileDescription());
  std::vector<std::string> names;
  for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
    names.push_back(i.name());
    EXPECT_EQ(i.channel().type, Imf::FLOAT);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"650nm", "total", "total.error", "truth.depth"}));
  // Units as OpenEXR defines its standard attributes, not SI.
  const auto number = [&](const char* name) {
    return header.typedAttribute<Imf::FloatAttribute>(name).value();
  };
  EXPECT_TRUE(test::relative(number("effectiveFocalLength"), 99.9, 1e-7));
  EXPECT_EQ(number("aperture"), 3.3F);
  EXPECT_EQ(number("focus"), 1.25F);
  EXPECT_TRUE(test::relative(number("sensorPhotositePitch"), 5.5, 1e-7));
  const Imath::V2f size =
      header.typedAttribute<Imf::V2fAttribute>("sensorOverallDimensions").value();
  EXPECT_TRUE(test::relative(size.x, 0.55, 1e-7));
  EXPECT_TRUE(test::relative(size.y, 0.44, 1e-7));
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("plenoflame.scene").value(),
            field.scene_text);
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("plenoflame.unit").value(), "W");

  // Columns grow to the right, rows downwards, (13, 7) is the window's first pixel.
  std::vector<float> total(9 * 6);
  Imf::FrameBuffer buffer;
  buffer.insert("total", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(total.data() - 13 - 7 * 9),
                                    sizeof(float), 9 * sizeof(float)));
  file.setFrameBuffer(buffer);
  file.readPixels(7, 12);
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 9; ++column)
      EXPECT_EQ(total[static_cast<std::size_t>(row * 9 + column)],
                field.channels[0].flux.at(column, row));
}

TEST(LightFieldFile, IsTheSameHoweverItIsPacked) {
  const TemporaryFolder folder;
  LightField field = sample_light_field();
  for (float& pixel : field.channels[1].flux.pixels) pixel = 0;
  for (const ExrCompression compression :
       {ExrCompression::none, ExrCompression::rle, ExrCompression::zip, ExrCompression::piz}) {
    const std::string path = folder.file("a.exr");
    write_light_field(path, field, {}, compression);
    const LightField back = read_light_field(path);
    expect_same_header(back, field);
    for (std::size_t i = 0; i < field.channels.size(); ++i) {
      expect_same(back.channels[i].flux, field.channels[i].flux);
      expect_same(back.channels[i].standard_error, field.channels[i].standard_error);
    }
  }
}

// Other programs that write an EXR anew do this to it: attributes of types other than whole
// numbers and texts are gone.
TEST(LightFieldFile, NeedsNoAttributesButWholeNumbersAndTexts) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr"), copy = folder.file("b.exr");
  const LightField field = sample_light_field();
  write_light_field(path, field);
  const auto write_copy = [&](bool with_texts) {
    Imf::InputFile in(path.c_str());
    Imf::Header header(in.header().displayWindow(), in.header().dataWindow());
    header.channels() = in.header().channels();
    for (auto entry = in.header().begin(); entry != in.header().end(); ++entry) {
      const std::string type = entry.attribute().typeName();
      if (std::string(entry.name()).starts_with("plenoflame.") &&
          (type == "int" || (with_texts && type == "string")))
        header.insert(entry.name(), entry.attribute());
    }
    Imf::OutputFile out(copy.c_str(), header);
    out.copyPixels(in);
  };
  write_light_field(path, field, {}, ExrCompression::zip);  // as a new header has it
  write_copy(true);
  expect_same_header(read_light_field(copy), field);
  write_copy(false);
  try {
    read_light_field(copy);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("has lost a part"), std::string::npos) << error.what();
  }
}

// A program that converts pixels to 16 bits keeps the attributes and loses the light.
TEST(LightFieldFile, FluxInSixteenBitsIsRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr"), copy = folder.file("copy.exr");
  write_light_field(path, sample_light_field());
  {
    Imf::InputFile in(path.c_str());
    Imf::Header header = in.header();
    Imf::FrameBuffer buffer;
    const Imath::Box2i data = header.dataWindow();
    std::vector<half> pixels(9 * 6);
    for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
      i.channel().type = Imf::HALF;
      buffer.insert(i.name(), Imf::Slice::Make(Imf::HALF, pixels.data(), data));
    }
    Imf::OutputFile out(copy.c_str(), header);
    out.setFrameBuffer(buffer);
    out.writePixels(6);
  }
  try {
    static_cast<void>(read_light_field(copy));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("holds its flux in 16 bits"), std::string::npos);
  }
}

TEST(LightFieldFile, ExrFromElsewhereNamesTheMissingAttribute) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  {
    Imf::Header header(4, 3);
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
    Imf::OutputFile file(path.c_str(), header);
    std::vector<float> pixels(12);
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(pixels.data()), 4, 16));
    file.setFrameBuffer(buffer);
    file.writePixels(3);
  }
  try {
    read_light_field(path);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'plenoflame.format' is missing"), std::string::npos)
        << error.what();
  }
}

TEST(LightFieldFile, RefusesWhatIsNotReadable) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  EXPECT_THROW(read_light_field(path), FileError);
  EXPECT_THROW(read_light_field(folder.path()), FileError);
  write_bytes(path, "");
  EXPECT_THROW(read_light_field(path), FileError);
  write_bytes(path, "[camera]\n");
  EXPECT_THROW(read_light_field(path), FileError);
  write_light_field(path, sample_light_field());
  const std::string whole = read_bytes(path);
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    write_bytes(path, whole.substr(0, length));
    EXPECT_THROW(read_light_field(path), Error) << length;
  }
}

TEST(LightFieldFile, RefusesWhatDoesNotFit) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  const auto refused = [&](auto change) {
    LightField field = sample_light_field();
    change(field);
    EXPECT_THROW(write_light_field(path, field), InputError);
  };
  refused([](LightField& f) { f.window.x = 92; });
  refused([](LightField& f) { f.window.x = -1; });
  refused([](LightField& f) { f.window.width = 8; });
  refused([](LightField& f) { f.channels.clear(); });
  refused([](LightField& f) { f.channels[0].flux = {}; });
  refused([](LightField& f) { f.channels[0].standard_error = Image(9, 5); });
  refused([](LightField& f) { f.channels[1].name = "total"; });
  refused([](LightField& f) { f.channels[1].name = ""; });
  refused([](LightField& f) { f.layers["total.error"] = f.layers["truth.depth"]; });
  refused([](LightField& f) { f.numbers[""] = 1; });
  EXPECT_TRUE(folder.names().empty());
}

TEST(LightFieldFile, LeavesTheOldFileWhenWritingFails) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  write_light_field(path, sample_light_field());
  const std::string before = read_bytes(path);
  LightField large = sample_light_field();
  large.sensor_width = large.sensor_height = 600;
  large.window = {0, 0, 600, 600};
  large.channels = {{"total", Image(600, 600, 1e-9F), {}}};
  large.layers.clear();
  rlimit limits{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limits), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  // In the header, in the middle, and in the last bytes.
  std::vector<std::string> failures;
  for (const rlim_t size : {100UL, 700000UL, 1440000UL}) {
    const rlimit limit{size, limits.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
    try {
      write_light_field(path, large);
      failures.emplace_back("written");
    } catch (const FileError& error) {
      failures.emplace_back(error.what());
    }
  }
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limits), 0);
  std::signal(SIGXFSZ, handler);
  for (const std::string& failure : failures)
    EXPECT_NE(failure.find("largest file size"), std::string::npos) << failure;
  EXPECT_EQ(read_bytes(path), before);
  EXPECT_EQ(folder.names().size(), 1U);
}

}  // namespace
}  // namespace plenoflame::light_field_test
