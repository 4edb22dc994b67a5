#include "plenoflame/image/png_file.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <string>

#include "plenoflame/base/error.h"
#include "support/stop_on_read.h"
#include "support/temporary_folder.h"

namespace plenoflame::png_file_test {
namespace {

using test::StopOnRead;
using test::TemporaryFolder;
using test::write_bytes;

std::string from_hex(const std::string& hex) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return bytes;
}

// Made with Python's zlib and struct modules only, chunk by chunk:
// 3 x 2, 16-bit grey, gAMA 100000; rows (0, 1, 256) and (65535, 4660, 2).
const char* const kGrey16 =
    "89504e470d0a1a0a0000000d4948445200000003000000021000000000e88fe5850000000467414d"
    "41000186a031e8965f0000001649444154789c6360606060646460f8ff5fc8848109000bfc0249a8"
    "7468240000000049454e44ae426082";

PngImage sample_image(int channels, int bits) {
  PngImage image;
  image.width = 7;
  image.height = 5;
  image.channels = channels;
  image.bits = bits;
  for (std::size_t i = 0; i < image.sample_count(); ++i)
    image.samples.push_back(static_cast<std::uint16_t>(i * 7919 % (bits == 16 ? 65536 : 256)));
  image.samples.back() = static_cast<std::uint16_t>(bits == 16 ? 65535 : 255);
  return image;
}

TEST(Png, ComesBackAsWritten) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  for (const int channels : {1, 3}) {
    for (const int bits : {8, 16}) {
      for (const Transfer transfer : {Transfer::srgb, Transfer::linear}) {
        PngImage image = sample_image(channels, bits);
        image.transfer = transfer;
        image.significant_bits = bits - 2;
        image.texts = {{"Software", "Plenoflame"}, {"Comment", "caf\xc3\xa9 5 \xc2\xb5W"}};
        write_png(path, image);
        const PngImage back = read_png(path);
        EXPECT_EQ(back.width, 7);
        EXPECT_EQ(back.height, 5);
        EXPECT_EQ(back.channels, channels);
        EXPECT_EQ(back.bits, bits);
        EXPECT_EQ(back.significant_bits, bits - 2);
        EXPECT_EQ(back.transfer, transfer);
        EXPECT_EQ(back.samples, image.samples);
        EXPECT_EQ(back.texts, image.texts);
      }
    }
  }
  EXPECT_EQ(folder.names().size(), 1U);
}

TEST(Png, StoppedWritingLeavesNothingBehind) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  std::stop_source stop;
  write_png(path, sample_image(1, 16), stop.get_token());  // nobody asks yet
  const std::string before = test::read_bytes(path);
  ASSERT_FALSE(before.empty());
  stop.request_stop();
  EXPECT_THROW(write_png(path, sample_image(3, 8), stop.get_token()), Cancelled);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.png"});
  EXPECT_EQ(test::read_bytes(path), before);
}

TEST(Png, WritingStoppedInItsMidstLeavesNothingBehind) {
  const TemporaryFolder folder;
  PngImage image;
  image.width = image.height = 600;
  image.channels = 1;
  image.bits = 16;
  image.samples.resize(image.sample_count());
  const StopOnRead middle(&image.samples[image.sample_count() / 2]);
  EXPECT_THROW(write_png(folder.file("a.png"), image, middle.token()), Cancelled);
  EXPECT_EQ(folder.names(), std::vector<std::string>{});
}

TEST(Png, RefusesWhatDoesNotFit) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  PngImage image = sample_image(1, 8);
  image.samples[3] = 256;
  EXPECT_THROW(write_png(path, image), InputError);
  image = sample_image(1, 16);
  image.samples.pop_back();
  EXPECT_THROW(write_png(path, image), InputError);
  image = sample_image(1, 16);
  image.channels = 2;
  EXPECT_THROW(write_png(path, image), InputError);
  EXPECT_THROW(write_png(path, PngImage{}), InputError);
  EXPECT_TRUE(folder.names().empty());
  EXPECT_THROW(write_png(folder.file("none/a.png"), sample_image(1, 8)), FileError);
}

TEST(Png, RefusesWhatIsNotAPng) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  EXPECT_THROW(read_png(path), FileError);
  write_bytes(path, "");
  EXPECT_THROW(read_png(path), FileError);
  write_bytes(path, "no picture at all");
  EXPECT_THROW(read_png(path), FileError);
  write_png(path, sample_image(3, 16));
  const std::string whole = test::read_bytes(path);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    write_bytes(path, whole.substr(0, length));
    EXPECT_THROW(read_png(path), FileError) << length;
  }
}

TEST(Png, ReadsAFileOfAnotherWriter) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  write_bytes(path, from_hex(kGrey16));
  const PngImage image = read_png(path);
  EXPECT_EQ(image.width, 3);
  EXPECT_EQ(image.height, 2);
  EXPECT_EQ(image.bits, 16);
  EXPECT_EQ(image.transfer, Transfer::linear);
  EXPECT_EQ(image.samples, (std::vector<std::uint16_t>{0, 1, 256, 65535, 4660, 2}));
}

/// The most that the process had in memory since the last call with `reset` [bytes].
std::uint64_t peak_memory(bool reset) {
  if (reset) {
    std::ofstream("/proc/self/clear_refs") << "5";
    return 0;
  }
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return 1024 * std::stoull(line.substr(6));
  return 0;
}

// A chunk states its length before its data: a file of a hundred bytes can state two gigabytes.
TEST(Png, ChunksThatStateMoreThanTheFileTakeNoMemory) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  const std::string head = from_hex(kGrey16).substr(0, 33);  // signature and IHDR
  for (const char* kind : {"tEXt", "sPLT", "zTXt", "iTXt", "IDAT"}) {
    write_bytes(path, head + from_hex("7ffffff0") + kind + std::string("Comment\0abc", 11));
    const std::uint64_t before = (peak_memory(true), peak_memory(false));
    EXPECT_THROW(read_png(path), FileError) << kind;
    EXPECT_LT(peak_memory(false) - before, 64u << 20) << kind;
  }
}

}  // namespace
}  // namespace plenoflame::png_file_test
