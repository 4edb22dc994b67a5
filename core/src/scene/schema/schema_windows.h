#pragma once
#include <array>
#include <cstddef>

#include "plenoflame/scene/scene_schema.h"
#include "scene/schema/schema_fields.h"
#include "scene/schema/schema_paths.h"

/// The rows of the schema table that windows have.
namespace plenoflame::schema {

template <>
struct Words<WindowShape> {
  static constexpr std::string_view list[] = {"plate", "wedge", "tube", "dome"};
};

#define WINDOW &Scene::windows

inline constexpr SchemaKey kWindowRows[] = {
    key<WINDOW, &WindowSpec::shape>(
        "windows[].shape",
        "`plate` from z = 0 of its own frame to the thickness; `wedge`: its second face rises "
        "towards +y; `tube` around z, from z = 0; `dome`: a spherical shell around the origin, its "
        "top at +z."),
    key<WINDOW, &WindowSpec::name>("windows[].name", "Name for messages."),
    key<WINDOW, &WindowSpec::position>(
        "windows[].position", "World place of the origin of its own frame.", kLength, within(kFar)),
    key<WINDOW, &WindowSpec::rotation>("windows[].rotation",
                                       "Rotation about the world's x, then y, then z.", kAngle,
                                       within(1000)),
    key<WINDOW, &WindowSpec::thickness>("windows[].thickness",
                                        "Thickness of a plate or wall; of a wedge, in its middle.",
                                        kLength, above_zero(kLargestLens)),
    key<WINDOW, &WindowSpec::diameter>("windows[].diameter",
                                       "Plate and wedge: diameter if round; 0 m: `extent` applies.",
                                       kLength, from_zero(kFar)),
    key<WINDOW, &WindowSpec::extent>("windows[].extent",
                                     "Plate and wedge: sides along x and y of its own frame.",
                                     kLength, from_zero(kFar)),
    key<WINDOW, &WindowSpec::angle>("windows[].angle", "Wedge: angle between its faces.", kAngle,
                                    from_zero(1)),
    key<WINDOW, &WindowSpec::radius>("windows[].radius", "Tube and dome: radius of the outer face.",
                                     kLength, from_zero(kFar)),
    key<WINDOW, &WindowSpec::height>(
        "windows[].height", "Tube: length; dome: from rim to top, at most twice the radius.",
        kLength, from_zero(kFar)),
    key<WINDOW, &WindowSpec::glass>(
        "windows[].glass", "Glass, named as for a lens (`FUSED-SILICA`, `N-BK7`); empty: `index`."),
    key<WINDOW, &WindowSpec::index>("windows[].index", "Refractive index, if no glass is named.",
                                    kPure, kIndex),
    key<WINDOW, &WindowSpec::absorption>(
        "windows[].absorption", "Absorption coefficient of the glass, the same in every channel.",
        Dimension::absorption, from_zero(1e9)),
    key<WINDOW, &WindowSpec::fresnel>("windows[].fresnel",
                                      "Whether the faces of the window reflect light."),
};

#undef WINDOW

/// Two lists of rows, one after the other.
template <class Row, std::size_t First, std::size_t Second>
constexpr std::array<Row, First + Second> joined(const Row (&first)[First],
                                                 const Row (&second)[Second]) {
  std::array<Row, First + Second> rows{};
  for (std::size_t i = 0; i < First; ++i) rows[i] = first[i];
  for (std::size_t i = 0; i < Second; ++i) rows[First + i] = second[i];
  return rows;
}

}  // namespace plenoflame::schema
