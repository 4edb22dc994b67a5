#include "plenoflame/scene/compile.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plenoflame/base/error.h"
#include "scene_samples.h"
#include "support/uniform_medium.h"

namespace plenoflame {
namespace {

using test::message_of;

/// A flame of kind vdb, at line 5 of the file.
SceneDocument grid_scene(const std::string& more = "") {
  return parse_scene(
      "[camera]\npreset = \"paper-plenoptic2\"\n[[flames]]\nkind = \"vdb\"\nfile = \"f.vdb\"\n" +
          more,
      "folder/s.toml");
}

MediumLoader in_box(const Box& box) {
  return [box](const FlameSpec&, const std::string&, const std::vector<SourceFunction>&,
               const Execution&) { return std::make_unique<test::UniformMedium>(box); };
}

/// What compile() throws, or the warnings that it gives, one per line.
std::string outcome(const SceneDocument& document, const MediumLoader& loader) {
  std::string warnings;
  Execution execution;
  execution.message = [&](Severity severity, const std::string& text) {
    if (severity == Severity::warning) warnings += text + "\n";
  };
  try {
    compile(document.scene, loader, execution, document.positions);
  } catch (const Error& error) {
    return error.what();
  }
  return warnings;
}

TEST(Compile, RefusesWhatValidateRefuses) {
  Scene scene = grid_scene().scene;
  scene.camera.array.pitch = 0.9e-4;
  EXPECT_NE(message_of([&] {
              compile(scene, in_box({{0.9, 0, 0}, {1, 0.1, 0.1}}));
            }).find("so they overlap"),
            std::string::npos);
}

TEST(Compile, SaysWhatValidateWarnsOf) {
  EXPECT_EQ(
      outcome(parse_scene("[camera]\npreset = \"paper-plenoptic2\"\n", "s.toml"), load_core_medium),
      "s.toml: the scene has no flame, so its picture is black\n");
}

TEST(Compile, FlameOfAFileInTheCamera) {
  // The camera stands at the origin and looks along x.
  EXPECT_EQ(outcome(grid_scene(), in_box({{-0.5, -1, -1}, {2, 1, 1}})),
            "folder/s.toml:3:1: flame \"f.vdb\" reaches into the camera: it extends from -500 mm "
            "to 2 m in front of the front vertex; move it away");
  EXPECT_EQ(outcome(grid_scene("name = \"mine\"\nposition = [\"0 m\", \"0 m\", \"0 m\"]\n"),
                    in_box({{-2, -1, -1}, {-1, 1, 1}})),
            "folder/s.toml:7:12: flame \"mine\" lies behind the front of the camera; move it to "
            "where the camera looks");
  EXPECT_EQ(outcome(grid_scene(), in_box({{0.2, -0.1, -0.1}, {0.4, 0.1, 0.1}})),
            "folder/s.toml:3:1: flame \"f.vdb\" begins 200 mm in front of the front vertex, inside "
            "the front focal point at 295.9 mm: the image of that part is virtual and far out of "
            "focus\n");
  EXPECT_EQ(outcome(grid_scene(), in_box({{0.9, -0.1, -0.1}, {1.1, 0.1, 0.1}})), "");
}

TEST(Compile, SaysWhichLineNamesTheFileThatIsWrong) {
  const auto throwing = [](const auto& error) {
    return [error](const FlameSpec&, const std::string& folder, const std::vector<SourceFunction>&,
                   const Execution& execution) -> std::unique_ptr<Medium> {
      EXPECT_EQ(folder, "folder");
      execution.warn("cold");
      throw error;
    };
  };
  EXPECT_EQ(outcome(grid_scene(), throwing(InputError("f.vdb: grid x"))),
            "folder/s.toml:5:8: f.vdb: grid x");
  EXPECT_EQ(outcome(grid_scene(), throwing(FileError("f.vdb: cut"))),
            "folder/s.toml:5:8: f.vdb: cut");
  const auto warning = [](const FlameSpec&, const std::string&, const std::vector<SourceFunction>&,
                          const Execution& execution) {
    execution.warn("f.vdb: cold");
    return std::make_unique<test::UniformMedium>(Box{{0.9, -0.1, -0.1}, {1.1, 0.1, 0.1}});
  };
  EXPECT_EQ(outcome(grid_scene(), warning), "folder/s.toml:5:8: f.vdb: cold\n");
}

}  // namespace
}  // namespace plenoflame
