#include "plenoflame/scene/lens_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/optics/surface_shape.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame {
namespace {

LensFile read_toml_lens(const std::string& text, const std::string& path) {
  const SceneDocument document = parse_scene(text, path);
  LensFile file;
  file.lens = document.scene.camera.lens;
  if (file.lens.surfaces.empty() && file.lens.focal_length == 0)
    throw InputError(SourcePosition{path},
                     "the file has no lens; it needs a table [camera.lens] with surfaces");
  for (std::size_t i = 0; i < file.lens.surfaces.size(); ++i)
    if (const auto fault = surface_fault(file.lens.surfaces[i]))
      throw InputError(
          document.positions.find(fmt::format("camera.lens.surfaces[{}].{}", i, fault->key)),
          fmt::format("surface {} of the main lens {}", i, fault->text));
  return file;
}

/// Tells whether a prescription takes its lens from yet another file, perhaps itself.
bool refers_to_a_file(const std::string& text) {
  try {
    return toml::parse(text)["camera"]["lens"].as_table() != nullptr &&
           toml::parse(text)["camera"]["lens"]["file"];
  } catch (const toml::parse_error&) {
    return false;  // parse_scene says what is wrong
  }
}

}  // namespace

LensFile read_lens_file(const std::string& path) {
  std::string ending = path.substr(std::min(path.rfind('.'), path.size()));
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const bool columns = ending == ".dat" || ending == ".txt";
  if (ending != ".toml" && ending != ".zmx" && !columns)
    throw InputError(SourcePosition{path}, "a lens is read from a .toml, .zmx, .dat or .txt file");
  const std::string text = read_file(path);
  if (ending == ".zmx") return import_zmx(text, path);
  if (columns) return import_four_columns(text, path);
  if (refers_to_a_file(text))
    throw InputError(SourcePosition{path}, "a prescription cannot take its lens from another file");
  return read_toml_lens(text, path);
}

std::string write_lens(const MainLensSpec& lens) {
  Scene scene;
  scene.camera.lens = lens;
  const std::string text = write_scene(scene);
  const auto begin = text.find("[camera.lens]");
  return text.substr(begin, text.find("\n[camera.array]") - begin);
}

}  // namespace plenoflame
