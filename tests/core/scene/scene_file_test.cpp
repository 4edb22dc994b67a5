#include "plenoflame/scene/scene_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "plenoflame/base/error.h"
#include "plenoflame/scene/scene_schema.h"
#include "scene_samples.h"

namespace plenoflame::scene_file_test {
namespace {

using test::message_of;

std::string error_of(const std::string& text) {
  return message_of([&] { parse_scene(text, "s.toml"); });
}

TEST(ParseScene, ReadsEveryKindOfValue) {
  const Scene scene = parse_scene(R"(
[camera]
position = ["1 m", "20 cm", "-3 mm"]
look_direction = [0, 1.0, "5 %"]
[camera.lens]
model = "ideal"
[[camera.lens.surfaces]]
radius = "inf"
diameter = "120mm"
[[camera.lens.surfaces]]
radius = inf
index = 1
thickness = "24.26 mm"
diameter = "100 mm"
stop = true
[camera.array]
pitch = "0.1 mm"
rotation = "30 deg"
offset = ["1 um", "2 um"]
[render]
seed = "18446744073709551615"
samples = 7
)",
                                  "s.toml")
                          .scene;
  EXPECT_EQ(scene.file, "s.toml");
  EXPECT_EQ(scene.camera.position, (Vec3{1, 0.2, -0.003}));
  EXPECT_EQ(scene.camera.look_direction, (Vec3{0, 1, 0.05}));
  EXPECT_EQ(scene.camera.lens.model, LensModel::ideal);
  ASSERT_EQ(scene.camera.lens.surfaces.size(), 2u);
  EXPECT_EQ(scene.camera.lens.surfaces[0].radius, kInfinity);
  EXPECT_EQ(scene.camera.lens.surfaces[1], (SurfaceSpec{kInfinity, 0.02426, 1, 0.1, true}));
  EXPECT_TRUE(scene.camera.array.present);
  EXPECT_EQ(scene.camera.array.pitch, 1e-4);
  EXPECT_EQ(scene.camera.array.rotation, std::acos(-1.0) / 6);
  EXPECT_EQ(scene.camera.array.offset, (Vec2{1e-6, 2e-6}));
  EXPECT_EQ(scene.camera.focus.conjugate, "array");
  EXPECT_EQ(scene.render.seed, 18446744073709551615u);
  EXPECT_EQ(scene.render.samples, 7);
  EXPECT_EQ(scene.channels, std::vector<ChannelSpec>{ChannelSpec{}});
}

TEST(ParseScene, NothingGivenIsTheDefaultCameraWithoutArray) {
  Scene expected;
  expected.file = "s.toml";
  expected.camera.focus.conjugate = "sensor";
  EXPECT_EQ(parse_scene("", "s.toml").scene, expected);
  EXPECT_FALSE(parse_scene("[camera.array]\npresent = false", "").scene.camera.array.present);
  EXPECT_EQ(parse_scene("[camera.focus]\nconjugate = \"array\"", "").scene.camera.focus.conjugate,
            "array");
}

// Messages are compared as a whole, place included: they are what a user works with.
TEST(ParseScene, SaysWhereAndWhatIsWrong) {
  EXPECT_EQ(error_of("[camera.array]\npich = \"1 mm\"\n"),
            "s.toml:2:1: unknown key \"pich\" in camera.array; did you mean \"pitch\"?");
  EXPECT_EQ(error_of("[camera.array]\n  pitch = 0.1\n"),
            "s.toml:2:11: camera.array.pitch: a unit is missing: write it in quotes with one of m, "
            "mm, um, nm, cm, km, "
            "for example \"0.1 mm\"");
  EXPECT_EQ(error_of("[camera.array]\npitch = \"0.1\"\n"),
            "s.toml:2:9: camera.array.pitch: \"0.1\" is not a length: its unit is missing (one of "
            "m, mm, um, nm, cm, km)");
  EXPECT_EQ(error_of("[camera.array]\npitch = \"0.1 K\"\n"),
            "s.toml:2:9: camera.array.pitch: \"0.1 K\" is not a length: the unit \"K\" is not one "
            "of m, mm, um, nm, cm, km");
  EXPECT_EQ(error_of("[camera.array]\npitch = \"-0.1 mm\"\n"),
            "s.toml:2:9: camera.array.pitch: -100 um is not possible here; above 0 m, at most 1 m "
            "is allowed");
  EXPECT_EQ(error_of("[camera.array]\nlattice = \"hexagnal\"\n"),
            "s.toml:2:11: camera.array.lattice: \"hexagnal\" is not one of square, hexagonal; did "
            "you mean \"hexagonal\"?");
  EXPECT_EQ(error_of("[camera.sensor]\ncolumns = 3000.5\n"),
            "s.toml:2:11: camera.sensor.columns: this is a number, but a whole number is expected");
  EXPECT_EQ(error_of("[camera.sensor]\ncolumns = -1\n"),
            "s.toml:2:11: camera.sensor.columns: -1 is not possible here; 1 to "
            "65536 is allowed");
  EXPECT_EQ(error_of("[camera]\nposition = [\"1 m\", \"2 m\",\n  3]\n"),
            "s.toml:3:3: camera.position: a unit is missing: write it in quotes with one of m, mm, "
            "um, nm, cm, km, for "
            "example \"3 mm\"");
  EXPECT_EQ(error_of("[camera]\nposition = [\"1 m\", \"2 m\"]\n"),
            "s.toml:2:12: camera.position: this has 2 components, but 3 are expected");
  EXPECT_EQ(
      error_of(
          "[[camera.lens.surfaces]]\nradius = \"1 m\"\n[[camera.lens.surfaces]]\nindex = nan\n"),
      "s.toml:4:9: camera.lens.surfaces[1].index: nan is not a number");
  EXPECT_EQ(
      error_of("[[camera.lens.surfaces]]\nindex = 0.9\n"),
      "s.toml:2:9: camera.lens.surfaces[0].index: 0.9 is not possible here; 1 to 5 is allowed");
  EXPECT_EQ(error_of("[flames]\nkind = \"vdb\"\n"),
            "s.toml:1:1: flames is a table, but it must be a list of tables: write [[flames]]");
  EXPECT_EQ(error_of("[[camera]]\n"),
            "s.toml:1:1: camera is an array, but it must be a table of keys: write [camera]");
  EXPECT_EQ(error_of("[camera]\npreset = \"paper-plenoptic\"\n"),
            "s.toml:2:10: there is no camera preset \"paper-plenoptic\"; did you mean "
            "\"paper-plenoptic1\"?");
  EXPECT_EQ(
      error_of("camera = 1\n"),
      "s.toml:1:10: camera is a whole number, but it must be a table of keys: write [camera]");
  EXPECT_EQ(error_of("[camera.sensor]\nrwos = 3\n"),
            "s.toml:2:1: unknown key \"rwos\" in camera.sensor; did you mean \"rows\"?");
  EXPECT_EQ(error_of("[camera.focus]\nzzzzzz = 3\n"),
            "s.toml:2:1: unknown key \"zzzzzz\" in camera.focus; known are mode, lens_distance, "
            "object_distance, conjugate");
  EXPECT_EQ(error_of("[renderer]\n"),
            "s.toml:1:2: unknown key \"renderer\"; did you mean \"render\"?");
  EXPECT_EQ(error_of("channels = []\n"),
            "s.toml:1:12: channels has 0 items, but 1 to 64 are allowed");
  EXPECT_EQ(error_of("[render]\nseed = -1\n").substr(0, 24), "s.toml:2:8: render.seed:");
  EXPECT_EQ(error_of("[render]\nsamples = 1\nsamples = 2\n").substr(0, 31),
            "s.toml:3:11: this is not TOML: ");
  EXPECT_EQ(error_of("[render\n").substr(0, 8), "s.toml:1");
  EXPECT_NE(error_of("\"camera.sensor.rows\" = 3\n"), "");
  EXPECT_NE(error_of("[camera.sensor]\n\"rows[]\" = 3\n"), "");
  EXPECT_NE(error_of("[camera.lens]\nsurfaces = [1]\n"), "");
  EXPECT_NE(error_of("[camera.array]\ntypes = [{}, {}, {}, {}]\n"), "");
  EXPECT_NE(error_of("[[flames.layers]]\nname = 1979-05-27\n"), "");
  EXPECT_EQ(error_of("preset = \"r12\"").substr(0, 32), "s.toml:1:1: unknown key \"preset\"");
}

TEST(ParseScene, TheFirstMistakeOfTheFileIsReported) {
  EXPECT_EQ(error_of("[render]\nzzz = 1\n[camera]\nabc = 2\n").substr(0, 11), "s.toml:2:1:");
}

TEST(ParseScene, PresetIsOverriddenKeyByKeyAndListsAsAWhole) {
  const Scene preset = parse_scene("[camera]\npreset = \"paper-plenoptic2\"", "").scene;
  ASSERT_EQ(preset.camera.array.types.size(), 3u);
  // The order in the file does not matter.
  const Scene scene = parse_scene(R"(
camera.array.pitch = "0.2 mm"
camera.preset = "paper-plenoptic2"
camera.array.types = [{name = "only", radius_front = "1 mm"}]
)",
                                  "")
                          .scene;
  EXPECT_EQ(scene.camera.array.pitch, 2e-4);
  ASSERT_EQ(scene.camera.array.types.size(), 1u);
  EXPECT_EQ(scene.camera.array.types[0], (MicrolensSpec{"only", 1e-3, kInfinity, 1.5, 0}));
  Scene back = scene;
  back.camera.array.pitch = preset.camera.array.pitch;
  back.camera.array.types = preset.camera.array.types;
  EXPECT_EQ(back, preset);
}

TEST(ParseScene, PositionsLeadBackToTheFileOrThePreset) {
  const SceneDocument document = parse_scene(
      "[camera]\npreset = \"paper-plenoptic2\"\n[camera.array]\npitch = \"1 mm\"\n[[flames]]\n  "
      "file = \"a\"\n",
      "s.toml");
  const PositionMap& positions = document.positions;
  EXPECT_EQ(to_string(positions.find("camera.array.pitch")), "s.toml:4:9");
  EXPECT_EQ(to_string(positions.find("flames[0].file")), "s.toml:6:10");
  EXPECT_EQ(to_string(positions.find("flames[0].position")),
            to_string(positions.find("flames[0]")));
  EXPECT_EQ(positions.find("flames[0].position").line, 5);
  const std::string text = test::source_text("core/presets/cameras/paper-plenoptic2.toml");
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<long>(text.find("columns")), '\n');
  EXPECT_EQ(to_string(positions.find("camera.sensor.columns")),
            "preset paper-plenoptic2:" + std::to_string(line) + ":11");
  EXPECT_EQ(to_string(positions.find("develop.bits")), "");
  // A list that is replaced forgets the places of the old items.
  const SceneDocument replaced =
      parse_scene("[camera]\npreset = \"paper-plenoptic2\"\narray.types = [{}]\n", "s.toml");
  EXPECT_EQ(replaced.positions.find("camera.array.types[2].index").line, 3);
}

TEST(WriteScene, ReadsBackBitForBit) {
  Scene scene = test::full_scene();
  const SceneDocument document = parse_scene(write_scene(scene), "full.toml");
  EXPECT_EQ(document.scene, scene) << write_scene(scene);
  EXPECT_TRUE(
      std::signbit(document.scene.camera.look_direction.z));  // -0 == 0, so == does not see it
  EXPECT_EQ(write_scene(document.scene), write_scene(scene));

  scene = parse_scene("", "empty.toml").scene;
  EXPECT_EQ(parse_scene(write_scene(scene), "empty.toml").scene, scene) << write_scene(scene);
  for (const std::string& name : preset_names(PresetKind::camera)) {
    scene = parse_scene("[camera]\npreset = \"" + name + "\"", "p").scene;
    EXPECT_EQ(parse_scene(write_scene(scene), "p").scene, scene) << name;
  }
}

TEST(WriteScene, RefusesWhatNoFileCanHold) {
  Scene scene = test::full_scene();
  scene.camera.array.pitch = std::nan("");
  EXPECT_EQ(message_of([&] { write_scene(scene); }),
            "camera.array.pitch: a length is not a number (NaN)");
  scene = test::full_scene();
  scene.flames[0].name = "\xFF";
  EXPECT_EQ(message_of([&] { write_scene(scene); }), "flames[].name: a text is not UTF-8");
  scene = test::full_scene();
  scene.channels.clear();  // would read back as the default channel if nothing were written
  EXPECT_NE(error_of(write_scene(scene)), "");
}

TEST(SceneFile, WritesAndReadsFiles) {
  const auto folder = std::filesystem::temp_directory_path() /
                      ("plenoflame_scene_file_test_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  Scene scene = test::full_scene();
  scene.file = (folder / "scene.toml").string();
  write_scene_file(scene.file, scene);
  EXPECT_EQ(read_scene_file(scene.file).scene, scene);
  EXPECT_THROW(read_scene_file((folder / "missing.toml").string()), FileError);
  EXPECT_THROW(read_scene_file(folder.string()), FileError);
  EXPECT_THROW(write_scene_file((folder / "no" / "such.toml").string(), scene), FileError);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace plenoflame::scene_file_test
