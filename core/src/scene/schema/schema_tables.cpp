#include "plenoflame/scene/scene_schema.h"
#include "scene/schema/schema_cameras.h"

namespace plenoflame {
namespace {

constexpr SchemaTable kTableRows[] = {
    {"camera", "Position and direction of the camera.", true, PresetKind::camera},
    {"camera.lens",
     "The main lens: surfaces, or a thin ideal lens. A `file` is TOML with this table, sequential "
     "Zemax (`.zmx`), or four columns in mm as pbrt has them (`.dat`, `.txt`). Scenes that "
     "the program writes hold `diameter` in place of `f_number`.",
     true, PresetKind::lens},
    {"camera.lens.distortion",
     "Distortion of the main lens: an invertible map of the rays in front of it.",
     false,
     {}},
    {"camera.lens.surfaces[]",
     "The surfaces of the main lens, from the scene to the sensor, in air.",
     false,
     {}},
    {"camera.array",
     "The microlens array; without it the camera is a conventional one.",
     false,
     {}},
    {"camera.array.types[]", "The one to three interleaved kinds of microlenses.", false, {}},
    {"camera.sensor", "The sensor, centred on the optical axis.", false, {}},
    {"camera.focus", "Rule for the distance between main lens and array.", false, {}},
    {"camera.transmission", "Losses of light in the camera.", false, {}},
    {"camera.pupil_filters[]",
     "Filters over parts of the main lens' stop (docs/user/filters.md).",
     false,
     {}},
    {"flames[]", "The flames.", true, PresetKind::flame},
    {"flames[].layers[]",
     "Ellipsoids of a layered flame; where several overlap, the first counts.",
     false,
     {}},
    {"flames[].temperature", "Kind `vdb`: how a grid becomes the temperature.", false, {}},
    {"flames[].absorption",
     "Kind `vdb`: how a grid becomes the absorption coefficient.",
     false,
     {}},
    {"flames[].lines[]",
     "Kind `vdb`: emission lines of the gas, from grids (docs/radiometry.md).",
     false,
     {}},
    {"flames[].spectrum", "Dependence of the absorption on wavelength.", false, {}},
    {"flames[].scattering", "Scattering by the flame.", false, {}},
    {"surfaces[]", "Solid surfaces (docs/surfaces.md).", false, {}},
    {"surfaces[].material", "Material of the surface.", false, {}},
    {"surfaces[].material.texture",
     "A pattern of the reflectivity, centred on the surface.",
     false,
     {}},
    {"windows[]", "Transparent bodies in air (docs/user/windows.md).", false, {}},
    {"lights[]", "Light sources besides flames and hot surfaces.", false, {}},
    {"channels[]",
     "Spectral channels of the pictures; without any, one channel `total`.",
     false,
     {}},
    {"render", "Defaults of a run; the command line overrides them.", false, {}},
    {"develop", "Conversion of flux into digital numbers by the command `develop`.", false, {}},
};

constexpr auto kTables = schema::with_each_camera<kTableRows>();

}  // namespace

std::span<const SchemaTable> schema_tables() {
  return kTables;
}

}  // namespace plenoflame
