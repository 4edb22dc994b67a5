#pragma once
#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "plenoflame/scene/scene_schema.h"

/// Parts of the rows of the schema table: words of the choices, and functions from a chain of
/// members to a field of a scene.
namespace plenoflame::schema {

// ---- words of the choices, in the order of the enumerators -------------------------------------

template <class Enum>
struct Words;
template <>
struct Words<LensModel> {
  static constexpr std::string_view list[] = {"real", "ideal"};
};
template <>
struct Words<Lattice> {
  static constexpr std::string_view list[] = {"square", "hexagonal"};
};
template <>
struct Words<ApertureShape> {
  static constexpr std::string_view list[] = {"circular", "square", "hexagonal"};
};
template <>
struct Words<PupilPartShape> {
  static constexpr std::string_view list[] = {"sector", "polygon"};
};
template <>
struct Words<ArrayReference> {
  static constexpr std::string_view list[] = {"principal_plane", "vertex"};
};
template <>
struct Words<FocusMode> {
  static constexpr std::string_view list[] = {"distance", "paraxial", "best"};
};
template <>
struct Words<FlameKind> {
  static constexpr std::string_view list[] = {"layered", "vdb"};
};
template <>
struct Words<Interpolation> {
  static constexpr std::string_view list[] = {"trilinear", "constant"};
};
template <>
struct Words<SolidShape> {
  static constexpr std::string_view list[] = {"sphere", "cylinder", "cone", "disc",
                                              "plane",  "box",      "mesh"};
};
template <>
struct Words<MaterialKind> {
  static constexpr std::string_view list[] = {"lambertian", "black", "blackbody", "emitter"};
};
template <>
struct Words<MaterialSides> {
  static constexpr std::string_view list[] = {"both", "front"};
};
template <>
struct Words<TextureKind> {
  static constexpr std::string_view list[] = {"none",         "checkerboard", "dots",
                                              "siemens_star", "bars",         "image"};
};
template <>
struct Words<LightKind> {
  static constexpr std::string_view list[] = {"point", "parallel", "environment"};
};
template <>
struct Words<ChannelKind> {
  static constexpr std::string_view list[] = {"total", "band", "line", "curve", "named"};
};
template <>
struct Words<SpectrumKind> {
  static constexpr std::string_view list[] = {"grey", "power", "soot", "table"};
};
template <>
struct Words<LineKind> {
  static constexpr std::string_view list[] = {"custom", "ch", "c2_474", "c2_517",
                                              "c2_564", "oh", "na_d"};
};
template <>
struct Words<PhaseFunction> {
  static constexpr std::string_view list[] = {"henyey_greenstein", "rayleigh"};
};
template <>
struct Words<SootIndexSource> {
  static constexpr std::string_view list[] = {"constant", "chang", "dalzell"};
};
template <>
struct Words<MosaicPattern> {
  static constexpr std::string_view list[] = {"none", "rggb", "bggr", "grbg", "gbrg"};
};
template <>
struct Words<Estimator> {
  static constexpr std::string_view list[] = {"backward", "forward"};
};
template <>
struct Words<ToneCurve> {
  static constexpr std::string_view list[] = {"linear", "display"};
};

// ---- from a chain of members to a field of a scene ----------------------------------------------

template <class T>
inline constexpr bool is_list = false;
template <class T>
inline constexpr bool is_list<std::vector<T>> = true;

/// The field that a chain of members leads to; every list on the way takes the next index.
template <auto First, auto... Rest>
auto& locate_below(auto& object, SchemaIndices indices) {
  auto& member = object.*First;
  if constexpr (sizeof...(Rest) == 0) {
    return member;
  } else if constexpr (is_list<std::remove_cvref_t<decltype(member)>>) {
    return locate_below<Rest...>(member.at(indices.front()), indices.subspan(1));
  } else {
    return locate_below<Rest...>(member, indices);
  }
}

template <class Object, class Member>
constexpr bool leads_to_list(Member Object::*) {
  return is_list<Member>;
}

/// Number of lists that a chain goes through on its way; its end is not counted.
template <auto First, auto... Rest>
constexpr std::size_t lists_on_the_way() {
  if constexpr (sizeof...(Rest) == 0) {
    return 0;
  } else {
    return (leads_to_list(First) ? 1 : 0) + lists_on_the_way<Rest...>();
  }
}

/// The same from a scene. A chain that begins with its camera takes one index more where it is
/// about one of several: the first then says which of Scene::cameras.
template <auto First, auto... Rest>
auto& locate(auto& scene, SchemaIndices indices) {
  if constexpr (std::is_same_v<decltype(First), CameraSpec Scene::*>) {
    if (indices.size() > lists_on_the_way<First, Rest...>())
      return locate_below<Rest...>(scene.cameras.at(indices.front()), indices.subspan(1));
  }
  return locate_below<First, Rest...>(scene, indices);
}

template <class Field>
constexpr ValueType value_type() {
  if constexpr (std::is_enum_v<Field>) return ValueType::choice;
  if constexpr (std::is_same_v<Field, bool>) return ValueType::boolean;
  if constexpr (std::is_same_v<Field, int>) return ValueType::integer;
  if constexpr (std::is_same_v<Field, std::uint64_t>) return ValueType::natural;
  if constexpr (std::is_same_v<Field, double>) return ValueType::number;
  if constexpr (std::is_same_v<Field, Vec2>) return ValueType::vector2;
  if constexpr (std::is_same_v<Field, Vec3>) return ValueType::vector3;
  return ValueType::text;
}

template <auto... Members>
SchemaValue get_field(const Scene& scene, SchemaIndices indices) {
  const auto& field = locate<Members...>(scene, indices);
  using Field = std::remove_cvref_t<decltype(field)>;
  if constexpr (std::is_enum_v<Field>) {
    const auto i = static_cast<std::size_t>(field);
    return std::string(i < std::size(Words<Field>::list) ? Words<Field>::list[i] : "?");
  } else if constexpr (std::is_same_v<Field, int>) {
    return std::int64_t{field};
  } else {
    return field;
  }
}

template <auto... Members>
void set_field(Scene& scene, SchemaIndices indices, const SchemaValue& value) {
  auto& field = locate<Members...>(scene, indices);
  using Field = std::remove_cvref_t<decltype(field)>;
  if constexpr (std::is_enum_v<Field>) {
    for (std::size_t i = 0; i < std::size(Words<Field>::list); ++i)
      if (Words<Field>::list[i] == std::get<std::string>(value)) field = static_cast<Field>(i);
  } else if constexpr (std::is_same_v<Field, int>) {
    field = static_cast<int>(std::get<std::int64_t>(value));
  } else {
    field = std::get<Field>(value);
  }
}

template <auto... Members>
constexpr SchemaKey key(std::string_view path, std::string_view description,
                        Dimension dimension = Dimension::none, ValueRange range = {}) {
  using Field = std::remove_cvref_t<decltype(locate<Members...>(std::declval<Scene&>(), {}))>;
  std::span<const std::string_view> choices;
  if constexpr (std::is_enum_v<Field>) choices = Words<Field>::list;
  return {path,
          value_type<Field>(),
          dimension,
          range,
          choices,
          description,
          &get_field<Members...>,
          &set_field<Members...>};
}

template <auto... Members>
constexpr SchemaList list(std::string_view path, std::size_t fewest, std::size_t most) {
  return {path,
          fewest,
          most,
          [](const Scene& scene, SchemaIndices i) { return locate<Members...>(scene, i).size(); },
          [](Scene& scene, SchemaIndices i, std::size_t size) {
            locate<Members...>(scene, i).resize(size);
          },
          [](Scene& scene, SchemaIndices i, std::size_t position) {
            auto& items = locate<Members...>(scene, i);
            items.emplace(items.begin() + static_cast<std::ptrdiff_t>(position));
          },
          [](Scene& scene, SchemaIndices i, std::size_t position) {
            auto& items = locate<Members...>(scene, i);
            items.erase(items.begin() + static_cast<std::ptrdiff_t>(position));
          }};
}

}  // namespace plenoflame::schema
