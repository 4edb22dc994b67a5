#include "plenoflame/scene/scene_differences.h"

#include <gtest/gtest.h>

#include "plenoflame/scene/scene_file.h"

namespace plenoflame::test::scene_differences_test {
namespace {

const char* const kScene =
    "[camera]\npreset = \"paper-plenoptic2\"\n"
    "[[flames]]\nkind = \"layered\"\n[[flames.layers]]\n[[flames.layers]]\n"
    "[[flames]]\nkind = \"layered\"\nposition = [\"1 m\", \"0 m\", \"0 m\"]\n[[flames.layers]]\n";

TEST(SceneDifferences, EachKeyByItsPath) {
  const Scene before = parse_scene(kScene, "a.toml").scene;
  EXPECT_TRUE(scene_differences(before, before).empty());
  Scene after = before;
  after.camera.lens.surfaces.at(1).diameter = 0.031;
  after.flames.at(1).position.x = 2;
  after.flames.at(0).layers.at(1).temperature = 1777;
  after.flames.at(1).layers.push_back(after.flames.at(1).layers.at(0));
  after.render.samples = 7;
  const std::vector<SceneDifference> found = scene_differences(before, after);
  const auto find = [&](const std::string& path) -> const SceneDifference* {
    for (const SceneDifference& difference : found)
      if (difference.path == path) return &difference;
    return nullptr;
  };
  const SceneDifference* const diameter = find("camera.lens.surfaces[1].diameter");
  ASSERT_NE(diameter, nullptr);
  EXPECT_EQ(diameter->after, "\"31 mm\"");
  EXPECT_NE(diameter->before, "");
  ASSERT_NE(find("flames[1].position"), nullptr);
  EXPECT_NE(find("flames[1].position")->before.find("1 m"), std::string::npos);
  EXPECT_NE(find("flames[1].position")->after.find("2 m"), std::string::npos);
  ASSERT_NE(find("flames[0].layers[1].temperature"), nullptr);
  ASSERT_NE(find("render.samples"), nullptr);
  EXPECT_EQ(find("render.samples")->after, "7");
  const SceneDifference* const added = find("flames[1].layers[1].absorption");
  ASSERT_NE(added, nullptr);
  EXPECT_EQ(added->before, "");
  for (const SceneDifference& difference : found) {
    EXPECT_NE(difference.path, "flames[0].position");
    EXPECT_NE(difference.before, difference.after);
  }
}

}  // namespace
}  // namespace plenoflame::test::scene_differences_test
