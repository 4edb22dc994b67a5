#include "plenoflame/scene/cameras.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include "plenoflame/media/layered_medium.h"
#include "plenoflame/media/voxel_medium.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/scene_schema.h"
#include "plenoflame/scene/scene_settings.h"
#include "plenoflame/scene/validate.h"
#include "scene_samples.h"

namespace plenoflame::cameras_test {
namespace {

using test::message_of;

/// A scene file's text with its [camera] as an item of [[cameras]].
std::string as_item(const std::string& text, const std::string& name) {
  std::string item = std::regex_replace(text, std::regex("\\[camera\\]"), "[[cameras]]");
  item = std::regex_replace(item, std::regex("\\[camera\\."), "[cameras.");
  const std::string head = "[[cameras]]\nname = \"" + name + "\"\n";
  return std::regex_replace(item, std::regex("\\[\\[cameras\\]\\]\n(name = .*\n)?"), head);
}

constexpr const char* kThree = R"([[cameras]]
name = "left"
preset = "paper-previous-60x60"

[[cameras]]
name = "right"
like = "left"
position = ["1 m", "-1 m", "0 m"]
look_direction = [0, 1, 0]

[[cameras]]
name = "plain"
like = "right"
[cameras.array]
present = false
[cameras.focus]
object_distance = "0.9 m"

[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
)";

SceneDocument three() {
  return parse_scene(kThree, "three.toml");
}

std::string error_of(const std::string& text) {
  return message_of([&] { validate(parse_scene(text, "s.toml")); });
}

/// Replaces all of `from`.
std::string with(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

// The same text as [camera] is the reference: it is read by paths without indices.
TEST(Cameras, AnItemIsReadAsTheOnlyCameraIs) {
  std::vector<std::string> texts{write_scene(test::full_scene()),
                                 test::source_text("examples/lenslets-30.toml"),
                                 test::source_text("examples/paper-objects-5m-no-array.toml")};
  for (const std::string& preset : preset_names(PresetKind::camera))
    texts.push_back("[camera]\npreset = \"" + preset + "\"\n");
  for (const std::string& text : texts) {
    const SceneDocument alone = parse_scene(text, "s.toml");
    const SceneDocument item = parse_scene(as_item(text, "one"), "s.toml");
    ASSERT_EQ(item.scene.cameras.size(), 1U);
    Scene chosen = for_camera(item.scene);
    EXPECT_EQ(chosen.camera.name, "one");
    chosen.camera.name = alone.scene.camera.name;
    EXPECT_EQ(chosen, alone.scene) << text;
  }
}

TEST(Cameras, AreWrittenAndReadBackBitForBit) {
  Scene scene = test::full_scene();
  insert_item(scene, "cameras", 0);
  scene.cameras[1].position = {1.0 / 3, -0.1, 7};
  scene.cameras[1].lens.surfaces.resize(1);
  scene.cameras[1].array.types.clear();
  Scene back = parse_scene(write_scene(scene), scene.file).scene;
  EXPECT_EQ(back, scene);
  EXPECT_EQ(write_scene(scene).find("[camera]"), std::string::npos);
  EXPECT_EQ(write_scene(test::full_scene()).find("cameras"), std::string::npos);
}

// A path that reaches the wrong camera shows as another value changing, too.
TEST(Cameras, EveryKeyReachesTheCameraOfItsIndex) {
  Scene scene = test::full_scene();
  insert_item(scene, "cameras", 0);
  const std::vector<std::string> paths = scene_paths(scene);
  int checked = 0;
  for (const std::string& path : paths) {
    EXPECT_FALSE(path.starts_with("camera.")) << path;
    if (!path.starts_with("cameras[1].")) continue;
    const SchemaKey& key = *find_schema_key(path);
    const std::string before = get_text(scene, path);
    std::string other = before;
    if (key.type == ValueType::boolean) other = before == "true" ? "false" : "true";
    if (key.type == ValueType::integer || key.type == ValueType::natural) other = "3";
    if (key.type == ValueType::choice)
      other = std::string(key.choices[key.choices[0] == before ? 1 : 0]);
    if (key.type == ValueType::text)
      other = path.ends_with(".aspheric") ? "120 1/m^3" : before + "x";
    if (other == before) continue;  // numbers and vectors: their kind is tested with one camera
    ++checked;
    Scene changed = scene;
    set_text(changed, path, other);
    EXPECT_EQ(changed.cameras[0], scene.cameras[0]) << path;
    EXPECT_NE(changed.cameras[1], scene.cameras[1]) << path;
    EXPECT_EQ(get_text(changed, "cameras[0]" + path.substr(10)),
              get_text(scene, "cameras[0]" + path.substr(10)));
  }
  EXPECT_GT(checked, 25);
  EXPECT_EQ(message_of([&] { set_text(scene, "camera.sensor.rows", "3"); }),
            "the scene has several cameras; write \"cameras[0].sensor.rows\" for camera "
            "\"camera1\"");
  EXPECT_NE(message_of([&] { get_text(scene, "cameras[2].name"); }), "");
}

TEST(Cameras, LikeStartsFromAnEarlierOne) {
  const Scene scene = three().scene;
  CameraSpec left = for_camera(scene, "left").camera, right = for_camera(scene, "right").camera;
  EXPECT_EQ(right.position, (Vec3{1, -1, 0}));
  right.position = left.position;
  right.look_direction = left.look_direction;
  right.name = left.name;
  EXPECT_EQ(right, left);
  const CameraSpec plain = for_camera(scene, "plain").camera;
  EXPECT_FALSE(plain.array.present);
  EXPECT_EQ(plain.focus.conjugate, "sensor");
  EXPECT_EQ(plain.position, (Vec3{1, -1, 0}));
  EXPECT_EQ(error_of(with(kThree, "like = \"left\"", "like = \"rihgt\"")),
            "s.toml:7:8: cameras[1].like: there is no camera \"rihgt\" before it; known are left");
  EXPECT_EQ(error_of(with(kThree, "like = \"right\"", "like = \"righ\"")),
            "s.toml:13:8: cameras[2].like: there is no camera \"righ\" before it; did you mean "
            "\"right\"?");
  EXPECT_NE(error_of(with(kThree, "like = \"left\"", "like = \"left\"\npreset = \"r12\"")), "");
}

// The reference is the same value written into the first camera's item.
TEST(Cameras, LikeTakesValuesThatAreSetAsThoseOfTheFile) {
  const auto set = [](const std::vector<std::string>& values) {
    SceneSettings settings;
    settings.values = values;
    return parse_scene(kThree, "three.toml", settings);
  };
  const auto in_file = [](const std::string& lines) {
    const std::string head = "preset = \"paper-previous-60x60\"\n";
    return parse_scene(with(kThree, head, head + lines), "three.toml").scene;
  };
  const Scene noisy = in_file("[cameras.sensor]\nfill_factor = 0.5\n");
  EXPECT_EQ(noisy.cameras[2].sensor.fill_factor, 0.5);
  EXPECT_EQ(set({"cameras[0].sensor.fill_factor=0.5"}).scene, noisy);
  EXPECT_EQ(set({"cameras.left.sensor.fill_factor=0.5"}).scene, noisy);
  // Stops and presets, which are no keys; a camera's own values stay.
  EXPECT_EQ(set({"cameras[0].lens.f_number=20"}).scene, in_file("[cameras.lens]\nf_number = 20\n"));
  const Scene other = set({"cameras[left].preset=r12"}).scene;
  EXPECT_EQ(other.cameras[1].sensor.columns, 4080);
  EXPECT_EQ(other.cameras[1].array, other.cameras[0].array);
  EXPECT_EQ(set({"cameras.left.position=0m,0m,1m"}).scene.cameras[2].position, (Vec3{1, -1, 0}));
  // One in the middle reaches the cameras behind it only; the later of two values counts, and one
  // for the camera itself comes before neither.
  const SceneDocument middle =
      set({"cameras.plain.sensor.fill_factor=0.7", "cameras.right.sensor.fill_factor=0.6",
           "cameras.right.sensor.fill_factor=0.5"});
  EXPECT_NE(middle.scene.cameras[0].sensor.fill_factor, 0.5);
  EXPECT_EQ(middle.scene.cameras[1].sensor.fill_factor, 0.5);
  EXPECT_EQ(middle.scene.cameras[2].sensor.fill_factor, 0.7);
  EXPECT_EQ(to_string(set({"cameras[0].sensor.fill_factor=0.5"})
                          .positions.find("cameras[2].sensor.fill_factor")),
            "setting cameras[0].sensor.fill_factor");
  // Names are those that cameras have when their own turn comes.
  EXPECT_EQ(
      message_of([&] { set({"cameras.left.name=west"}); }),
      "three.toml:7:8: cameras[1].like: there is no camera \"left\" before it; known are west");
  EXPECT_EQ(message_of([&] { set({"cameras.lefft.sensor.rows=3"}); }).substr(0, 102),
            "setting cameras.lefft.sensor.rows: cameras is a list, and none of its items is named "
            "\"lefft\"; did you ");
  EXPECT_NE(message_of([&] { set({"cameras[3].sensor.rows=3"}); }).find("there is no number 3"),
            std::string::npos);
}

TEST(Cameras, OneIsChosenByItsName) {
  const SceneDocument document = three();
  EXPECT_EQ(camera_names(document.scene), (std::vector<std::string>{"left", "right", "plain"}));
  const SceneDocument right = for_camera(document, "right");
  EXPECT_TRUE(right.scene.cameras.empty());
  EXPECT_EQ(right.scene.camera.name, "right");
  EXPECT_EQ(right.scene.flames, document.scene.flames);
  EXPECT_EQ(right.positions.find("camera.position").line, 8);
  EXPECT_EQ(right.positions.find("camera.sensor.rows").file, "preset paper-previous-60x60");
  EXPECT_EQ(for_camera(document, "plain").positions.find("camera.focus.object_distance").line, 17);
  EXPECT_EQ(message_of([&] { for_camera(document, "lefft"); }),
            "there is no camera \"lefft\"; did you mean \"left\"?");
  EXPECT_EQ(message_of([&] { for_camera(document); }),
            "the scene has the cameras left, right, plain; choose one of them");
  EXPECT_EQ(message_of(
                [&] { for_camera(parse_scene("[camera]\npreset = \"r12\"\n", "s.toml"), "left"); }),
            "there is no camera \"left\"; the scene has one, without a name");
}

TEST(Cameras, WhatIsWrongIsSaidAtItsPlace) {
  EXPECT_EQ(error_of(kThree), "");
  EXPECT_EQ(error_of(with(kThree, "name = \"right\"", "name = \"left\"")).substr(0, 98),
            "s.toml:13:8: cameras[2].like: there is no camera \"right\" before it; known are left, "
            "left");
  EXPECT_EQ(error_of(with(kThree, "name = \"plain\"", "name = \"left\"")),
            "s.toml:12:8: cameras[0] and cameras[2] are both called \"left\"; give one of them "
            "another name");
  EXPECT_EQ(error_of(with(kThree, "name = \"plain\"\n", "")),
            "s.toml:11:1: cameras[2] has no name; each of several cameras needs one of its own");
  EXPECT_EQ(error_of(with(kThree, "name = \"plain\"", "name = \"a/b\"")),
            "s.toml:12:8: cameras[2].name is \"a/b\"; letters, digits, _ and - are allowed");
  EXPECT_EQ(error_of(std::string(kThree) + "[camera]\npreset = \"r12\"\n"),
            "s.toml:22:1: the scene has both [camera] and [[cameras]]; make the one camera an item "
            "of [[cameras]] with a name");
  EXPECT_EQ(error_of(with(kThree, "[\"1 m\", \"-1 m\", \"0 m\"]", "[\"1 m\", \"5 mm\", \"0 m\"]")),
            "s.toml:21:12: flame \"paper-layered\" reaches into camera \"right\": it extends from "
            "-15 mm to 5 mm in front of the front vertex; move it away");
  EXPECT_EQ(error_of(with(kThree, "object_distance = \"0.9 m\"", "object_distance = \"1 mm\""))
                .substr(0, 31),
            "s.toml:17:19: camera \"plain\": t");
}

TEST(Cameras, WarningsThatAllShareAreSaidOnce) {
  const SceneDocument document = parse_scene(
      with(kThree,
           "[[flames]]\npreset = \"paper-layered\"\nposition = [\"1 m\", \"0 m\", \"-29 mm\"]\n",
           ""),
      "s.toml");
  EXPECT_EQ(validate(document).size(), 1U);
}

TEST(Cameras, ItemsAreInsertedAndErased) {
  Scene scene = parse_scene("[camera]\npreset = \"r12\"\n", "s.toml").scene;
  const CameraSpec only = scene.camera;
  insert_item(scene, "cameras", 0);
  ASSERT_EQ(camera_names(scene), (std::vector<std::string>{"camera1", "camera2"}));
  EXPECT_EQ(scene.cameras[1].lens, only.lens);
  EXPECT_TRUE(check_scene(scene).size() == 1) << "no flame";
  insert_item(scene, "cameras", 1);
  EXPECT_EQ(camera_names(scene), (std::vector<std::string>{"camera1", "camera3", "camera2"}));
  erase_item(scene, "cameras", 0);
  erase_item(scene, "cameras", 0);
  EXPECT_EQ(camera_names(scene), (std::vector<std::string>{"camera2"}));
  EXPECT_EQ(message_of([&] { erase_item(scene, "cameras", 0); }), "cameras needs at least 1 items");
}

LightField picture(const CompiledScene& scene) {
  RenderSettings settings;
  settings.samples = 4;
  settings.window = {288, 288, 24, 24};
  return render(scene, settings).light_field;
}

// The reference is each camera's scene, compiled on its own.
TEST(Cameras, FlamesAreLoadedOnceAndPicturesAreThoseOfEachCameraAlone) {
  SceneDocument document = three();
  document.scene.flames.push_back(document.scene.flames.front());
  document.scene.flames.back().position.z += 0.01;
  int loaded = 0;
  const MediumLoader counting = [&](const FlameSpec& flame, const std::string& folder,
                                    const std::vector<SourceFunction>& channels,
                                    const Execution& execution) {
    ++loaded;
    return load_core_medium(flame, folder, channels, execution);
  };
  const CompiledScene left = compile(for_camera(document.scene, "left"), counting);
  EXPECT_EQ(loaded, 2);
  for (const char* name : {"right", "plain"}) {
    const Scene scene = for_camera(document.scene, name);
    loaded = 0;
    const CompiledScene with_left = compile(scene, counting, {}, {}, {&left});
    EXPECT_EQ(loaded, 0) << name;
    EXPECT_EQ(with_left.medium, left.medium);
    const LightField together = picture(with_left), alone = picture(compile(scene));
    EXPECT_EQ(together.channels[0].flux.pixels, alone.channels[0].flux.pixels) << name;
    double brightest = 0;
    for (const float value : alone.channels[0].flux.pixels)
      brightest = std::max(brightest, static_cast<double>(value));
    EXPECT_GT(brightest, 0) << name;
  }
  // The next frame of the left camera, after the right one's: its camera from its own last frame,
  // the flames from the other camera's.
  Scene next = for_camera(document.scene, "right");
  for (FlameSpec& flame : next.flames) flame.position.y = 1e-3;
  const CompiledScene right = compile(next, counting);
  next = for_camera(document.scene, "left");
  for (FlameSpec& flame : next.flames) flame.position.y = 1e-3;
  loaded = 0;
  const CompiledScene later = compile(next, counting, {}, {}, {&left, &right});
  EXPECT_EQ(loaded, 0);
  EXPECT_EQ(later.medium, right.medium);
  EXPECT_EQ(picture(later).channels[0].flux.pixels, picture(compile(next)).channels[0].flux.pixels);
  // Behind a filter a flame is another one; the camera of the same scene is not.
  document.scene.cameras[1].transmission.filter = "400 nm 0.9, 700 nm 0.8";
  loaded = 0;
  compile(for_camera(document.scene, "right"), counting, {}, {}, {&left});
  EXPECT_EQ(loaded, 2);
}

// A flame of voxels that moves, grows and dims is loaded once.
TEST(Cameras, FlamesThatMoveKeepTheirVoxels) {
  VoxelField absorption, temperature;
  absorption.name = temperature.name = "test";
  absorption.index_to_world.linear = {{{{8e-3, 0, 0}, {0, 8e-3, 0}, {0, 0, 8e-3}}}};
  temperature.index_to_world = absorption.index_to_world;
  absorption.brick_origins = temperature.brick_origins = {{0, 0, 0}};
  absorption.values.assign(512, 20);
  temperature.values.assign(512, 1700);
  int loaded = 0;
  const MediumLoader counting = [&](const FlameSpec& flame, const std::string&,
                                    const std::vector<SourceFunction>& channels, const Execution&) {
    ++loaded;
    return make_voxel_medium(
        temperature, absorption, VoxelInterpolation::trilinear, channels,
        {.placement = {flame.scale, {rotation_xyz(flame.rotation), flame.position}}});
  };
  Scene scene = for_camera(three().scene, "left");
  scene.flames.resize(1);
  scene.flames[0].kind = FlameKind::vdb;
  scene.flames[0].file = "test.vdb";
  scene.flames[0].layers.clear();
  scene.flames[0].position = {1, -0.028, -0.028};
  const CompiledScene first = compile(scene, counting);
  EXPECT_EQ(loaded, 1);
  scene.flames[0].position.y += 2e-3;
  scene.flames[0].scale = 1.5;
  scene.flames[0].brightness = 0.5;
  const CompiledScene second = compile(scene, counting, {}, {}, {&first});
  EXPECT_EQ(loaded, 1);
  const LightField kept = picture(second), made = picture(compile(scene, counting));
  EXPECT_EQ(loaded, 2);
  EXPECT_EQ(kept.channels[0].flux.pixels, made.channels[0].flux.pixels);
  EXPECT_NE(kept.channels[0].flux.pixels, picture(first).channels[0].flux.pixels);
  // Another file is another flame.
  scene.flames[0].file = "other.vdb";
  compile(scene, counting, {}, {}, {&first, &second});
  EXPECT_EQ(loaded, 3);
}

}  // namespace
}  // namespace plenoflame::cameras_test
