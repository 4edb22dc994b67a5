#include "plenoflame/scene/scene_schema.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "plenoflame/base/error.h"
#include "scene_samples.h"

namespace plenoflame::scene_schema_test {
namespace {

using test::message_of;

TEST(SceneSchema, PathsAreUniqueAndStandInATableThatIsDescribed) {
  std::set<std::string_view> tables, paths;
  for (const SchemaTable& table : schema_tables())
    EXPECT_TRUE(tables.insert(table.path).second) << table.path;
  for (const SchemaKey& key : schema_keys()) {
    EXPECT_TRUE(paths.insert(key.path).second) << key.path;
    const std::string_view table = key.path.substr(0, key.path.rfind('.'));
    EXPECT_TRUE(tables.count(table)) << key.path;
    EXPECT_TRUE(key.description.ends_with(".")) << key.path;
    EXPECT_EQ(find_schema_key(key.path), &key);
  }
  for (const SchemaList& list : schema_lists())
    EXPECT_TRUE(tables.count(std::string(list.path) + "[]")) << list.path;
}

// A get or set that reaches the wrong member shows as another path changing too, or none.
TEST(SceneSchema, EveryKeyReachesAMemberOfItsOwn) {
  const Scene original = test::full_scene();
  for (const std::string& path : scene_paths(original)) {
    Scene changed = original;
    const ParsedPath parsed = parse_path(path);
    const SchemaKey& key = *find_schema_key(parsed.schema_path);
    const std::string before = get_text(original, path);
    std::string other;
    switch (key.type) {
      case ValueType::boolean:
        other = before == "true" ? "false" : "true";
        break;
      case ValueType::integer:
      case ValueType::natural:
        other = "3";
        break;
      case ValueType::text:
        // A list of numbers, kept as text in files.
        other = path.ends_with(".aspheric") ? "120 1/m^3" : before + "x";
        break;
      case ValueType::choice:
        other = std::string(key.choices[key.choices[0] == before ? 1 : 0]);
        break;
      case ValueType::number:
        other = "1.25";
        break;
      case ValueType::vector2:
        other = "1.25, 0.5";
        break;
      case ValueType::vector3:
        other = "1.25, 0.5, 0.75";
        break;
    }
    if (key.type >= ValueType::vector2 || key.type == ValueType::number) {
      const double scale = key.range.upper < 1.25 ? key.range.upper / 2 : 1;
      std::string with_units;
      for (const double c : {1.25, 0.5, 0.75}) {
        with_units += (with_units.empty() ? "" : ", ") + format_quantity(c * scale, key.dimension);
        if (key.type == ValueType::number || (key.type == ValueType::vector2 && c == 0.5)) break;
      }
      other = with_units;
    }
    set_text(changed, path, other);
    EXPECT_NE(changed, original) << path;
    EXPECT_EQ(get_text(changed, path), other) << path;
    for (const std::string& rest : scene_paths(original))
      if (rest != path) {
        EXPECT_EQ(get_text(changed, rest), get_text(original, rest)) << path << " changed " << rest;
      }
    set_text(changed, path, before);
    EXPECT_EQ(changed, original) << path;
  }
}

TEST(SceneSchema, PathsReachTheRightItem) {
  Scene scene = test::full_scene();
  set_text(scene, "flames[1].layers[0].centre", "1 mm, 2 mm, 3 mm");
  EXPECT_EQ(scene.flames[1].layers[0].centre, (Vec3{0.001, 0.002, 0.003}));
  set_text(scene, "camera.lens.surfaces[2].stop", "true");
  EXPECT_TRUE(scene.camera.lens.surfaces[2].stop);
  set_text(scene, "camera.array.lattice", "square");
  EXPECT_EQ(scene.camera.array.lattice, Lattice::square);
  set_text(scene, "render.seed", "18446744073709551615");
  EXPECT_EQ(scene.render.seed, 18446744073709551615u);
  EXPECT_EQ(get_text(scene, "camera.array.types[1].index"), "1.59");
}

TEST(SceneSchema, WrongTextLeavesTheSceneAlone) {
  const Scene original = test::full_scene();
  Scene scene = original;
  const auto set = [&](const char* path, const char* text) {
    return message_of([&] { set_text(scene, path, text); });
  };
  EXPECT_EQ(set("camera.array.pich", "1 mm"),
            "there is no key \"camera.array.pich\"; did you mean \"camera.array.pitch\"?");
  EXPECT_EQ(set("camera.array.pitch", "1"),
            "\"1\" is not a length: its unit is missing (one of m, mm, um, nm, cm, km)");
  EXPECT_EQ(set("camera.array.pitch", "-1 mm"),
            "-1 mm is not possible here; above 0 m, at most 1 m is allowed");
  EXPECT_EQ(set("camera.array.lattice", "hexagnal"),
            "\"hexagnal\" is not one of square, hexagonal; did you mean \"hexagonal\"?");
  EXPECT_EQ(set("flames[7].kind", "vdb"),
            "the path \"flames[7].kind\" asks for item 7 of flames, which has 2");
  EXPECT_EQ(set("camera.lens.surfaces[].radius", "1 m"),
            "the path \"camera.lens.surfaces[].radius\" needs a number in each pair of brackets");
  EXPECT_EQ(set("render.samples", "1.5"),
            "\"1.5\" is not a whole number; 1 to 1073741824 is allowed");
  EXPECT_EQ(set("camera.position", "1 m, 2 m"),
            "\"1 m, 2 m\" does not have 3 components, separated by commas");
  EXPECT_NE(set("camera.lens.surfaces[0].radius", "0 m"), "");
  EXPECT_NE(set("flames[x].kind", "vdb"), "");
  EXPECT_NE(set("flames[0", "vdb"), "");
  EXPECT_EQ(scene, original);
}

TEST(SceneSchema, ListsGrowAndShrinkAtAPlace) {
  Scene scene = test::full_scene();
  const auto last = scene.flames[1];
  insert_item(scene, "flames", 1);
  EXPECT_EQ(list_size(scene, "flames"), 3u);
  EXPECT_EQ(scene.flames[1], FlameSpec{});
  EXPECT_EQ(scene.flames[2], last);
  erase_item(scene, "flames", 1);
  EXPECT_EQ(scene, test::full_scene());
  insert_item(scene, "flames[1].layers", list_size(scene, "flames[1].layers"));
  EXPECT_EQ(scene.flames[1].layers.back(), EllipsoidSpec{});
  EXPECT_NE(message_of([&] { insert_item(scene, "camera.array.types", 0); }),
            "");  // there are three
  EXPECT_NE(message_of([&] { erase_item(scene, "flames", 9); }), "");
  while (list_size(scene, "channels") > 1) erase_item(scene, "channels", 0);
  EXPECT_NE(message_of([&] { erase_item(scene, "channels", 0); }), "");
}

TEST(SceneSchema, DefaultsAreThoseOfTheStructs) {
  EXPECT_EQ(std::get<double>(default_value(*find_schema_key("camera.lens.surfaces[].index"))),
            SurfaceSpec{}.index);
  EXPECT_EQ(std::get<std::string>(default_value(*find_schema_key("flames[].interpolation"))),
            "trilinear");
  EXPECT_TRUE(is_required(*find_schema_key("camera.sensor.columns")));
  EXPECT_TRUE(is_required(*find_schema_key("flames[].layers[].semi_axes")));
  EXPECT_FALSE(is_required(*find_schema_key("camera.lens.focal_length")));
}

}  // namespace
}  // namespace plenoflame::scene_schema_test
