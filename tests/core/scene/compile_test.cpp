#include "plenoflame/scene/compile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/media/layered_medium.h"
#include "plenoflame/scene/channel_kinds.h"
#include "scene_samples.h"
#include "support/approx.h"
#include "support/uniform_medium.h"

namespace plenoflame::compile_test {
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

/// The message that compile() throws, or the warnings that it gives, one per line.
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

// Every kind has its row: a kind without one would pass for the first. The response y at 650 nm by
// the formula of Wyman, Sloan and Shirley (JCGT 2, 2013, 1), with a pocket calculator.
TEST(ChannelKinds, SayWhatTheyAre) {
  const struct {
    ChannelKind kind;
    double own;  ///< [nm]
    const char* described;
    double at_650;  ///< response
  } cases[] = {
      {ChannelKind::total, 0, "all wavelengths", -1},
      {ChannelKind::band, 650, "10 nm around 650 nm", 1},
      {ChannelKind::line, 650, "10 nm wide line at 650 nm", 1},
      {ChannelKind::curve, 0, "curve, counting photons", 0.5},
      {ChannelKind::named, 0, "response cie_y, counting photons", 0.110204},
  };
  for (const auto& c : cases) {
    ChannelSpec channel;
    channel.kind = c.kind;
    channel.wavelength = 650e-9;
    channel.width = 10e-9;
    channel.response = "cie_y";
    channel.curve = "600 nm 0, 700 nm 1";
    channel.photons = c.kind == ChannelKind::curve || c.kind == ChannelKind::named;
    EXPECT_EQ(own_wavelength(channel), c.own > 0 ? 650e-9 : 0) << c.described;
    EXPECT_EQ(describe_channel(channel), c.described);
    const auto response = response_of_kind(channel);
    ASSERT_EQ(response.has_value(), c.at_650 >= 0) << c.described;
    if (response) {
      EXPECT_TRUE(test::relative((*response)(650e-9), c.at_650, 1e-4)) << c.described;
    }
  }
}

TEST(Compile, KeepsToItselfWhatTheCallerKnows) {
  const SceneDocument document = parse_scene("[camera]\npreset = \"paper-plenoptic2\"\n", "s.toml");
  const auto warnings = [&](const std::vector<IssueCode>& unsaid) {
    int count = 0;
    Execution execution;
    execution.message = [&](Severity, const std::string&) { ++count; };
    compile(document.scene, load_core_medium, execution, document.positions, {}, unsaid);
    return count;
  };
  EXPECT_EQ(warnings({}), 1);
  EXPECT_EQ(warnings({IssueCode::other}), 1);
  EXPECT_EQ(warnings({IssueCode::no_flame}), 0);
}

TEST(Compile, LightThatPassesWindowsStraightHasACode) {
  const std::string plate = R"([camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
[[windows]]
shape = "plate"
position = ["0.4 m", "0 m", "0 m"]
rotation = ["0 deg", "90 deg", "0 deg"]
diameter = "80 mm"
thickness = "6 mm"
index = 1.46
)";
  const auto straight = [](const std::string& text) {
    int count = 0;
    for (const SceneIssue& issue : validate(parse_scene(text, "s.toml")))
      count += issue.code == IssueCode::straight_light && !issue.is_error;
    return count;
  };
  const auto ball = [](double reflectivity) {
    return "[[surfaces]]\nshape = \"sphere\"\nposition = [\"1.2 m\", \"0 m\", \"0 m\"]\n"
           "radius = \"10 mm\"\n[surfaces.material]\nkind = \"lambertian\"\nreflectivity = " +
           std::to_string(reflectivity) + "\n";
  };
  EXPECT_EQ(straight(plate), 0);
  EXPECT_EQ(straight(plate + ball(0.5)), 1);
  EXPECT_EQ(straight(plate + ball(0)), 0);
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

TEST(Compile, SaysWhereScatteredLightIsNoisierThanItsError) {
  const auto warnings = [](const std::string& channels, const std::string& lights) {
    std::string text =
        "[flames.scattering]\nalbedo = 0.5\n[flames.spectrum]\nkind = \"soot\"\n" + lights;
    for (std::size_t i = 0; i < channels.size(); i += 4)
      text += "[[channels]]\nname = \"" + channels.substr(i, 4) +
              "\"\nkind = \"band\"\nwavelength = \"" + channels.substr(i, 4) +
              " nm\"\nwidth = \"10 nm\"\n";
    return outcome(grid_scene(text), in_box({{0.9, -0.1, -0.1}, {1.1, 0.1, 0.1}}));
  };
  EXPECT_EQ(warnings("07000400", ""), "");
  EXPECT_EQ(warnings("04500800", ""), "");
  EXPECT_EQ(warnings("04000900", ""), "");
  const auto lamp = [](const std::string& x, const std::string& y, const std::string& z) {
    return "[[lights]]\nkind = \"point\"\npower = \"1 W\"\nposition = [\"" + x + "\", \"" + y +
           "\", \"" + z + "\"]\n";
  };
  for (const std::string& outside :
       {lamp("1.2 m", "0 m", "0 m"), lamp("0.8 m", "0 m", "0 m"), lamp("1 m", "0.2 m", "0 m"),
        lamp("1 m", "-0.2 m", "0 m"), lamp("1 m", "0 m", "0.2 m"), lamp("1 m", "0 m", "-0.2 m")})
    EXPECT_EQ(warnings("0700", outside), "");
  const std::string within = lamp("1.05 m", "-0.05 m", "0.02 m");
  EXPECT_NE(warnings("0700", within).find("lights[0] is a point light within a scattering flame"),
            std::string::npos);
  // Light from far away has no place in it, and without scattering a lamp makes no specks.
  EXPECT_EQ(warnings("0700",
                     "[[lights]]\nkind = \"environment\"\n"
                     "radiance = \"1 W/(m^2 sr)\"\nposition = [\"1 m\", \"0 m\", \"0 m\"]\n"),
            "");
  EXPECT_EQ(outcome(grid_scene(within), in_box({{0.9, -0.1, -0.1}, {1.1, 0.1, 0.1}})), "");
}

TEST(Compile, SaysWhereScatteringTakesShortSteps) {
  // A ball of 0.2 m in a box of 0.3464 m from corner to corner: 55 000 1/m make 10 000 steps of it,
  // for the ball fills pi / 6 of the box; a little more of the cells that steps go by.
  const auto warnings = [](double absorption, const std::string& scattering) {
    return outcome(
        grid_scene(scattering + "[[channels]]\nname = \"a\"\nkind = \"total\"\n"),
        [&](const FlameSpec&, const std::string&, const std::vector<SourceFunction>& channels,
            const Execution&) -> std::unique_ptr<Medium> {
          return make_layered_medium(
              {{{1, 0, 0}, {0.001, 0.001, 0.001}, 1500, 2e5},  // so small that it costs nothing
               {{1, 0, 0}, {0.1, 0.1, 0.1}, 1500, absorption}},
              {}, channels);
        });
  };
  const std::string scattering = "[flames.scattering]\nalbedo = 0.5\n";
  EXPECT_EQ(warnings(40000, scattering), "");
  EXPECT_NE(warnings(58000, scattering)
                .find("up to 2e+05 1/m within bounds of 346.4 mm: light takes about 1."),
            std::string::npos);
  EXPECT_EQ(warnings(58000, ""), "");
}

// Light whose spectrum nobody gave loses what white light loses: three quarters of this band.
TEST(Compile, AFilterDimsLampsAndSurroundings) {
  const auto light = [](const std::string& filter) {
    const SceneDocument document = grid_scene(
        filter +
        "[[channels]]\nname = \"a\"\nkind = \"band\"\nwavelength = \"650 nm\"\nwidth = \"40 nm\"\n"
        "[[lights]]\nkind = \"environment\"\nradiance = \"300 W/(m^2 sr)\"\n"
        "[[lights]]\nkind = \"point\"\npower = \"1 W\"\nposition = [\"1 m\", \"1 m\", \"1 m\"]\n");
    const Lights lights =
        compile(document.scene, in_box({{0.9, -0.1, -0.1}, {1.1, 0.1, 0.1}})).lights;
    return std::pair(lights.environment.at(0), lights.delta.at(0).strength.at(0));
  };
  const auto open = light("");
  const auto dim = light("[camera.transmission]\nfilter = \"640 nm 0, 660 nm 0.5, 700 nm 0.5\"\n");
  // 0 to 0.5 over 20 nm, then 0.5 over 10 nm, of 40 nm.
  EXPECT_TRUE(test::relative(dim.first / open.first, 0.25, 1e-9));
  EXPECT_TRUE(test::relative(dim.second / open.second, 0.25, 1e-9));
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

// Wide channels through flames of different spectra, one behind the other: the wavelengths that
// stand for a channel must do for all of them. Against a sum over two thousand wavelengths. Fails
// when they are chosen for the first flame alone, or take its spectrum for the other.
TEST(Compile, NodesOfFlamesWithDifferentSpectra) {
  Scene scene = grid_scene().scene;
  scene.channels = {{"red", ChannelKind::band, 650e-9, 160e-9},
                    {"green", ChannelKind::band, 530e-9, 140e-9}};
  const auto flame = [](double x, double temperature, double absorption) {
    FlameSpec made;
    made.position = {x, 0, 0};
    made.layers = {{"", {}, {0.01, 0.01, 0.01}, temperature, absorption}};
    return made;
  };
  FlameSpec near = flame(1, 1500, 30), far = flame(1.1, 2100, 120);
  near.spectrum = {SpectrumKind::power, 650e-9, 3};
  far.spectrum.kind = SpectrumKind::table;
  far.spectrum.table = "450 nm 0.4, 600 nm 1, 620 nm 2.5, 740 nm 1";
  scene.flames = {near, far};
  const CompiledScene compiled = compile(scene);
  ASSERT_GT(compiled.node_count(), 4);
  EXPECT_LT(compiled.spectral_error, 5e-4);

  const std::vector<double> nodes =
      integrate_reference(*compiled.medium, {{0, 0, 0}, {1, 0, 0}}, 0, 10);
  const auto planck = [](double w, double t) {
    return 1.1910429723971884e-16 / std::pow(w, 5) / std::expm1(0.014387768775039337 / (w * t));
  };
  const auto table = [](double nm) {
    return nm < 600   ? 0.4 + 0.6 * (nm - 450) / 150
           : nm < 620 ? 1 + 1.5 * (nm - 600) / 20
                      : 2.5 - 1.5 * (nm - 620) / 120;
  };
  for (int c = 0; c < 2; ++c) {
    const ChannelSpec& channel = scene.channels[static_cast<std::size_t>(c)];
    double expected = 0, seen = 0;
    constexpr int kSteps = 2000;
    for (int i = 0; i < kSteps; ++i) {
      const double w = channel.wavelength + ((i + 0.5) / kSteps - 0.5) * channel.width;
      const double front = 30 * 0.02 * std::pow(650e-9 / w, 3);
      const double back = 120 * 0.02 * table(1e9 * w) / table(650);
      expected += channel.width / kSteps *
                  (planck(w, 1500) * -std::expm1(-front) +
                   std::exp(-front) * planck(w, 2100) * -std::expm1(-back));
    }
    for (int n = 0; n < compiled.node_count(); ++n)
      seen += compiled.mix.weight(c, n) * nodes[static_cast<std::size_t>(n)];
    EXPECT_TRUE(test::relative(seen, expected, 1e-3)) << c;
  }
}

// Wide channels share wavelengths where flames are all there is; each has its own where something
// else sends light into channels as a whole.
TEST(Compile, ChannelsShareWavelengthsAmongFlamesOnly) {
  Scene scene = grid_scene().scene;
  FlameSpec flame;
  flame.position = {1, 0, 0};
  flame.layers = {{"", {}, {0.01, 0.01, 0.01}, 1700, 50}};
  flame.spectrum.kind = SpectrumKind::soot;
  scene.flames = {flame};
  scene.channels.clear();
  for (const char* name : {"nikon_d5100_red", "nikon_d5100_green", "nikon_d5100_blue"})
    scene.channels.push_back({name, ChannelKind::named, 0, 0, name});
  const auto most_channels_of_a_node = [](const CompiledScene& compiled) {
    int most = 0;
    for (int n = 0; n < compiled.mix.nodes(); ++n) {
      int channels = 0;
      for (int c = 0; c < 3; ++c) channels += compiled.mix.weight(c, n) > 0 ? 1 : 0;
      most = std::max(most, channels);
    }
    return most;
  };
  const CompiledScene alone = compile(scene);
  EXPECT_EQ(most_channels_of_a_node(alone), 3);
  LightSpec lamp;
  lamp.kind = LightKind::point;
  lamp.position = {1, 0.5, 0};
  lamp.power = 1;
  scene.lights = {lamp};
  const CompiledScene lit = compile(scene);
  EXPECT_EQ(most_channels_of_a_node(lit), 1);
  EXPECT_GT(lit.node_count(), alone.node_count());
}

}  // namespace
}  // namespace plenoflame::compile_test
