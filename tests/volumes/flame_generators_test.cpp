#include "plenoflame/volumes/flame_generators.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "plenoflame/base/error.h"
#include "plenoflame/volumes/flame_library.h"

namespace plenoflame::flame_generators_test {
namespace {

std::string message(const auto& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FlameGenerators, ValuesReachTheFlame) {
  SootFlameOptions options = candle_flame();
  options.voxel_size = 2e-3;
  options.height = 20e-3;
  options.absorption_function = 0.4;
  options.lines = {{"na_d", 2e3}};
  const FlameFields expected = make_soot_flame(options, {});
  const FlameFields flame = generate_flame("candle",
                                           {{"voxel_size", "2 mm"},
                                            {"height", "20 mm"},
                                            {"soot_function", "0.4"},
                                            {"lines", "na_d=2 kW/m^3"}},
                                           {});
  EXPECT_EQ(flame.temperature.values, expected.temperature.values);
  EXPECT_EQ(flame.absorption.values, expected.absorption.values);
  ASSERT_EQ(flame.lines.size(), 1U);
  EXPECT_EQ(flame.lines[0].values, expected.lines[0].values);
  const FlameFields other = generate_flame("candle", {{"voxel_size", "2 mm"}}, {});
  EXPECT_NE(flame.temperature.values, other.temperature.values);
}

/// The values that the table prints as defaults are the defaults.
TEST(FlameGenerators, DefaultsMakeTheDefaultFlame) {
  for (const FlameGenerator& generator : flame_generators()) {
    SCOPED_TRACE(generator.name);
    const std::string coarse = generator.name == "cylinder" ? "20 mm" : "4 mm";
    FlameValues all;
    std::set<std::string> names;
    for (const FlameParameter& p : generator.parameters()) {
      EXPECT_TRUE(names.insert(p.name).second) << p.name;
      EXPECT_FALSE(p.about.empty());
      if (p.value.empty()) continue;
      check_flame_value(generator, p.name, p.value);
      all[p.name] = p.value;
    }
    all["voxel_size"] = coarse;
    EXPECT_EQ(generate_flame(generator.name, all, {}).absorption.values,
              generate_flame(generator.name, {{"voxel_size", coarse}}, {}).absorption.values);
  }
}

TEST(FlameGenerators, EachParameterCounts) {
  for (const FlameGenerator& generator : flame_generators()) {
    const std::string coarse = generator.name == "cylinder" ? "20 mm" : "3 mm";
    const FlameFields usual = generate_flame(generator.name, {{"voxel_size", coarse}}, {});
    for (const FlameParameter& p : generator.parameters()) {
      if (p.value.empty() || p.name == "voxel_size") continue;
      SCOPED_TRACE(std::string(generator.name) + "." + p.name);
      FlameValues values{{"voxel_size", coarse}};
      values[p.name] =
          p.type == FlameParameterType::whole_number
              ? "7"
              : format_quantity(0.5 * parse_quantity(p.value, p.dimension), p.dimension);
      const FlameFields flame = generate_flame(generator.name, values, {});
      EXPECT_TRUE(flame.temperature.values != usual.temperature.values ||
                  flame.absorption.values != usual.absorption.values);
    }
  }
}

TEST(FlameGenerators, WrongValuesAreNamed) {
  const auto made = [](const char* flame, const FlameValues& values) {
    return message([&] { generate_flame(flame, values, {}); });
  };
  EXPECT_EQ(made("match", {}),
            "there is no flame 'match'; there are layered, candle, diffusion, cylinder, turbulent");
  EXPECT_EQ(made("cylinder", {{"seed", "3"}}),
            "the flame 'cylinder' has no parameter 'seed'; it has voxel_size, radius, height, "
            "absorption, temperature_swing");
  EXPECT_EQ(made("cylinder", {{"height", "0 mm"}}),
            "height: \"0 mm\" must be above 0 and below 1 km");
  EXPECT_NE(made("cylinder", {{"height", "3"}}).find("height: "), std::string::npos);
  EXPECT_NE(made("candle", {{"soot_function", "2"}}).find("at most 1"), std::string::npos);
  EXPECT_NE(made("candle", {{"lines", "ch, ch"}}).find("lines: ch is given twice"),
            std::string::npos);
  EXPECT_NE(made("turbulent", {{"seed", "-1"}}).find("seed: a whole number"), std::string::npos);
  const FlameGenerator& candle = flame_generator("candle");
  EXPECT_NE(message([&] { check_flame_value(candle, "rim_temperature", "-3 K"); }), "");
}

}  // namespace
}  // namespace plenoflame::flame_generators_test
