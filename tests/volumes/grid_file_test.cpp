// Files are written by OpenVDB itself, and what it holds is compared with what the library reads.
#include "plenoflame/volumes/grid_file.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <cmath>
#include <fstream>
#include <random>

#include "plenoflame/base/error.h"
#include "plenoflame/volumes/flame_file.h"
#include "plenoflame/volumes/vdb_info.h"
#include "support/approx.h"
#include "volumes/support.h"

namespace plenoflame::grid_file_test {
namespace {

using test::contains;
using test::FieldSampler;
using test::message_of;
using test::relative;
using test::TemporaryFolder;

void write(const std::string& path, const openvdb::GridPtrVec& grids,
           std::uint32_t compression = openvdb::io::COMPRESS_ACTIVE_MASK |
                                       openvdb::io::COMPRESS_BLOSC) {
  openvdb::io::File file(path);
  file.setCompression(compression);
  file.write(grids);
}

/// Scattered voxels around the origin, some of them inactive with a value of their own.
template <class Grid>
typename Grid::Ptr scattered(int count, unsigned seed) {
  openvdb::initialize();
  const auto grid = Grid::create(typename Grid::ValueType(2.5));
  grid->setName("temperature");
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> index(-40, 40);
  std::uniform_real_distribution<float> value(300, 2000);
  auto accessor = grid->getAccessor();
  for (int i = 0; i < count; ++i) {
    const openvdb::Coord at(index(random), index(random), index(random));
    if (i % 5 == 0)
      accessor.setValueOff(at, static_cast<typename Grid::ValueType>(value(random)));
    else
      accessor.setValue(at, static_cast<typename Grid::ValueType>(value(random)));
  }
  return grid;
}

template <class Grid>
void expect_same_values(const VoxelField& field, const Grid& grid, double tolerance) {
  const FieldSampler sampler(field);
  const auto accessor = grid.getConstAccessor();
  for (int i = -45; i < 45; ++i)
    for (int j = -45; j < 45; ++j)
      for (int k = -45; k < 45; ++k)
        ASSERT_TRUE(relative(static_cast<double>(sampler.at(i, j, k)),
                             static_cast<double>(accessor.getValue({i, j, k})), tolerance))
            << i << " " << j << " " << k;
}

TEST(GridFile, ReadsEveryStoredVoxelInEveryEncoding) {
  const TemporaryFolder folder;
  using namespace openvdb::io;
  const std::uint32_t compressions[] = {COMPRESS_NONE,
                                        COMPRESS_ACTIVE_MASK,
                                        COMPRESS_ZIP,
                                        COMPRESS_ZIP | COMPRESS_ACTIVE_MASK,
                                        COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK,
                                        COMPRESS_BLOSC};
  for (const std::uint32_t compression : compressions)
    for (const bool half : {false, true}) {
      SCOPED_TRACE(testing::Message() << "compression " << compression << " half " << half);
      const auto single = scattered<openvdb::FloatGrid>(3000, 1);
      const auto twice = scattered<openvdb::DoubleGrid>(3000, 2);
      twice->setName("double");
      single->setSaveFloatAsHalf(half);
      twice->setSaveFloatAsHalf(half);
      const std::string path = folder.file("a.vdb");
      write(path, {single, twice}, compression);
      // 16 bits keep 11 bits of precision; a double becomes a float.
      expect_same_values(read_voxel_field(path, "temperature"), *single,
                         half ? std::ldexp(1, -11) : 0);
      expect_same_values(read_voxel_field(path, "double"), *twice, std::ldexp(1, half ? -11 : -24));
    }
}

TEST(GridFile, KeepsAnyAffineTransform) {
  const TemporaryFolder folder;
  const auto grid = scattered<openvdb::FloatGrid>(10, 3);
  // Non-uniform scale, then shear, then rotations, then a shift.
  const auto transform = openvdb::math::Transform::createLinearTransform();
  transform->preScale({0.001, 0.002, 0.0005});
  transform->postShear(0.25, openvdb::math::X_AXIS, openvdb::math::Z_AXIS);
  transform->postRotate(0.7, openvdb::math::X_AXIS);
  transform->postRotate(-1.1, openvdb::math::Y_AXIS);
  transform->postTranslate({0.1, -0.2, 0.3});
  grid->setTransform(transform);
  const std::string path = folder.file("a.vdb");
  write(path, {grid});
  const VoxelField field = read_voxel_field(path, "temperature");
  const GridInfo info = list_grids(path).at(0);
  for (const openvdb::Vec3d p :
       {openvdb::Vec3d(0, 0, 0), openvdb::Vec3d(1, 0, 0), openvdb::Vec3d(0, 1, 0),
        openvdb::Vec3d(0, 0, 1), openvdb::Vec3d(-17, 23.5, 40)}) {
    const openvdb::Vec3d expected = transform->indexToWorld(p);
    for (const AffineTransform& affine : {field.index_to_world, info.index_to_world}) {
      const Vec3 actual = affine.point({p.x(), p.y(), p.z()});
      EXPECT_TRUE(test::within(actual.x, expected.x(), 1e-14, 0.5));
      EXPECT_TRUE(test::within(actual.y, expected.y(), 1e-14, 0.5));
      EXPECT_TRUE(test::within(actual.z, expected.z(), 1e-14, 0.5));
    }
  }
}

TEST(GridFile, TilesAreBricksWhateverTheirState) {
  const TemporaryFolder folder;
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(0);
  grid->setName("absorption");
  grid->tree().addTile(1, {8, -16, 0}, 3.0f, true);      // 8^3
  grid->tree().addTile(1, {64, 0, 0}, 4.0f, false);      // inactive, yet not the background
  grid->tree().addTile(1, {72, 0, 0}, 0.0f, true);       // active, yet the background
  grid->tree().addTile(2, {128, 128, 128}, 5.0f, true);  // 128^3 = 16^3 bricks
  const std::string path = folder.file("a.vdb");
  write(path, {grid});
  const VoxelField field = read_voxel_field(path, "absorption");
  EXPECT_EQ(field.brick_origins.size(), 1u + 1u + 4096u);
  const FieldSampler sampler(field);
  EXPECT_EQ(sampler.at(8, -16, 0), 3);
  EXPECT_EQ(sampler.at(15, -9, 7), 3);
  EXPECT_EQ(sampler.at(16, -9, 7), 0);
  EXPECT_EQ(sampler.at(64, 7, 7), 4);
  EXPECT_EQ(sampler.at(255, 255, 255), 5);
  EXPECT_EQ(sampler.at(256, 255, 255), 0);

  const GridInfo info = list_grids(path).at(0);
  EXPECT_EQ(info.active_voxels, 2u * 512u + 128u * 128u * 128u);
  EXPECT_EQ(info.minimum, 0);
  EXPECT_EQ(info.maximum, 5);
}

TEST(GridFile, RefusesTilesThatWouldFillTheMemory) {
  const TemporaryFolder folder;
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(0);
  grid->setName("absorption");
  grid->tree().addTile(3, {0, 0, 0}, 1.0f, true);  // 4096^3
  const std::string path = folder.file("a.vdb");
  write(path, {grid});
  const std::string message = message_of<InputError>([&] { read_voxel_field(path, "absorption"); });
  EXPECT_TRUE(contains(message, "absorption"));
  EXPECT_TRUE(contains(message, "6.87e+04 million voxels"));
  EXPECT_EQ(list_grids(path).at(0).active_voxels, std::uint64_t{1} << 36);
}

TEST(GridFile, ListsWhatTheFileHolds) {
  const TemporaryFolder folder;
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(293.2f);
  grid->setName("temperature");
  grid->insertMeta("unit", openvdb::StringMetadata("K"));
  grid->insertMeta("made_by", openvdb::StringMetadata("a test"));
  grid->insertMeta("exposure", openvdb::FloatMetadata(0.25f));
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  grid->setSaveFloatAsHalf(true);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
  grid->tree().setValue({-3, 4, 5}, 1500);
  grid->tree().setValue({7, 4, -6}, 1800);
  const auto velocity = openvdb::Vec3SGrid::create();
  velocity->setName("vel");
  velocity->tree().setValue({1, 2, 3}, {1, 2, 3});
  velocity->tree().setValue({2, 2, 3}, {1, 2, 3});
  const std::string path = folder.file("a.vdb");
  write(path, {grid, velocity});

  const auto grids = list_grids(path);
  ASSERT_EQ(grids.size(), 2u);
  const GridInfo& t = grids[0];
  EXPECT_EQ(t.name, "temperature");
  EXPECT_EQ(t.value_type, "float");
  EXPECT_TRUE(t.readable);
  EXPECT_TRUE(t.half);
  EXPECT_EQ(t.unit, "K");
  EXPECT_EQ(t.grid_class, "fog volume");
  EXPECT_EQ(t.metadata.at("made_by"), "a test");
  EXPECT_EQ(t.metadata.at("exposure"), "0.25");
  EXPECT_EQ(t.voxel_size, 0.5);
  EXPECT_EQ(t.active_voxels, 2u);
  EXPECT_EQ(t.minimum, 1500);
  EXPECT_EQ(t.maximum, 1800);
  EXPECT_EQ(t.background, 293.25);  // OpenVDB rounds it to 16 bits, too
  EXPECT_EQ(t.index_lower, (std::array{-3, 4, -6}));
  EXPECT_EQ(t.index_upper, (std::array{7, 4, 5}));
  EXPECT_EQ(t.world_bounds, (Box{{-1.5, 2, -3}, {3.5, 2, 2.5}}));
  EXPECT_EQ(grids[1].name, "vel");
  EXPECT_EQ(grids[1].value_type, "vec3s");
  EXPECT_FALSE(grids[1].readable);
  EXPECT_EQ(grids[1].active_voxels, 2u);
  EXPECT_EQ(grids[1].index_lower, (std::array{1, 2, 3}));

  const auto brief = list_grids(path, false);
  ASSERT_EQ(brief.size(), 2u);
  EXPECT_EQ(brief[0].name, "temperature");
  EXPECT_EQ(brief[0].unit, "K");
  EXPECT_TRUE(brief[0].readable);
  EXPECT_EQ(brief[0].active_voxels, 0u);

  const VdbInfo info = vdb_info(path);
  EXPECT_EQ(info.temperature_grid, "temperature");
  EXPECT_EQ(info.absorption_grid, "");
  EXPECT_EQ(info.file_size, std::filesystem::file_size(path));
  ASSERT_EQ(info.remarks.size(), 2u);
  EXPECT_TRUE(contains(info.remarks[0], "absorption.grid"));
  EXPECT_TRUE(contains(info.remarks[1], "\"vel\""));

  const std::string missing = message_of<InputError>([&] { read_voxel_field(path, "heat"); });
  EXPECT_TRUE(contains(missing, path + ": has no grid \"heat\""));
  EXPECT_TRUE(contains(missing, "\"temperature\" (float), \"vel\" (vec3s)"));
  const std::string type = message_of<InputError>([&] { read_voxel_field(path, "vel"); });
  EXPECT_TRUE(contains(type, "grid \"vel\" has values of type vec3s"));
}

TEST(GridFile, GridsOfTheSameNameAndSharedTrees) {
  const TemporaryFolder folder;
  const auto first = scattered<openvdb::FloatGrid>(100, 4);
  const auto second = scattered<openvdb::FloatGrid>(100, 5);
  const auto shared = openvdb::gridPtrCast<openvdb::FloatGrid>(first->copyGrid());
  shared->setName("shared");
  shared->setTransform(openvdb::math::Transform::createLinearTransform(0.125));
  const std::string path = folder.file("a.vdb");
  write(path, {first, second, shared});
  expect_same_values(read_voxel_field(path, "temperature"), *first, 0);
  expect_same_values(read_voxel_field(path, "temperature[1]"), *second, 0);
  const VoxelField instance = read_voxel_field(path, "shared");
  expect_same_values(instance, *first, 0);
  EXPECT_EQ(instance.index_to_world.linear.rows[0].x, 0.125);
}

TEST(GridFile, RefusesFrustums) {
  const TemporaryFolder folder;
  const auto grid = scattered<openvdb::FloatGrid>(10, 6);
  grid->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd({0, 0, 0}, {10, 10, 10}), 0.5, 2.0, 0.1));
  const std::string path = folder.file("a.vdb");
  write(path, {grid});
  const std::string message =
      message_of<InputError>([&] { read_voxel_field(path, "temperature"); });
  EXPECT_TRUE(
      contains(message, "grid \"temperature\" has a transform of type NonlinearFrustumMap"));
  EXPECT_FALSE(list_grids(path).at(0).readable);
}

// An absorption that cannot be read is no reason to take the flame for clear.
TEST(GridFile, UnreadableAbsorptionBesideEmissionLines) {
  const TemporaryFolder folder;
  openvdb::initialize();
  const auto glow = openvdb::FloatGrid::create(0);
  glow->setName("CH*");
  glow->insertMeta("unit", openvdb::StringMetadata("W/m^3"));
  glow->tree().setValue({1, 2, 3}, 5);
  const auto hot = scattered<openvdb::FloatGrid>(10, 8);
  const auto absorption = openvdb::Vec3SGrid::create();
  absorption->setName("Absorption");
  const std::string path = folder.file("a.vdb");
  write(path, {glow, hot, absorption});
  FlameSpec flame;
  flame.file = path;
  flame.lines = {{LineKind::ch}};
  EXPECT_TRUE(contains(message_of<InputError>([&] { read_flame(flame, "", {}); }),
                       "grid \"Absorption\" has values of type vec3s"));
  // A grid of any other name could not be meant to absorb.
  absorption->setName("velocity");
  write(path, {glow, absorption});
  Execution execution;
  execution.message = [](Severity, const std::string& text) { ADD_FAILURE() << text; };
  EXPECT_TRUE(read_flame(flame, "", execution).absorption.brick_origins.empty());
}

TEST(GridFile, SaysWhyAFileCannotBeRead) {
  const TemporaryFolder folder;
  EXPECT_TRUE(contains(message_of<FileError>([&] { list_grids(folder.file("none.vdb")); }),
                       "none.vdb: cannot be opened (No such file or directory)"));
  EXPECT_TRUE(contains(message_of<FileError>([&] { list_grids(folder.path()); }), "is a folder"));
  test::spill(folder.file("text.vdb"), {'h', 'e', 'l', 'l', 'o', ' ', 'w', 'o', 'r', 'l', 'd'});
  EXPECT_TRUE(contains(message_of<FileError>([&] { list_grids(folder.file("text.vdb")); }),
                       "text.vdb: cannot be read: it is not a .vdb file"));
  test::spill(folder.file("empty.vdb"), {});
  EXPECT_TRUE(contains(message_of<FileError>([&] { list_grids(folder.file("empty.vdb")); }),
                       "it is not a .vdb file"));
}

// 304 tiles of 128^3 voxels are within the limit, and would take 2.5 GB before what is wrong with
// them is found.
TEST(GridFile, LooksAtTilesBeforeItTakesTheirMemory) {
  const TemporaryFolder folder;
  openvdb::initialize();
  const std::string path = folder.file("a.vdb");
  for (const bool far : {false, true}) {
    const auto grid = openvdb::FloatGrid::create(0);
    grid->setName("absorption");
    for (int i = 0; i < 303; ++i)
      grid->tree().addTile(2, {128 * (i % 16), 128 * (i / 16), 0}, 5.0f, true);
    if (far)
      grid->tree().setValue({(1 << 30) + 4096, 0, 0}, 7.0f);
    else
      grid->tree().addTile(2, {0, 0, 4096}, std::nanf(""), true);
    write(path, {grid});
    const std::string message =
        message_of<InputError>([&] { read_voxel_field(path, "absorption"); });
    EXPECT_TRUE(contains(message, far ? "at indices beyond 2^30" : "not a finite number"))
        << message;
    std::ifstream status("/proc/self/status");
    std::string line;
    while (std::getline(status, line) && !line.starts_with("VmHWM:")) {
    }
    EXPECT_LT(std::stoull(line.substr(6)), 1u << 20) << "kB of memory";
  }
}

}  // namespace
}  // namespace plenoflame::grid_file_test
