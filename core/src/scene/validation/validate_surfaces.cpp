#include <fmt/format.h>

#include "scene/schema/nearest.h"
#include "scene/validation/issues.h"

namespace plenoflame {
namespace {

std::string named(const char* kind, std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, index)
                      : fmt::format("{} {}", kind, quote_for_message(name));
}

void check_texture(const MaterialSpec& material, const std::string& path, const std::string& what,
                   Issues& issues) {
  const TextureSpec& texture = material.texture;
  if (texture.kind == TextureKind::none) return;
  if (material.kind != MaterialKind::lambertian)
    issues.warning(
        path + ".kind",
        what + " reflects nothing, so its texture is not used; set kind = \"lambertian\"");
  const bool needs_cell = texture.kind == TextureKind::checkerboard ||
                          texture.kind == TextureKind::dots || texture.kind == TextureKind::bars;
  if (needs_cell && !(texture.cell > 0))
    issues.error(path + ".cell", what +
                                     " has a generated pattern and needs texture.cell, the side "
                                     "of a square, spacing of dots or period of bars");
  if (texture.kind == TextureKind::image && texture.file.empty())
    issues.error(path + ".file", what + " has an image as texture and needs texture.file");
}

void check_material(const MaterialSpec& material, const std::string& path, const std::string& what,
                    Issues& issues) {
  check_texture(material, path + ".texture", what, issues);
  if (material.kind == MaterialKind::blackbody && !(material.temperature > 0))
    issues.error(path + ".temperature", what + " is a blackbody and needs a temperature above 0 K");
  if (material.kind == MaterialKind::emitter && !(material.radiance > 0))
    issues.error(path + ".radiance",
                 what + " is an emitter and needs a radiance above 0 W/(m^2 sr)");
}

void check_shape(const SolidSurfaceSpec& surface, const std::string& path, const std::string& what,
                 Issues& issues) {
  const auto need = [&](double value, const char* key) {
    if (!(value > 0))
      issues.error(path + "." + key, fmt::format("{} needs a {} above 0 m", what, key));
  };
  switch (surface.shape) {
    case SolidShape::cylinder:
    case SolidShape::cone:
      need(surface.height, "height");
      need(surface.radius, "radius");
      break;
    case SolidShape::sphere:
    case SolidShape::disc:
      need(surface.radius, "radius");
      break;
    case SolidShape::box:
      if (!(surface.size.x > 0 && surface.size.y > 0 && surface.size.z > 0))
        issues.error(path + ".size", what + " needs a size of three sides above 0 m");
      break;
    case SolidShape::plane:
      break;
    case SolidShape::mesh:
      if (surface.file.empty())
        issues.error(path + ".file", what + " is a mesh and needs a file; set file = \"NAME.obj\"");
      break;
  }
  if (surface.shape != SolidShape::mesh && !surface.file.empty())
    issues.warning(path + ".file", what + " is not a mesh, so its file is not used");
}

void check_lights(const Scene& scene, Issues& issues) {
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const LightSpec& light = scene.lights[i];
    const std::string path = fmt::format("lights[{}]", i), what = named("light", i, light.name);
    if (light.kind != LightKind::environment && !(length(light.direction) > 0))
      issues.error(path + ".direction", what + " needs a direction that is not zero");
    const struct {
      LightKind kind;
      double value;
      const char* key;
    } figures[] = {{LightKind::point, light.power, "power"},
                   {LightKind::parallel, light.irradiance, "irradiance"},
                   {LightKind::environment, light.radiance, "radiance"}};
    for (const auto& figure : figures) {
      if (figure.kind == light.kind && !(figure.value > 0))
        issues.warning(path, fmt::format("{} is dark: its {} is 0", what, figure.key));
      if (figure.kind != light.kind && figure.value != 0)
        issues.warning(
            path + "." + figure.key,
            fmt::format("{} is of another kind, so its {} is not used", what, figure.key));
    }
  }
}

}  // namespace

void check_surfaces(const Scene& scene, Issues& issues) {
  bool emits = !scene.lights.empty() || (scene.render.flame_light && !scene.flames.empty());
  for (std::size_t i = 0; i < scene.surfaces.size(); ++i) {
    const SolidSurfaceSpec& surface = scene.surfaces[i];
    const std::string path = fmt::format("surfaces[{}]", i);
    const std::string what = named("surface", i, surface.name);
    check_shape(surface, path, what, issues);
    check_material(surface.material, path + ".material", what, issues);
    emits = emits || surface.material.kind == MaterialKind::blackbody ||
            surface.material.kind == MaterialKind::emitter;
  }
  if (!scene.surfaces.empty() && !emits)
    issues.warning("surfaces", "nothing lights the surfaces, so they are black; add [[lights]]");
  check_lights(scene, issues);
}

}  // namespace plenoflame
