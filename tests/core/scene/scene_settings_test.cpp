// A scene with settings against the same scene with the values written into its file.
#include "plenoflame/scene/scene_settings.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "scene_samples.h"
#include "support/approx.h"

namespace plenoflame::scene_settings_test {
namespace {

using test::message_of;

const std::string kCamera = "[camera]\npreset = \"paper-plenoptic2\"\n";
const std::string kFlames =
    "[[flames]]\npreset = \"paper-layered\"\nposition = [\"1 m\", \"0 m\", \"-29 mm\"]\n"
    "[[flames]]\nname = \"my.candle\"\nkind = \"vdb\"\nfile = \"candle.vdb\"\n"
    "[[channels]]\nname = \"red\"\nkind = \"band\"\nwavelength = \"650 nm\"\nwidth = \"10 nm\"\n";

Scene with(const std::vector<std::string>& values, const std::string& text = kCamera + kFlames) {
  SceneSettings settings;
  settings.values = values;
  return parse_scene(text, "a.toml", settings).scene;
}

std::string error(const std::vector<std::string>& values) {
  return message_of([&] { with(values); });
}

TEST(WindowIndex, StandsInPlaceOfAGlass) {
  const auto window = [](const std::string& keys) {
    return kCamera + kFlames + "[[windows]]\nshape = \"plate\"\ndiameter = \"80 mm\"\n" + keys;
  };
  const std::string glass = "glass = \"N-BK7\"\n", index = "index = 1.46\n";
  const auto refusal = [&](const std::string& keys, const std::vector<std::string>& values) {
    return message_of([&] { with(values, window(keys)); });
  };
  const std::string both = refusal(glass + index, {});  // line 19 of the file
  EXPECT_NE(both.find("a.toml:19:9: windows[0].index is 1.46, but the glass of the window, "
                      "\"N-BK7\", has an index of 1.514"),
            std::string::npos)
      << both;
  EXPECT_EQ(both.find('\n'), std::string::npos);
  const std::string set = refusal(glass, {"windows[0].index=1.46"});
  EXPECT_NE(set.find("setting windows[0].index: windows[0].index is 1.46"), std::string::npos)
      << set;
  // A value that is set replaces the one of the file.
  const double bk7 = 1.5145;  // Schott's catalogue at 650 nm
  EXPECT_TRUE(
      test::relative(with({"windows[0].glass=N-BK7"}, window(index)).windows[0].index, bk7, 2e-4));
  EXPECT_EQ(with({"windows[0].glass=", "windows[0].index=1.46"}, window(glass)).windows[0].index,
            1.46);
  // A scene that was written is the same again, and has no index that could grow wrong.
  const Scene scene = with({}, window(glass));
  const std::string text = write_scene(scene);
  EXPECT_EQ(parse_scene(text, "a.toml").scene, scene);
  const Scene other = with({"channels[0].wavelength=450 nm"}, text);
  EXPECT_TRUE(test::relative(other.windows[0].index, 1.5253, 2e-4));  // the same catalogue
  // Older ones have the glass's own index beside it.
  std::string old = text;
  old.insert(old.find("glass = \"N-BK7\""), fmt::format("index = {}\n", scene.windows[0].index));
  EXPECT_EQ(parse_scene(old, "a.toml").scene, scene);
}

TEST(SceneSettings, AreAsIfTheyStoodInTheFile) {
  EXPECT_EQ(with({}), parse_scene(kCamera + kFlames, "a.toml").scene);
  EXPECT_EQ(with({"camera.focus.object_distance=0.9 m", "camera.array.opaque_between = false",
                  "camera.look_direction=1, 0.1, 0", "render.seed=18446744073709551615"}),
            parse_scene(kCamera +
                            "look_direction = [1, 0.1, 0]\n"
                            "[camera.focus]\nobject_distance = \"0.9 m\"\n"
                            "[camera.array]\nopaque_between = false\n"
                            "[render]\nseed = \"18446744073709551615\"\n" +
                            kFlames,
                        "a.toml")
                .scene);
  // The later of two counts; a text may hold an equals sign.
  EXPECT_EQ(with({"render.samples=3", "render.samples=5"}).render.samples, 5);
  EXPECT_EQ(with({"flames[0].name=a=b"}).flames[0].name, "a=b");
  // Presets, and the array that a file's table would bring along.
  EXPECT_EQ(with({"camera.preset=r12"}, ""),
            parse_scene("[camera]\npreset = \"r12\"\n", "a.toml").scene);
  EXPECT_TRUE(with({"camera.array.pitch=1mm"}, "").camera.array.present);
  EXPECT_FALSE(with({"camera.array.present=false"}).camera.array.present);
  EXPECT_EQ(with({"camera.array.present=false"}).camera.focus.conjugate, "sensor");
  EXPECT_EQ(
      with({"camera.array.present=false", "camera.focus.conjugate=array"}).camera.focus.conjugate,
      "array");
  // Glasses are looked up afterwards.
  const double index = with({"camera.lens.surfaces[0].glass=N-BK7"}).camera.lens.surfaces[0].index;
  EXPECT_TRUE(test::relative(index, 1.5145, 2e-4));  // Schott's catalogue at 650 nm
}

TEST(SceneSettings, MeanItemsByNumberOrName) {
  EXPECT_EQ(with({"flames[my.candle].scale=3"}).flames[1].scale, 3);
  EXPECT_EQ(with({"flames.paper-layered.scale=4"}).flames[0].scale, 4);
  EXPECT_EQ(with({"channels.red.width=4nm"}).channels[0].width, 4e-9);
  EXPECT_EQ(with({"camera.array.types.type3.index=1.7"}).camera.array.types[2].index, 1.7);
  EXPECT_EQ(with({"flames[0].layers[2].temperature=900K"}).flames[0].layers[2].temperature, 900);
  const Scene scene = with({});
  EXPECT_EQ(resolve_path(scene, "flames.paper-layered.layers[1].name"), "flames[0].layers[1].name");
  EXPECT_EQ(resolve_path(scene, "camera.focus.mode"), "camera.focus.mode");
  EXPECT_EQ(error({"flames.candle.scale=1"}),
            "setting flames.candle.scale: flames is a list, and none of its items is named "
            "\"candle\"; did you mean \"my.candle\"?; by number: flames[0] to flames[1]");
  EXPECT_EQ(error({"flames[2].scale=1"}),
            "setting flames[2].scale: flames has 2 items, counted from 0, so there is no number 2");
  EXPECT_NE(error({"flames[0].name=my.candle", "flames[my.candle].scale=1"}).find("several items"),
            std::string::npos);
  EXPECT_NE(error({"camera.focus[0].mode=best"}).find("is not a list"), std::string::npos);
  EXPECT_NE(error({"flames[0.scale=1"}).find("not in pairs"), std::string::npos);
  EXPECT_NE(error({"flames[99999999999999999999].scale=1"}).find("there is no number"),
            std::string::npos);
  EXPECT_NE(error({"flames=1"}).find("is a list of tables"), std::string::npos);
}

TEST(SceneSettings, SayWhatIsWrong) {
  EXPECT_EQ(error({"camera.focus.object_distnce=1m"}),
            "setting camera.focus.object_distnce: there is no key \"camera.focus.object_distnce\"; "
            "did you mean camera.focus.object_distance?");
  EXPECT_EQ(error({"fill_factor=0.5"}),
            "setting fill_factor: there is no key \"fill_factor\"; did you mean "
            "camera.sensor.fill_factor?");
  EXPECT_NE(error({"flames[0].positon=1m,0m,0m"}).find("did you mean flames[0].position?"),
            std::string::npos);
  EXPECT_EQ(error({"camera.focus.object_distance"}).substr(0, 9), "setting: ");
  EXPECT_EQ(error({"=3"}).substr(0, 9), "setting: ");
  EXPECT_NE(
      error({"camera.array.pitch=1"}).find("setting camera.array.pitch: \"1\" is not a length"),
      std::string::npos);
  EXPECT_NE(error({"camera.array.pitch=2m"}).find("at most 1 m is allowed"), std::string::npos);
  EXPECT_NE(error({"camera.preset=r13"}).find("setting camera.preset: "), std::string::npos);
  // The place that a later message about the value names.
  SceneSettings settings;
  settings.values = {"camera.array.types.type3.index=1.7"};
  const SceneDocument document = parse_scene(kCamera, "a.toml", settings);
  EXPECT_EQ(to_string(document.positions.find("camera.array.types[2].index")),
            "setting camera.array.types.type3.index");
}

TEST(SceneSettings, FNumberSetsTheStop) {
  const std::string thin = "[camera.lens]\nmodel = \"ideal\"\nfocal_length = \"80 mm\"\n";
  EXPECT_TRUE(test::relative(parse_scene(thin + "f_number = 4\n", "").scene.camera.lens.diameter,
                             20e-3, 1e-15));
  EXPECT_TRUE(test::relative(
      parse_scene(thin + "diameter = \"40 mm\"\nf_number = 4\n", "").scene.camera.lens.diameter,
      20e-3, 1e-15));
  EXPECT_NE(message_of([&] {
              parse_scene(thin + "diameter = \"10 mm\"\nf_number = 4\n", "a.toml");
            }).find("a.toml:5:12: camera.lens.f_number: f/4 is wider than the lens, which is f/8"),
            std::string::npos);
  EXPECT_NE(message_of([&] { parse_scene(thin + "f_number = 0\n", "a.toml"); }).find("a.toml:4:12"),
            std::string::npos);
  // The paper's lens of f = 304.0987 mm has its stop of 100 mm behind it, seen 102.8 mm wide.
  const double open = with({}).camera.lens.surfaces[2].diameter;
  const double stopped = with({"camera.lens.f_number=8"}).camera.lens.surfaces[2].diameter;
  EXPECT_TRUE(test::relative(stopped / open, 304.0987 / 102.8 / 8, 1e-3));
  // Another lens has nothing of the file's; what is written is read back with the same bits.
  const std::string text = kCamera + "[camera.lens]\nf_number = 8\n";
  const Scene scene = parse_scene(text, "a.toml").scene;
  EXPECT_EQ(scene.camera.lens.surfaces[2].diameter, stopped);
  EXPECT_EQ(parse_scene(write_scene(scene), "a.toml").scene, scene);
  EXPECT_EQ(with({"camera.lens.preset=objective-50mm"}, text).camera.lens,
            parse_scene("[camera.lens]\npreset = \"objective-50mm\"\n", "").scene.camera.lens);
  // Without a diameter the stop gets it from the f-number.
  const std::string doublet =
      "[[camera.lens.surfaces]]\nradius = \"100 mm\"\nindex = 1.5\nthickness = \"5 mm\"\n"
      "diameter = \"30 mm\"\n[[camera.lens.surfaces]]\nradius = \"-100 mm\"\ndiameter = \"30 "
      "mm\"\n[[camera.lens.surfaces]]\nstop = true\n[camera.lens]\nf_number = 5\n";
  EXPECT_GT(parse_scene(doublet, "").scene.camera.lens.surfaces[2].diameter, 0.015);
}

TEST(SceneSettings, OfSeveralCameras) {
  const std::string thin =
      "[cameras.lens]\nmodel = \"ideal\"\nfocal_length = \"80 mm\"\nf_number = 4\n";
  const std::string text = "[[cameras]]\nname = \"front\"\n" + thin +
                           "[[cameras]]\nname = \"side\"\nlike = \"front\"\n"
                           "[[cameras]]\nname = \"top\"\npreset = \"r12\"\n";
  const Scene scene =
      with({"cameras.side.lens.f_number=8", "cameras[2].focus.object_distance=3m"}, text);
  EXPECT_TRUE(test::relative(scene.cameras[0].lens.diameter, 20e-3, 1e-15));
  EXPECT_TRUE(test::relative(scene.cameras[1].lens.diameter, 10e-3, 1e-15));
  EXPECT_TRUE(test::relative(with({}, text).cameras[1].lens.diameter, 20e-3, 1e-15));  // like front
  EXPECT_EQ(scene.cameras[2].focus.object_distance, 3);
  EXPECT_EQ(scene.cameras[2].lens,
            parse_scene("[camera]\npreset = \"r12\"\n", "").scene.camera.lens);
  EXPECT_EQ(with({"cameras.top.preset=paper-plenoptic2"}, text).cameras[2].sensor,
            with({}).camera.sensor);
  // A path of a single camera would be of none of them.
  EXPECT_EQ(message_of([&] { with({"camera.focus.object_distance=3m"}, text); }),
            "setting camera.focus.object_distance: the scene has several cameras; say which: "
            "cameras.front.focus.object_distance");
  EXPECT_NE(message_of([&] {
              with({"cameras.frint.focus.object_distance=3m"}, text);
            }).find("did you mean \"front\"?"),
            std::string::npos);
}

TEST(SceneSettings, TextInsideOfAnotherFileOpensNone) {
  const auto folder = std::filesystem::temp_directory_path() /
                      ("plenoflame_settings_test_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  std::ofstream(folder / "lens.toml") << "[camera.lens]\nmodel = \"ideal\"\nfocal_length = \"80 "
                                         "mm\"\ndiameter = \"20 mm\"\n";
  const std::string text = "[camera.lens]\nfile = \"lens.toml\"\n";
  const std::string inside = (folder / "a.exr").string();
  EXPECT_EQ(parse_scene(text, (folder / "a.toml").string()).scene.camera.lens.focal_length, 80e-3);
  const std::string message = message_of([&] { parse_embedded_scene(text, inside); });
  EXPECT_NE(message.find("scene of " + inside + ":2:8: "), std::string::npos) << message;
  EXPECT_NE(message.find("opens no file"), std::string::npos);
  // Unless it is asked for, relative to the file that holds the text.
  EXPECT_EQ(parse_embedded_scene("", inside, {.values = {"camera.lens.file=lens.toml"}})
                .scene.camera.lens.focal_length,
            80e-3);
  std::filesystem::remove_all(folder);
}

TEST(ParseScene, FindsTheStringThatIsNotClosed) {
  const auto error_of = [](const std::string& text) {
    return message_of([&] { parse_scene(text, "a.toml"); });
  };
  EXPECT_EQ(error_of("[camera]\npreset = \"r12\n[render]\nsamples = 3\n"),
            "a.toml:2:10: the text that begins here has no closing \"");
  EXPECT_EQ(error_of("a = 'b # c\n"), "a.toml:1:5: the text that begins here has no closing '");
  EXPECT_EQ(error_of("# don't\nb = '''c\nd = 'e'\n"),
            "a.toml:2:5: the text that begins here has no closing '''");
  // Other mistakes are told as before, also where a string is open behind them.
  EXPECT_NE(error_of("a = = 2\nb = \"c\n").find("a.toml:1:5: this is not TOML"), std::string::npos);
}

TEST(WriteScene, EscapesWhatATerminalActsOn) {
  Scene scene;
  scene.flames.resize(1);
  scene.flames[0].name =
      "a\x1b[31m\xc2\x9b"
      "b\xe2\x80\xae"
      "c \"\\u0041\"";
  const std::string text = write_scene(scene);
  EXPECT_NE(text.find("name = \"a\\u001B[31m\\u009bb\\u202ec \\\"\\\\u0041\\\"\""),
            std::string::npos)
      << text;
  EXPECT_EQ(parse_scene(text, "").scene.flames[0].name, scene.flames[0].name);
}

}  // namespace
}  // namespace plenoflame::scene_settings_test
