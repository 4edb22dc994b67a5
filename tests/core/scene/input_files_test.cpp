#include "plenoflame/scene/input_files.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "support/temporary_folder.h"

namespace plenoflame::input_files_test {
namespace {

namespace fs = std::filesystem;

/// A folder with a file of each kind, and a scene that names them.
class InputFiles : public testing::Test {
 protected:
  InputFiles() {
    for (const char* name : {"flame.vdb", "body.ply", "plate.png", "filter.csv"})
      std::ofstream(folder_ / name) << name;
    scene_.file = (folder_ / "scene.toml").string();
    scene_.flames.resize(2);
    scene_.flames[1].kind = FlameKind::vdb;
    scene_.flames[1].file = "flame.vdb";
    scene_.surfaces.resize(1);
    scene_.surfaces[0].file = "body.ply";
    scene_.surfaces[0].material.texture.file = "plate.png";
    scene_.channels.resize(1);
    scene_.channels[0].file = "filter.csv";
  }

  test::TemporaryFolder temporary_;
  fs::path folder_{temporary_.path()};
  Scene scene_;
};

TEST_F(InputFiles, AreThoseOfFlamesMeshesTexturesAndCurves) {
  const std::vector<InputFile> files = input_files(scene_);
  ASSERT_EQ(files.size(), 4u);
  EXPECT_EQ(files[0].name, "flame.vdb");
  EXPECT_EQ(files[1].name, "body.ply");
  EXPECT_EQ(files[2].name, "plate.png");
  EXPECT_EQ(files[3].name, "filter.csv");
  for (const InputFile& file : files) EXPECT_EQ(file.size, file.name.size());
}

TEST_F(InputFiles, ShowWhichOneWasChanged) {
  const std::vector<InputFile> before = input_files(scene_);
  EXPECT_EQ(input_files(scene_), before);
  std::ofstream(folder_ / "plate.png") << "another picture";
  const fs::path curve = folder_ / "filter.csv";  // of the same length, later
  fs::last_write_time(curve, fs::last_write_time(curve) + std::chrono::seconds(2));
  const std::vector<InputFile> after = input_files(scene_);
  EXPECT_EQ(after[0], before[0]);
  EXPECT_EQ(after[1], before[1]);
  EXPECT_NE(after[2], before[2]);
  EXPECT_NE(after[3], before[3]);
}

TEST_F(InputFiles, OneThatIsMissingIsListed) {
  const InputFile before = input_files(scene_).front();
  fs::remove(folder_ / "flame.vdb");
  const InputFile after = input_files(scene_).front();
  EXPECT_EQ(after.name, "flame.vdb");
  EXPECT_EQ(after.size, 0u);
  EXPECT_NE(after, before);
}

}  // namespace
}  // namespace plenoflame::input_files_test
