#include "plenoflame/volumes/grid_writer.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <random>
#include <stop_token>
#include <thread>

#include "plenoflame/base/error.h"
#include "plenoflame/volumes/grid_file.h"
#include "support/approx.h"
#include "support/open_files.h"
#include "volumes/support.h"

namespace plenoflame::grid_writer_test {
namespace {

using test::contains;
using test::message_of;
using test::TemporaryFolder;

/// Two bricks with every value different.
VoxelField sample_field() {
  VoxelField field;
  field.name = "temperature";
  field.background = 293.15f;
  field.brick_origins = {{-8, 0, 16}, {0, 8, -24}};
  for (int i = 0; i < 1024; ++i) field.values.push_back(static_cast<float>(300 + i * 1.3));
  field.values[5] = field.background;
  field.index_to_world.linear.rows = {{{1e-3, 2e-4, 0}, {-3e-4, 2e-3, 1e-4}, {0, 0, 5e-4}}};
  field.index_to_world.translation = {0.5, -0.25, 0.125};
  return field;
}

TEST(GridWriter, OpenVdbReadsWhatWasWritten) {
  const TemporaryFolder folder;
  const VoxelField field = sample_field();
  for (const VdbCompression compression :
       {VdbCompression::none, VdbCompression::zip, VdbCompression::blosc})
    for (const bool half : {false, true}) {
      const std::string path = folder.file("a.vdb");
      const GridOutput output{&field, "K"};
      GridWriteOptions options;
      options.half = half;
      options.compression = compression;
      options.metadata["creator"] = "a test";
      const std::uint64_t size = write_grids(path, std::span(&output, 1), options);
      EXPECT_EQ(size, std::filesystem::file_size(path));
      openvdb::io::File file(path);
      file.open(false);
      EXPECT_EQ(file.getMetadata()->metaValue<std::string>("creator"), "a test");
      const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("temperature"));
      EXPECT_EQ(grid->metaValue<std::string>("unit"), "K");
      EXPECT_EQ(grid->getGridClass(), openvdb::GRID_FOG_VOLUME);
      EXPECT_EQ(grid->saveFloatAsHalf(), half);
      EXPECT_EQ(grid->background(), half ? 293.25f : 293.15f);  // 11 bits
      EXPECT_EQ(grid->activeVoxelCount(), 1023u);
      for (int v = 0; v < 512; ++v) {
        const openvdb::Coord in_brick(v / 64, v / 8 % 8, v % 8);
        const auto tolerance = half ? std::ldexp(1, -11) : 0.0;
        const auto second = static_cast<std::size_t>(512 + v);
        EXPECT_TRUE(test::relative(grid->tree().getValue(in_brick.offsetBy(0, 8, -24)),
                                   field.values[second], tolerance));
      }
      const openvdb::Vec3d world = grid->indexToWorld(openvdb::Vec3d(10, -20, 30));
      EXPECT_TRUE(test::relative(world.x(), 10e-3 - 20 * 2e-4 + 0.5, 1e-14));
      EXPECT_TRUE(test::relative(world.y(), -3e-3 - 40e-3 + 30e-4 - 0.25, 1e-14));
      EXPECT_TRUE(test::relative(world.z(), 15e-3 + 0.125, 1e-14));

      const VoxelField back = read_voxel_field(path, "temperature");
      EXPECT_EQ(back.brick_origins.size(), 2u);
      EXPECT_EQ(back.background, half ? 293.25f : 293.15f);
    }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1)
      << "a temporary file was left behind";
}

TEST(GridWriter, RefusesWhatSixteenBitsCannotHold) {
  const TemporaryFolder folder;
  VoxelField field = sample_field();
  field.values[17] = 65505;
  const GridOutput output{&field, "K"};
  GridWriteOptions options;
  options.half = true;
  EXPECT_TRUE(contains(message_of<InputError>([&] {
                         write_grids(folder.file("a.vdb"), std::span(&output, 1), options);
                       }),
                       "grid \"temperature\" has values up to 65505"));
  options.half = false;
  write_grids(folder.file("a.vdb"), std::span(&output, 1), options);
  field.index_to_world.linear.rows[2] = {0, 0, 0};
  EXPECT_TRUE(contains(
      message_of<InputError>([&] { write_grids(folder.file("a.vdb"), std::span(&output, 1)); }),
      "singular"));
}

TEST(GridWriter, WritingStoppedInItsMidstLeavesTheOldFileAlone) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  test::spill(path, {'o', 'l', 'd'});
  VoxelField field = sample_field();
  std::minstd_rand random(3);  // what cannot be compressed
  bool stopped = false;
  // A busy machine sees the file late: then it is made larger.
  for (int bricks = 8000; !stopped && bricks < 1'000'000; bricks *= 4) {
    field.brick_origins.clear();
    for (int i = 0; i < bricks; ++i) field.brick_origins.push_back({8 * i, 0, 0});
    field.values.assign(512 * field.brick_origins.size(), 1.0F);
    for (float& value : field.values) value = static_cast<float>(random());
    const GridOutput output{&field, "K"};
    std::stop_source stop;
    std::jthread watcher([&](const std::stop_token& over) {
      while (!over.stop_requested())
        if (test::open_in(folder.path()) > 100000) stop.request_stop();
    });
    GridWriteOptions options;
    options.stop = stop.get_token();
    try {
      write_grids(path, std::span(&output, 1), options);
      test::spill(path, {'o', 'l', 'd'});
    } catch (const Cancelled&) {
      stopped = true;
    }
  }
  EXPECT_TRUE(stopped);
  EXPECT_EQ(test::slurp(path), (std::vector<char>{'o', 'l', 'd'}));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(GridWriter, AFailedWriteLeavesTheOldFileAlone) {
  const TemporaryFolder folder;
  const VoxelField field = sample_field();
  const GridOutput output{&field, "K"};
  EXPECT_TRUE(contains(
      message_of<FileError>([&] { write_grids(folder.file("no/a.vdb"), std::span(&output, 1)); }),
      "there is no folder"));
  EXPECT_TRUE(
      contains(message_of<FileError>([&] { write_grids(folder.path(), std::span(&output, 1)); }),
               "a folder has this name"));

  const std::string path = folder.file("a.vdb");
  test::spill(path, {'o', 'l', 'd'});
  // A limit on the size of files stands for a full disk.
  rlimit old_limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old_limit), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = old_limit;
  small.rlim_cur = 1000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message =
      message_of<FileError>([&] { write_grids(path, std::span(&output, 1)); });
  setrlimit(RLIMIT_FSIZE, &old_limit);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_TRUE(contains(message, "cannot write '" + path + "': it exceeds the largest file size"));
  EXPECT_EQ(test::slurp(path), (std::vector<char>{'o', 'l', 'd'}));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);

  if (geteuid() != 0) {  // root may write anywhere
    std::filesystem::permissions(
        folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
    EXPECT_TRUE(contains(message_of<FileError>([&] { write_grids(path, std::span(&output, 1)); }),
                         "no permission to write"));
    std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  }
}

}  // namespace
}  // namespace plenoflame::grid_writer_test
