#include "plenoflame/volumes/flame_file.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "plenoflame/base/error.h"
#include "plenoflame/volumes/grid_writer.h"
#include "plenoflame/volumes/load_medium.h"
#include "plenoflame/volumes/vdb_info.h"
#include "support/approx.h"
#include "volumes/support.h"

namespace plenoflame::flame_file_test {
namespace {

using test::contains;
using test::message_of;
using test::relative;

struct Grid {
  std::string name;
  std::string unit;
  float value = 0;  // of one voxel
  float background = 0;
};

constexpr std::array<int, 3> kVoxel{9, 2, -3};  // holds the value
constexpr std::size_t kValue = (1 * 8 + 2) * 8 + 5;

VoxelField field_of(const Grid& grid) {
  VoxelField field;
  field.name = grid.name;
  field.background = grid.background;
  field.brick_origins = {{8, 0, -8}};
  field.values.assign(512, grid.background);
  field.values[kValue] = grid.value;
  field.index_to_world.linear.rows = {{{1e-3, 0, 0}, {0, 1e-3, 0}, {0, 0, 1e-3}}};
  return field;
}

class FlameFile : public ::testing::Test {
 protected:
  /// Writes the grids and reads them as a flame.
  FlameFields read(const std::vector<Grid>& grids, const FlameSpec& spec = {}) {
    std::vector<VoxelField> fields;
    for (const Grid& grid : grids) fields.push_back(field_of(grid));
    std::vector<GridOutput> outputs;
    for (std::size_t i = 0; i < grids.size(); ++i) outputs.push_back({&fields[i], grids[i].unit});
    write_grids(path(), outputs);
    FlameSpec vdb = spec;
    vdb.kind = FlameKind::vdb;
    vdb.file = "flame.vdb";
    warnings_.clear();
    Execution execution;
    execution.message = [&](Severity severity, const std::string& text) {
      if (severity == Severity::warning) warnings_.push_back(text);
    };
    return read_flame(vdb, folder_.path(), execution);
  }
  std::string refused(const std::vector<Grid>& grids, const FlameSpec& spec = {}) {
    const std::string message = message_of<InputError>([&] { read(grids, spec); });
    EXPECT_EQ(message.rfind(path() + ": ", 0), 0u) << message;
    return message;
  }
  static double value(const VoxelField& field) {
    return static_cast<double>(test::FieldSampler(field).at(kVoxel[0], kVoxel[1], kVoxel[2]));
  }
  std::string path() const { return folder_.file("flame.vdb"); }

  test::TemporaryFolder folder_;
  std::vector<std::string> warnings_;
};

TEST_F(FlameFile, SiWithoutAnyMapping) {
  const FlameFields flame =
      read({{"velocity", "", 3}, {"temperature", "", 1500, 300}, {"absorption", "", 30}});
  EXPECT_EQ(value(flame.temperature), 1500);
  EXPECT_EQ(flame.temperature.background, 300);
  EXPECT_EQ(value(flame.absorption), 30);
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(FlameFile, GridsForScripts) {
  read({{"T", "K", 1500, 300}, {"kappa", "1/cm", 1}, {"resolved", "", 1}});
  std::vector<VoxelField> fields = read_flame_grids(path(), {});
  ASSERT_EQ(fields.size(), 2u);
  EXPECT_EQ(fields[0].name, "temperature");
  EXPECT_EQ(value(fields[1]), 100);
  // A reconstruction of emission alone is no flame, but voxels all the same.
  const VoxelField emission = field_of({"emission", "W/(m^3 sr)", 7}),
                   resolved = field_of({"resolved", "", 0.5f});
  write_grids(path(), std::array{GridOutput{&emission, "W/(m^3 sr)"}, GridOutput{&resolved, ""}});
  fields = read_flame_grids(path(), {});
  ASSERT_EQ(fields.size(), 2u);
  EXPECT_EQ(fields[0].name, "emission");
  EXPECT_EQ(value(fields[0]), 7);
  EXPECT_EQ(value(fields[1]), 0.5);
  // With one of the two it is a flame that lacks the other.
  const VoxelField hot = field_of({"temperature", "K", 1500});
  write_grids(path(), std::array{GridOutput{&hot, "K"}});
  EXPECT_TRUE(
      contains(message_of<InputError>([&] { read_flame_grids(path(), {}); }), "absorption"));
}

TEST_F(FlameFile, NamesThatOtherProgramsUse) {
  for (const char* name :
       {"temperature", "Temperature", "TEMPERATURE", "heat", "temp", "T", "temperaturegrid"})
    for (const char* kappa :
         {"absorption", "absorption_coefficient", "kappa", "sigma_a", "Kappa"}) {
      const FlameFields flame = read({{name, "K", 1500}, {kappa, "1/m", 30}});
      EXPECT_EQ(flame.temperature.name, name);
      EXPECT_EQ(flame.absorption.name, kappa);
    }
  // The more telling name wins, wherever it stands in the file.
  EXPECT_EQ(read({{"heat", "", 2}, {"temperature", "", 1500}, {"kappa", "", 1}}).temperature.name,
            "temperature");
}

TEST_F(FlameFile, UnitsOfTheFileAndOfTheScene) {
  struct Case {
    const char* unit;
    float stored;
    double expected;
  };
  for (const Case& c : {Case{"K", 1500, 1500}, Case{"kelvin", 1500, 1500},
                        Case{"degC", 1226.85f, 1500}, Case{"Celsius", 1226.85f, 1500},
                        Case{"\xc2\xb0"
                             "C",
                             1226.85f, 1500}}) {
    EXPECT_TRUE(relative(
        value(read({{"temperature", c.unit, c.stored}, {"absorption", "", 1}}).temperature),
        c.expected, 1e-7))
        << c.unit;
    FlameSpec spec;
    spec.temperature.unit = c.unit;  // wins over what the file says
    EXPECT_TRUE(relative(
        value(
            read({{"temperature", "nonsense", c.stored}, {"absorption", "", 1}}, spec).temperature),
        c.expected, 1e-7))
        << c.unit;
  }
  for (const Case& c : {Case{"1/m", 30, 30}, Case{"1/cm", 0.3f, 30}, Case{"1/mm", 0.03f, 30},
                        Case{"m^-1", 30, 30}, Case{"cm^-1", 0.3f, 30}, Case{"mm^-1", 0.03f, 30}})
    EXPECT_TRUE(relative(
        value(read({{"temperature", "", 1500}, {"absorption", c.unit, c.stored}}).absorption),
        c.expected, 1e-7))
        << c.unit;
  EXPECT_EQ(read({{"temperature", "degC", 1500, 20}, {"absorption", "", 1}}).temperature.background,
            293.15f);
}

TEST_F(FlameFile, ScaleThenOffsetThenUnit) {
  FlameSpec spec;
  spec.temperature = {"heat", "degC", 1000, 20};
  spec.absorption = {"density", "1/cm", 0.5, 0};
  const FlameFields flame = read({{"heat", "", 1.5f}, {"density", "", 4}}, spec);
  EXPECT_TRUE(relative(value(flame.temperature), 1.5 * 1000 + 20 + 273.15, 1e-7));
  EXPECT_EQ(value(flame.absorption), 200);
}

TEST_F(FlameFile, MissingGrids) {
  const std::string temperature = refused({{"density", "", 1}, {"flame", "", 1}});
  EXPECT_TRUE(contains(temperature, "has no temperature grid"));
  EXPECT_TRUE(contains(temperature, "\"density\" (float), \"flame\" (float)"));
  const std::string absorption = refused({{"density", "", 1}, {"temperature", "", 1500}});
  EXPECT_TRUE(contains(absorption, "has no absorption grid"));
  EXPECT_TRUE(contains(absorption, "absorption.grid = \"density\""));
  FlameSpec spec;
  spec.absorption.grid = "soot";
  EXPECT_TRUE(
      contains(refused({{"temperature", "", 1500}, {"density", "", 1}}, spec),
               "has no grid \"soot\"; it holds: \"temperature\" (float), \"density\" (float)"));
}

TEST_F(FlameFile, ValuesThatCannotBe) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(
      contains(refused({{"temperature", "", nan}, {"absorption", "", 1}}),
               "grid \"temperature\": voxel (9, 2, -3) is nan K; it must be a finite number"));
  EXPECT_TRUE(
      contains(refused({{"temperature", "", infinity}, {"absorption", "", 1}}), "is inf K"));
  EXPECT_TRUE(contains(refused({{"temperature", "", -1}, {"absorption", "", 1}}),
                       "voxel (9, 2, -3) is -1 K; it must be at least 0"));
  EXPECT_TRUE(
      contains(refused({{"temperature", "degC", -300}, {"absorption", "", 1}}), "is -26.85 K"));
  EXPECT_TRUE(contains(refused({{"temperature", "", 1500}, {"kappa", "", -2}}),
                       "grid \"kappa\": voxel (9, 2, -3) is -2 1/m"));
  EXPECT_TRUE(
      contains(refused({{"temperature", "", 1500}, {"absorption", "", nan}}), "is nan 1/m"));
  EXPECT_TRUE(contains(refused({{"temperature", "", 1500, -5}, {"absorption", "", 1}}),
                       "the background is -5 K"));
  EXPECT_TRUE(contains(refused({{"temperature", "", 1500}, {"absorption", "", 1, 0.5f}}),
                       "grid \"absorption\" has the background 0.5 1/m; it must be 0"));
  FlameSpec spec;
  spec.absorption.offset = 0.25;
  EXPECT_TRUE(contains(refused({{"temperature", "", 1500}, {"absorption", "", 1}}, spec),
                       "has the background 0.25 1/m"));
}

TEST_F(FlameFile, MappingsThatCannotBe) {
  FlameSpec spec;
  spec.temperature.unit = "F";
  EXPECT_TRUE(contains(refused({{"temperature", "", 1500}, {"absorption", "", 1}}, spec),
                       "temperature.unit \"F\" is not known; use K or degC"));
  EXPECT_TRUE(contains(refused({{"temperature", "", 1500}, {"absorption", "km", 1}}),
                       "grid \"absorption\" states the unit \"km\""));
  spec = {};
  spec.absorption.scale = 0;
  EXPECT_TRUE(contains(refused({{"temperature", "", 1500}, {"absorption", "", 1}}, spec),
                       "absorption.scale"));
  spec.absorption.scale = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(contains(refused({{"temperature", "", 1500}, {"absorption", "", 1}}, spec),
                       "absorption.scale"));
}

TEST_F(FlameFile, WarnsOfNormalisedTemperaturesAndEmptyFlames) {
  read({{"temperature", "", 20}, {"absorption", "", 1}});
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_TRUE(contains(warnings_[0], "grid \"temperature\" is 20 K at most"));
  EXPECT_TRUE(contains(warnings_[0], "temperature.scale"));
  read({{"temperature", "", 199}, {"absorption", "", 1}});
  EXPECT_EQ(warnings_.size(), 1u);
  read({{"temperature", "", 200}, {"absorption", "", 1}});
  EXPECT_EQ(warnings_.size(), 0u);
  read({{"temperature", "", 1500}, {"absorption", "", 0}});
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_TRUE(contains(warnings_[0], "0 everywhere"));
}

TEST_F(FlameFile, InfoTellsWhatASceneWouldNeed) {
  read({{"temperature", "K", 20}, {"kappa", "", 1}});
  const VdbInfo info = vdb_info(path());
  EXPECT_EQ(info.temperature_grid, "temperature");
  EXPECT_EQ(info.absorption_grid, "kappa");
  ASSERT_EQ(info.remarks.size(), 2u);
  EXPECT_TRUE(contains(info.remarks[0], "is 20 at most"));
  EXPECT_TRUE(contains(info.remarks[1], "grid \"kappa\" states no unit; it is taken to be in 1/m"));
}

FlameSpec with_line(const LineSpec& line) {
  FlameSpec spec;
  spec.lines = {line};
  return spec;
}

TEST_F(FlameFile, EmissionLines) {
  const std::vector<Grid> grids{
      {"temperature", "", 1500, 300}, {"absorption", "", 30}, {"ch*", "W/cm^3", 2}};
  EXPECT_TRUE(read(grids).lines.empty());
  FlameFields flame = read(grids, with_line({LineKind::ch}));
  ASSERT_EQ(flame.lines.size(), 1u);
  EXPECT_EQ(value(flame.lines[0]), 2e6);
  // Mapped: 0.5 * 2 + 0 in W/(m^3 sr).
  flame = read(grids, with_line({LineKind::custom, 500e-9, 0, {"ch*", "W/(m^3 sr)", 0.5, 0}}));
  EXPECT_TRUE(relative(value(flame.lines[0]), 12.566370614359172, 1e-6));
  // Photons of the line's own wavelength: hc / lambda each.
  flame = read(grids, with_line({LineKind::custom, 400e-9, 0, {"ch*", "1/(m^3 s)", 1e19, 0}}));
  EXPECT_TRUE(relative(value(flame.lines[0]), 2e19 * 1.98644586e-25 / 400e-9, 1e-6));

  const auto without_unit =
      refused({{"absorption", "", 30}, {"C2", "", 1}}, with_line({LineKind::c2_474}));
  EXPECT_TRUE(contains(without_unit, "grid \"C2\" states no unit; set lines[0].unit"));
  EXPECT_TRUE(contains(refused({{"CH", "1/m", 1}}, with_line({LineKind::ch})),
                       "states the unit \"1/m\", which is not one of emission"));
  EXPECT_TRUE(contains(refused({{"CH", "W/m^3", -2}}, with_line({LineKind::ch})),
                       "voxel (9, 2, -3) is -2 W/m^3; it must be at least 0"));
  EXPECT_TRUE(contains(refused({{"CH", "W/m^3", std::numeric_limits<float>::quiet_NaN()}},
                               with_line({LineKind::ch})),
                       "must be a finite number"));
  EXPECT_TRUE(contains(refused({{"CH", "W/m^3", 2, 1}}, with_line({LineKind::ch})),
                       "all of space would glow"));
  EXPECT_TRUE(contains(refused({{"absorption", "", 30}}, with_line({LineKind::oh})),
                       "has no grid for lines[0]; it holds: \"absorption\""));
}

// Gas that only glows has no other grid, and there is nothing to say about that.
TEST_F(FlameFile, EmissionLinesAlone) {
  const FlameFields flame = read({{"CH*", "W/m^3", 2}}, with_line({LineKind::ch}));
  EXPECT_TRUE(flame.absorption.brick_origins.empty());
  EXPECT_EQ(value(flame.lines[0]), 2);
  EXPECT_TRUE(warnings_.empty());
  // Nor about lines that nobody asked for, or a grid of any name that is one.
  read({{"CH*", "W/m^3", 2}, {"C2*", "W/m^3", 2}, {"OH*", "", 2}, {"Na", "", 2}},
       with_line({LineKind::ch}));
  EXPECT_TRUE(warnings_.empty());
  read({{"density", "W/m^3", 2}},
       with_line({LineKind::custom, 500e-9, 0, {"density", "W/m^3", 1, 0}}));
  EXPECT_TRUE(warnings_.empty());
}

// Absorption under a name of another program's must not be left out without a word.
TEST_F(FlameFile, SaysWhatAClearFlameDoesNotUse) {
  const auto warned = [&](const std::vector<Grid>& grids) {
    const FlameFields flame = read(grids, with_line({LineKind::ch}));
    EXPECT_TRUE(flame.absorption.brick_origins.empty());
    EXPECT_EQ(warnings_.size(), 1u);
    return warnings_.empty() ? "" : warnings_.front();
  };
  const std::string density = warned({{"CH*", "W/m^3", 2}, {"density", "", 1}, {"C2*", "", 1}});
  EXPECT_TRUE(contains(density, "not used: \"density\" (float); name the absorption"));
  EXPECT_TRUE(contains(warned({{"CH*", "W/m^3", 2}, {"temperature", "K", 1500}}),
                       "not used: \"temperature\" (float);"));
}

// Whoever asks for something that needs absorption gets no clear flame.
TEST_F(FlameFile, EmissionLinesWithoutTheAbsorptionThatIsAskedFor) {
  const std::vector<Grid> grids{{"CH*", "W/m^3", 2}, {"temperature", "", 1500}};
  FlameSpec named = with_line({LineKind::ch});
  named.absorption.grid = "kappa";
  EXPECT_TRUE(contains(refused(grids, named), "has no grid \"kappa\""));
  const std::function<void(FlameSpec&)> asking[] = {
      [](FlameSpec& spec) { spec.absorption.scale = 35; },
      [](FlameSpec& spec) { spec.temperature.grid = "temperature"; },
      [](FlameSpec& spec) { spec.temperature.unit = "degC"; },
      [](FlameSpec& spec) { spec.scattering.albedo = 0.5; },
      [](FlameSpec& spec) { spec.scattering.grid = "CH*"; }};
  for (const auto& ask : asking) {
    FlameSpec spec = with_line({LineKind::ch});
    ask(spec);
    EXPECT_TRUE(contains(refused(grids, spec), "has no absorption grid")) << &ask - asking;
  }
  // Without lines nothing would shine.
  EXPECT_TRUE(contains(refused(grids), "has no absorption grid"));
  const std::string no_temperature =
      refused({{"CH*", "W/m^3", 2}, {"absorption", "", 30}}, with_line({LineKind::ch}));
  EXPECT_TRUE(contains(no_temperature, "has no temperature grid"));
}

// Into all directions in the file, into each in the medium, in a channel's share.
TEST_F(FlameFile, EmissionOfTheMedium) {
  FlameSpec spec = with_line({LineKind::ch});
  spec.kind = FlameKind::vdb;
  spec.file = path();
  static_cast<void>(message_of<InputError>([&] { read({{"CH*", "W/m^3", 2}}); }));
  const EmissionLine ch = EmissionLine::named("ch");
  const auto medium = load_flame(spec, "/nowhere",
                                 {SourceFunction::band(431e-9, 10e-9).with_lines({{ch, 0.25}}),
                                  SourceFunction::band(650e-9, 10e-9)},
                                 {});
  double emission[2] = {-1, -1};
  EXPECT_EQ(medium->coefficients({9e-3, 2e-3, -3e-3}, emission), 0);
  EXPECT_TRUE(relative(emission[0], 0.25 * 2 / (4 * std::acos(-1.0)), 1e-5));
  EXPECT_EQ(emission[1], 0);
}

TEST_F(FlameFile, IsLoadedByTheLibraryUnasked) {
  read({{"temperature", "K", 1500, 300}, {"absorption", "1/m", 5, 0}});
  const SceneDocument document = parse_scene(
      "[camera]\npreset = \"paper-plenoptic2\"\n[camera.sensor]\ncolumns = 20\nrows = 20\n"
      "[[flames]]\nkind = \"vdb\"\nfile = \"flame.vdb\"\nposition = [\"1 m\", \"0 m\", \"0 m\"]\n",
      folder_.file("scene.toml"));
  EXPECT_TRUE(compile_scene(document).medium);
  EXPECT_THROW(compile(document), InputError);
}

TEST_F(FlameFile, Albedos) {
  FlameSpec spec;
  spec.scattering.grid = "omega";
  const auto grids = [](float albedo, float background = 0) {
    return std::vector<Grid>{
        {"temperature", "", 1500, 300}, {"absorption", "", 30}, {"omega", "", albedo, background}};
  };
  EXPECT_TRUE(relative(value(*read(grids(0.25f), spec).albedo), 0.25, 1e-7));
  EXPECT_FALSE(read(grids(0.25f)).albedo.has_value());
  EXPECT_TRUE(contains(refused(grids(1), spec), "voxel (9, 2, -3) is an albedo of 1"));
  EXPECT_TRUE(contains(refused(grids(30), spec), "is the grid in percent?"));
  EXPECT_TRUE(contains(refused(grids(-0.5f), spec), "must be at least 0 and below 1"));
  EXPECT_TRUE(contains(refused(grids(std::nanf("")), spec), "is an albedo of nan"));
  EXPECT_TRUE(contains(refused(grids(0.5f, 1), spec), "the background is an albedo of 1"));
  spec.scattering.grid = "none";
  EXPECT_TRUE(contains(message_of<InputError>([&] { read(grids(0.5f), spec); }), "none"));
}

TEST_F(FlameFile, PlacedByPositionAndRotation) {
  FlameSpec spec;
  spec.position = {1, 2, 3};
  spec.rotation = {0, 0, std::acos(-1.0) / 2};  // x to y
  spec.kind = FlameKind::vdb;
  spec.file = path();  // absolute: the scene's folder does not matter
  read({{"temperature", "K", 1500}, {"absorption", "1/m", 30}});
  const auto medium = load_flame(spec, "/nowhere", {SourceFunction::total()}, {});
  // Sample (9, 2, -3) mm of the flame is at (-2, 9, -3) mm from its position.
  const MediumSample there = medium->sample({1 - 2e-3, 2 + 9e-3, 3 - 3e-3});
  EXPECT_TRUE(relative(there.temperature, 1500, 1e-5));
  EXPECT_TRUE(relative(there.absorption, 30, 1e-5));
  EXPECT_EQ(medium->sample({9e-3, 2e-3, -3e-3}).absorption, 0);
  // Half as large, its lengths shrink before it is turned and moved; its absorption stays.
  spec.scale = 0.5;
  const auto half = load_flame(spec, "/nowhere", {SourceFunction::total()}, {});
  const MediumSample here = half->sample({1 - 1e-3, 2 + 4.5e-3, 3 - 1.5e-3});
  EXPECT_TRUE(relative(here.temperature, 1500, 1e-5));
  EXPECT_TRUE(relative(here.absorption, 30, 1e-5));
  EXPECT_TRUE(relative(half->feature_size(), 0.5e-3, 1e-6));
  spec.scale = 0;
  EXPECT_TRUE(contains(
      message_of<InputError>([&] { load_flame(spec, "/nowhere", {SourceFunction::total()}, {}); }),
      "not a positive number"));
}

}  // namespace
}  // namespace plenoflame::flame_file_test
