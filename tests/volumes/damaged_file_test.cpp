// Damaged files end in an exception or in a grid, never in a crash. Run under the address sanitizer
// this also finds reads and writes out of bounds.
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <random>

#include "plenoflame/base/error.h"
#include "plenoflame/volumes/grid_file.h"
#include "support/damaged_files.h"
#include "volumes/support.h"

namespace plenoflame::damaged_file_test {
namespace {

using test::TemporaryFolder;

/// A small file with leaves, tiles, both encodings and several compressed blocks.
std::vector<char> sample_file(const std::string& path, std::uint32_t compression, bool half) {
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(0);
  grid->setName("absorption");
  grid->insertMeta("unit", openvdb::StringMetadata("1/m"));
  grid->setSaveFloatAsHalf(half);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.001));
  std::mt19937 random(7);
  std::uniform_real_distribution<float> noise(0, 1);
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 10; ++j)
      for (int k = 0; k < 10; ++k) grid->tree().setValue({i, j, k}, i < 8 ? 1.0f : noise(random));
  grid->tree().addTile(1, {64, 0, 0}, 4.0f, true);
  openvdb::io::File file(path);
  file.setCompression(compression);
  file.write(openvdb::GridPtrVec{grid});
  file.close();
  return test::slurp(path);
}

enum class Outcome { read, refused };

Outcome try_to_read(const std::string& path) {
  try {
    for (const GridInfo& grid : list_grids(path))
      if (grid.readable) {
        const VoxelField field = read_voxel_field(path, grid.name);
        EXPECT_EQ(field.values.size(), field.brick_origins.size() * 512);
      }
    return Outcome::read;
  } catch (const FileError& error) {
    EXPECT_EQ(std::string(error.what()).rfind(path, 0), 0u) << error.what();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).rfind(path, 0), 0u) << error.what();
  }
  return Outcome::refused;
}

const std::uint32_t kCompressions[] = {
    openvdb::io::COMPRESS_NONE, openvdb::io::COMPRESS_ACTIVE_MASK | openvdb::io::COMPRESS_ZIP,
    openvdb::io::COMPRESS_ACTIVE_MASK | openvdb::io::COMPRESS_BLOSC, openvdb::io::COMPRESS_ZIP};

TEST(DamagedFile, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.file("cut.vdb");
  for (const std::uint32_t compression : kCompressions) {
    const auto whole = sample_file(path, compression, false);
    ASSERT_EQ(try_to_read(path), Outcome::read);
    // Every length near both ends, and a sample of those between.
    for (std::size_t length = 0; length < whole.size();
         length += length < 300 || length + 300 > whole.size() ? 1 : 499) {
      test::spill(path, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)});
      ASSERT_EQ(try_to_read(path), Outcome::refused)
          << "cut to " << length << " of " << whole.size();
    }
  }
}

TEST(DamagedFile, RandomBytes) {
  const TemporaryFolder folder;
  const std::string path = folder.file("mutated.vdb");
  std::mt19937_64 random(20240607);
  int refused = 0, runs = 0;
  for (const std::uint32_t compression : kCompressions)
    for (const bool half : {false, true}) {
      const auto whole = sample_file(path, compression, half);
      for (int run = 0, files = test::damaged_files_wanted(1200) / 8; run < files; ++run) {
        auto bytes = whole;
        // Half of the changes go to the first kilobyte, where the structure is.
        const int changes = 1 + static_cast<int>(random() % 4);
        for (int c = 0; c < changes; ++c) {
          const std::size_t limit =
              random() % 2 == 0 ? std::min<std::size_t>(1024, bytes.size()) : bytes.size();
          const char values[] = {static_cast<char>(random()), char(0), char(-1), char(127)};
          bytes[random() % limit] = values[random() % 4];
        }
        test::spill(path, bytes);
        refused += try_to_read(path) == Outcome::refused ? 1 : 0;
        ++runs;
      }
    }
  // The test would be idle if the changes did not matter, or if nothing could be read.
  EXPECT_GT(refused, runs / 10);
  EXPECT_LT(refused, runs);
  std::printf("flames (.vdb): %d files, %d read, %d refused\n", runs, runs - refused, refused);
}

/// Counts, lengths, offsets and sizes of a file are small numbers of 4 or 8 bytes: one of them, or
/// of the doubles of a transform, becomes a number at the end of its type.
TEST(DamagedFile, AwkwardFields) {
  const TemporaryFolder folder;
  const std::string path = folder.file("fields.vdb");
  std::mt19937_64 random(20261206);
  constexpr std::int64_t kNumbers[] = {0,        1,        -1,       -2,       127,
                                       128,      255,      32767,    65536,    2147483647,
                                       1L << 31, 1L << 32, 1L << 53, 1L << 62, -(1L << 62)};
  int refused = 0, runs = 0;
  for (const std::uint32_t compression : kCompressions) {
    const auto whole = sample_file(path, compression, false);
    std::vector<std::size_t> small, doubles;
    for (std::size_t at = 0; at + 8 <= whole.size(); ++at) {
      std::uint32_t number;
      double real;
      std::memcpy(&number, &whole[at], 4);
      std::memcpy(&real, &whole[at], 8);
      if (number > 0 && number <= whole.size()) small.push_back(at);
      if (std::fabs(real) > 1e-6 && std::fabs(real) < 1e6) doubles.push_back(at);
    }
    for (int run = 0, files = test::damaged_files_wanted(800) / 4; run < files; ++run) {
      auto bytes = whole;
      if (random() % 8 == 0) {
        const double values[] = {0, -1, 1e300, 1e-300, INFINITY, NAN};
        std::memcpy(&bytes[doubles[random() % doubles.size()]], &values[random() % 6], 8);
      } else {
        const std::int64_t number = kNumbers[random() % std::size(kNumbers)];
        // Half of them in the first kilobytes, where grids are described.
        const std::size_t limit =
            random() % 2 == 0 ? std::min<std::size_t>(200, small.size()) : small.size();
        std::memcpy(&bytes[small[random() % limit]], &number, random() % 2 == 0 ? 4 : 8);
      }
      test::spill(path, bytes);
      refused += try_to_read(path) == Outcome::refused ? 1 : 0;
      ++runs;
    }
  }
  EXPECT_GT(refused, runs / 20);
  EXPECT_LT(refused, runs);
  std::printf("flames (.vdb), fields: %d files, %d read, %d refused\n", runs, runs - refused,
              refused);
}

/// OpenVDB reads a block that says to be stored plainly with a wrong length before it looks at the
/// length: 8 bytes in front of every block, each of which is tried here.
TEST(DamagedFile, WrongBlockLengths) {
  const TemporaryFolder folder;
  const std::string path = folder.file("length.vdb");
  const auto whole =
      sample_file(path, openvdb::io::COMPRESS_ACTIVE_MASK | openvdb::io::COMPRESS_BLOSC, false);
  int refused = 0;
  for (std::size_t at = 0; at + 8 <= whole.size(); ++at) {
    std::int64_t length;
    std::memcpy(&length, &whole[at], 8);
    if (length == 0 || std::abs(length) > 4096) continue;  // cannot be the length of a block
    for (const std::int64_t wrong :
         {-length, -length - 4, std::int64_t{-2052}, std::int64_t{1} << 40,
          -(std::int64_t{1} << 40), std::int64_t{3}}) {
      auto bytes = whole;
      std::memcpy(&bytes[at], &wrong, 8);
      test::spill(path, bytes);
      refused += try_to_read(path) == Outcome::refused ? 1 : 0;
    }
  }
  EXPECT_GT(refused, 20);
}

}  // namespace
}  // namespace plenoflame::damaged_file_test
