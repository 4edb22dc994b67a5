#include "plenoflame/scene/scene_schema.h"
#include "scene/schema/schema_cameras.h"

namespace plenoflame {
namespace {

constexpr SchemaTable kTableRows[] = {
    {"camera", "Where the camera stands and looks.", true, PresetKind::camera},
    {"camera.lens",
     "The main lens: surfaces, or a thin ideal lens. `preset` names a prescription below; `file` "
     "reads "
     "one from a file, relative to the scene: TOML with this table, sequential Zemax (`.zmx`), or "
     "four "
     "columns in mm as pbrt has them (`.dat`, `.txt`). `f_number` takes the place of the diameter "
     "of "
     "the stop; what is written later, or printed by `info --scene`, has the diameter.",
     true, PresetKind::lens},
    {"camera.lens.distortion",
     "Where the main lens images directions elsewhere than an ideal one: a map of the rays outside "
     "of it that can be undone. Without it there is none.",
     false,
     {}},
    {"camera.lens.surfaces[]",
     "The surfaces of the main lens, from the scene to the sensor, in air.",
     false,
     {}},
    {"camera.array",
     "The microlens array; without this table the camera is a conventional one.",
     false,
     {}},
    {"camera.array.types[]", "The one to three interleaved kinds of microlenses.", false, {}},
    {"camera.sensor", "The sensor, centred on the optical axis.", false, {}},
    {"camera.focus", "How the distance between main lens and array is found.", false, {}},
    {"camera.transmission",
     "What is lost of the light in the camera; without it, nothing but what apertures stop.",
     false,
     {}},
    {"camera.pupil_filters[]",
     "Filters over parts of the main lens' stop, so that views differ in wavelength "
     "(docs/user/filters.md).",
     false,
     {}},
    {"flames[]", "The flames.", true, PresetKind::flame},
    {"flames[].layers[]",
     "Ellipsoids of a layered flame; where several overlap, the first listed counts.",
     false,
     {}},
    {"flames[].temperature", "Kind `vdb`: how a grid becomes the temperature.", false, {}},
    {"flames[].absorption",
     "Kind `vdb`: how a grid becomes the absorption coefficient.",
     false,
     {}},
    {"flames[].lines[]",
     "Kind `vdb`: light that the gas emits at one wavelength whatever its temperature, from a grid "
     "(docs/radiometry.md).",
     false,
     {}},
    {"flames[].spectrum", "How the absorption depends on wavelength.", false, {}},
    {"flames[].scattering",
     "Light that goes on in another direction; only scenes that have it pay for it.",
     false,
     {}},
    {"surfaces[]", "Solid surfaces (docs/surfaces.md).", false, {}},
    {"surfaces[].material", "What the surface is made of.", false, {}},
    {"surfaces[].material.texture",
     "A pattern of the reflectivity, centred on the surface.",
     false,
     {}},
    {"windows[]",
     "Transparent bodies in air between flames and camera, or around them (docs/user/windows.md).",
     false,
     {}},
    {"lights[]", "Light sources; flames and hot surfaces are sources of their own.", false, {}},
    {"channels[]", "What is measured; without any, one channel `total`.", false, {}},
    {"render", "Defaults of a run; the command line overrides them.", false, {}},
    {"develop", "How the command `develop` turns flux into digital numbers.", false, {}},
};

constexpr auto kTables = schema::with_each_camera<kTableRows>();

}  // namespace

std::span<const SchemaTable> schema_tables() {
  return kTables;
}

}  // namespace plenoflame
