#include "plenoflame/scene/compile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "media/voxels/majorant_grid.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/media/brightened_medium.h"
#include "plenoflame/media/layered_medium.h"
#include "plenoflame/media/uniform_medium.h"
#include "plenoflame/scene/cameras.h"
#include "plenoflame/scene/glass_indices.h"
#include "plenoflame/scene/timeline.h"
#include "plenoflame/scene/validate.h"
#include "scene/scene_folder.h"

namespace plenoflame {
namespace {

std::string flame_in_words(const Scene& scene, std::size_t index) {
  const std::string& name = scene.flames[index].name;
  return "flame " + (name.empty() ? std::to_string(index) : "\"" + name + "\"");
}

/// A solid surface around the camera must also hold the flames, like a room. Otherwise it hides
/// them, which is an error; without flames it is a warning.
void check_camera_outside(const CompiledScene& compiled, const PositionMap& positions,
                          const Execution& execution) {
  const Scene& scene = compiled.scene;
  const int around = compiled.surfaces->inside_of(scene.camera.position);
  if (around < 0) return;
  const std::string text = camera_in_words(scene.camera) + " is inside of " +
                           surface_name(scene.surfaces, around) + ", which hides ";
  const SourcePosition place = positions.find(fmt::format("surfaces[{}].position", around));
  for (std::size_t i = 0; i < compiled.flames.size(); ++i) {
    if (!compiled.flames[i]) continue;
    const Box box = compiled.flames[i]->bounds();
    if (compiled.surfaces->inside_of(0.5 * (box.lower + box.upper)) == around) continue;
    throw InputError(place, text + flame_in_words(scene, i) + "; move one of them");
  }
  if (compiled.flames.empty())
    execution.warn(InputError(place, text + "everything else; move one of them").what());
}

void warn_of_lights_inside(const CompiledScene& compiled, const PositionMap& positions,
                           const Execution& execution) {
  const Scene& scene = compiled.scene;
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const LightSpec& light = scene.lights[i];
    if (light.kind != LightKind::point) continue;
    const int around = compiled.surfaces->inside_of(light.position);
    if (around < 0) continue;
    const std::string name =
        light.name.empty() ? "light " + std::to_string(i) : "light \"" + light.name + "\"";
    execution.warn(InputError(positions.find(fmt::format("lights[{}].position", i)),
                              fmt::format("{} is inside of {}, which hides everything else; move "
                                          "one of them",
                                          name, surface_name(scene.surfaces, around)))
                       .what());
  }
}

}  // namespace

std::unique_ptr<Medium> load_core_medium(const FlameSpec& flame, const std::string&,
                                         const std::vector<SourceFunction>& channels,
                                         const Execution&) {
  if (flame.kind != FlameKind::layered)
    throw InputError("flame \"" + flame.name +
                     "\" is an OpenVDB file; this program was built without OpenVDB");
  std::vector<EllipsoidLayer> layers;
  for (const EllipsoidSpec& layer : flame.layers)
    layers.push_back({flame.scale * layer.centre, flame.scale * layer.semi_axes, layer.temperature,
                      layer_absorption(layer, flame.spectrum)});
  return make_layered_medium(std::move(layers), {rotation_xyz(flame.rotation), flame.position},
                             channels, absorption_factors(flame.spectrum, channels));
}

namespace {

/// A scene to be compiled, and what compile() was given for it.
struct Compilation {
  const Scene& scene;
  const PositionMap& positions;
  const MediumLoader& loader;
  const Execution& execution;
  const EarlierScenes& earlier;
};

/// Loads a flame, without its brightness; what is wrong with its file is said with the place that
/// names it.
std::shared_ptr<const Medium> load(const Compilation& given, std::size_t index,
                                   const std::vector<SourceFunction>& all_channels) {
  const auto& [scene, positions, loader, execution, earlier] = given;
  FlameSpec flame = scene.flames[index];
  std::vector<SourceFunction> channels = all_channels;
  // The loader does this itself for a grid of albedos.
  if (const double albedo = flame.scattering.albedo; albedo > 0 && flame.scattering.grid.empty()) {
    // Media use extinction: scattered light is removed, and not emitted.
    const double extinction = 1 / (1 - albedo);
    for (EllipsoidSpec& layer : flame.layers) {
      layer.absorption *= extinction;
      layer.volume_fraction *= extinction;
    }
    flame.absorption.scale *= extinction;
    flame.absorption.offset *= extinction;
    for (SourceFunction& channel : channels) channel = channel.scaled(1 - albedo);
  }
  const std::string folder = folder_of(scene);
  const std::string path = "flames[" + std::to_string(index) + "]";
  const SourcePosition position = positions.find(path + ".file");
  const std::string where = to_string(position);
  Execution located = execution;
  if (!where.empty())
    located.message = [&](Severity severity, const std::string& text) {
      if (execution.message) execution.message(severity, where + ": " + text);
    };
  try {
    return loader(flame, folder, channels, located);
  } catch (const InputError& error) {
    if (where.empty() || !error.position().file.empty()) throw;
    throw InputError(position, error.what());
  } catch (const FileError& error) {
    if (where.empty()) throw;
    throw FileError(where + ": " + error.what());
  }
}

/// Tells whether the camera sees a flame whose extent is known only now.
void check_place(const Scene& scene, std::size_t index, const Medium* medium,
                 const PositionMap& positions, const Execution& execution) {
  const FlameSpec& flame = scene.flames[index];
  // The places of layers are known without loading them, and validate() has checked them.
  if (flame.kind == FlameKind::layered || !medium) return;
  const std::string key = "flames[" + std::to_string(index) + "].position";
  const std::string name = flame.name.empty() ? flame.file : flame.name;
  for (const SceneIssue& issue :
       check_flame_box(scene.camera, name, medium->bounds(), key, positions)) {
    if (issue.is_error) throw InputError(issue.position, issue.message);
    execution.warn(to_string(issue));
  }
}

/// Places in smoke are drawn without regard to how near they are to a light.
void check_lights_in_smoke(const Scene& scene, std::size_t index, const Medium& medium,
                           const PositionMap& positions, const Execution& execution) {
  if (!scene.flames[index].scattering.present()) return;
  const Box box = medium.bounds();
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const LightSpec& light = scene.lights[i];
    const Vec3 p = light.position;
    if (light.kind != LightKind::point || p.x < box.lower.x || p.y < box.lower.y ||
        p.z < box.lower.z || p.x > box.upper.x || p.y > box.upper.y || p.z > box.upper.z)
      continue;
    const std::string path = "lights[" + std::to_string(i) + "]";
    execution.warn(to_string(
        SceneIssue{false, path, positions.find(path),
                   path + " is a point light within a scattering flame: it makes bright specks and "
                          "the stated error too small; use a small emitting sphere"}));
  }
}

/// Steps in smoke are as short as the largest extinction around them requires.
void warn_of_short_steps(const CompiledScene& compiled, const Execution& execution) {
  constexpr double kMany = 1e4;  // some 0.1 ms for every line that light takes
  if (compiled.scatterers.empty()) return;
  double most = 0;
  for (int c = 0; c < compiled.medium->channel_count(); ++c)
    most = std::max(most, compiled.medium->largest_absorption(c));
  const Box box = compiled.medium->bounds();
  double steps = most * length(box.upper - box.lower);
  if (!std::isfinite(steps) || !(steps > kMany)) return;
  steps *= MajorantGrid(*compiled.medium).mean_share();
  if (!(steps > kMany)) return;
  execution.warn(fmt::format(
      "the flames scatter, with an extinction up to {:.3g} 1/m within bounds of {}: light takes "
      "about {:.2g} steps through them, which is slow; is their absorption in 1/m?",
      most, readable_quantity(length(box.upper - box.lower), Dimension::length), steps));
}

using Media = std::vector<std::shared_ptr<const Medium>>;

/// The flames of a scene, as they were loaded and with their brightness.
struct Flames {
  Media loaded, bright;
  void add(std::shared_ptr<const Medium> medium, const FlameSpec& flame) {
    loaded.push_back(std::move(medium));
    bright.push_back(brightened(loaded.back(), flame.brightness));
  }
};

/// A flame of an earlier scene that is this one, or this one at another place.
struct Known {
  std::shared_ptr<const Medium> loaded, bright;  ///< nullptr: none
};

/// The flame of another scene as it would be with this one's place and brightness.
FlameSpec put_in_place_of(const FlameSpec& other, const FlameSpec& flame) {
  FlameSpec moved = other;
  moved.position = flame.position;
  moved.rotation = flame.rotation;
  moved.scale = flame.scale;
  moved.brightness = flame.brightness;
  return moved;
}

/// The medium of a flame that an earlier scene has in common with this one, nothing but the place
/// and the brightness being other ones.
Known known_flame(const Scene& scene, std::size_t index,
                  const std::vector<SourceFunction>& channels, const EarlierScenes& earlier) {
  const FlameSpec& flame = scene.flames[index];
  const FlameSpec* like = nullptr;
  Known known;
  for (const CompiledScene* other : earlier) {
    if (!other || other->sources != channels || folder_of(other->scene) != folder_of(scene))
      continue;
    for (std::size_t i = 0; i < other->flames.size(); ++i) {
      const FlameSpec& there = other->scene.flames[i];
      if (!other->loaded[i]) continue;
      if (there == flame) return {other->loaded[i], other->flames[i]};
      if (like || !(put_in_place_of(there, flame) == flame)) continue;
      like = &there;
      known.loaded = other->loaded[i];
    }
  }
  if (!like) return {};
  if (like->position != flame.position || like->rotation != flame.rotation ||
      like->scale != flame.scale)
    known.loaded =
        known.loaded->placed({flame.scale, {rotation_xyz(flame.rotation), flame.position}});
  known.bright = brightened(known.loaded, flame.brightness);
  return known;
}

Flames load_flames(const Compilation& given, const std::vector<SourceFunction>& channels) {
  const Scene& scene = given.scene;
  Flames flames;
  for (std::size_t i = 0; i < scene.flames.size(); ++i) {
    if (Known known = known_flame(scene, i, channels, given.earlier); known.loaded) {
      flames.loaded.push_back(std::move(known.loaded));
      flames.bright.push_back(std::move(known.bright));
    } else {
      flames.add(load(given, i, channels), scene.flames[i]);
    }
    const Medium* const medium = flames.bright.back().get();
    check_place(scene, i, medium, given.positions, given.execution);
    if (medium) check_lights_in_smoke(scene, i, *medium, given.positions, given.execution);
  }
  return flames;
}

std::shared_ptr<const SurfaceScene> compile_surfaces(const Compilation& given,
                                                     const std::vector<SourceFunction>& emitters) {
  const Scene& scene = given.scene;
  if (scene.surfaces.empty()) return nullptr;
  for (const CompiledScene* other : given.earlier)
    if (other && other->scene.surfaces == scene.surfaces && other->emitters == emitters &&
        folder_of(other->scene) == folder_of(scene))
      return other->surfaces;
  return make_surface_scene(
      scene.surfaces, folder_of(scene), emitters, given.execution, [&](int surface) {
        return to_string(given.positions.find("surfaces[" + std::to_string(surface) + "]"));
      });
}

/// Light starts and ends in air: no flame may reach into a window's glass. Only the dark parts of a
/// flame's lattice may.
void check_flames_beside_windows(const Scene& scene, const Media& flames,
                                 const PositionMap& positions) {
  if (scene.windows.empty()) return;
  const WindowSet windows(scene.windows);
  for (std::size_t w = 0; w < scene.windows.size(); ++w) {
    const std::vector<Vec3> points = windows.points_of(static_cast<int>(w));
    for (std::size_t f = 0; f < flames.size(); ++f) {
      if (!flames[f]) continue;
      std::vector<double> emission(static_cast<std::size_t>(flames[f]->channel_count()));
      for (const Vec3 point : points) {
        const double absorption = flames[f]->coefficients(point, emission.data());
        if (!(absorption > 0) && !(*std::max_element(emission.begin(), emission.end()) > 0))
          continue;
        throw InputError(positions.find("windows[" + std::to_string(w) + "].position"),
                         window_name(scene.windows, w) + " stands in " + flame_in_words(scene, f) +
                             ", whose light must not start within the glass; move one of them");
      }
    }
  }
}

/// Rays within the glass are straight from face to face, so no solid surface may be in their way.
/// The test uses lines through the wall and on to the next one.
void check_surfaces_beside_windows(const CompiledScene& compiled, const PositionMap& positions) {
  if (!compiled.windows || !compiled.surfaces) return;
  constexpr double kRounding = 1e-6;  ///< of a line: a surface may lie on a face
  for (int w = 0; w < compiled.windows->size(); ++w) {
    const std::vector<Vec3> points = compiled.windows->points_of(w);
    int surface = compiled.surfaces->inside_of(points[points.size() / 2]);
    const double longest = 4 * length(points[3] - points[2]) + 4 * length(points[1] - points[0]);
    for (std::size_t k = 0; k + 1 < points.size() && surface < 0; ++k) {
      const Vec3 way = points[k + 1] - points[k];
      const double along = length(way);
      SurfaceHit hit;
      if (!(along > 0) || along > longest) continue;
      if (compiled.surfaces->intersect({points[k], (1 / along) * way}, kRounding * along,
                                       (1 - kRounding) * along, {}, hit))
        surface = hit.where.surface;
    }
    if (surface >= 0)
      throw InputError(positions.find("windows[" + std::to_string(w) + "].position"),
                       window_name(compiled.scene.windows, static_cast<std::size_t>(w)) + " and " +
                           surface_name(compiled.scene.surfaces, surface) +
                           " reach into each other; solid surfaces stand in air: move one of them");
  }
}

/// The flames in one of their channels: files are not read once more.
Flames flames_of_channel(const Compilation& given, const Flames& all, int channel,
                         const SourceFunction& source) {
  Flames flames;
  for (std::size_t i = 0; i < all.loaded.size(); ++i) {
    if (Known known = known_flame(given.scene, i, {source}, given.earlier); known.loaded) {
      flames.loaded.push_back(std::move(known.loaded));
      flames.bright.push_back(std::move(known.bright));
      continue;
    }
    std::shared_ptr<const Medium> medium;
    if (all.loaded[i]) medium = all.loaded[i]->single_channel(channel);
    if (!medium) medium = load(given, i, {source});
    flames.add(std::move(medium), given.scene.flames[i]);
  }
  return flames;
}

/// The medium of all flames together.
std::shared_ptr<const Medium> all_of(const Media& flames, const EarlierScenes& earlier) {
  if (flames.empty()) return nullptr;
  if (flames.size() == 1) return flames.front();
  for (const CompiledScene* other : earlier)
    if (other && other->flames == flames) return other->medium;
  return make_composite_medium(flames);
}

/// Compiles the channels, or their wavelengths, after camera and flames.
CompiledScene compile_content(const Compilation& given, Camera camera, PupilSampling pupils,
                              Flames flames, const std::vector<SourceFunction>& sources,
                              const std::vector<SourceFunction>& emitters) {
  const Scene& scene = given.scene;
  std::vector<Scatterer> scatterers;
  for (std::size_t i = 0; i < flames.bright.size(); ++i)
    if (scene.flames[i].scattering.present())
      scatterers.push_back({flames.bright[i].get(), scene.flames[i].scattering});
  CompiledScene compiled{scene,
                         std::move(camera),
                         std::move(pupils),
                         all_of(flames.bright, given.earlier),
                         compile_surfaces(given, emitters),
                         compile_lights(scene.lights, emitters),
                         {},
                         std::move(scatterers)};
  compiled.sources = sources;
  compiled.emitters = emitters;
  compiled.flames = std::move(flames.bright);
  compiled.loaded = std::move(flames.loaded);
  if (!scene.windows.empty()) compiled.windows = std::make_unique<WindowSet>(scene.windows);
  return compiled;
}

/// The camera as it stands, its distances fixed, with the indices of another wavelength [m].
CameraSpec at_wavelength(const Camera& solved, double wavelength, const PositionMap& positions) {
  CameraSpec spec = solved.spec();
  spec.focus = {};
  spec.focus.mode = FocusMode::distance;
  spec.focus.lens_distance = solved.lens_distance();
  if (spec.array.present) {
    spec.array.measured_from = ArrayReference::vertex;
    spec.array.sensor_distance = solved.array_back() - solved.sensor();
  } else {
    spec.focus.conjugate = "sensor";
  }
  spec.wavelength = wavelength;
  set_indices(spec, wavelength, positions);
  return spec;
}

/// The scene with the same camera, or nullptr.
const CompiledScene* with_camera(const CameraSpec& camera, const EarlierScenes& earlier) {
  for (const CompiledScene* other : earlier)
    if (other && other->scene.camera == camera) return other;
  return nullptr;
}

/// Tells whether glasses refract alike in both cameras: pupils, which are costly, are the same
/// then.
bool have_same_indices(const CameraSpec& a, const CameraSpec& b) {
  const auto alike = [](const auto& x, const auto& y) { return x.index == y.index; };
  return std::equal(a.lens.surfaces.begin(), a.lens.surfaces.end(), b.lens.surfaces.begin(),
                    b.lens.surfaces.end(), alike) &&
         std::equal(a.array.types.begin(), a.array.types.end(), b.array.types.begin(),
                    b.array.types.end(), alike);
}

}  // namespace

CompiledScene compile(const Scene& given, const MediumLoader& loader, const Execution& execution,
                      const PositionMap& given_positions, const EarlierScenes& earlier,
                      const std::vector<IssueCode>& unsaid) {
  auto [scene, positions] = for_camera(SceneDocument{given, given_positions});
  if (changes_with_time(scene)) {
    scene = first_moment(scene, positions);
    execution.note("the scene changes with time; this is its first frame");
  }
  read_curves(scene, folder_of(scene), positions);
  set_indices(scene, positions);
  for (const SceneIssue& issue : validate(scene, positions))
    if (std::find(unsaid.begin(), unsaid.end(), issue.code) == unsaid.end())
      execution.warn(to_string(issue));
  const SpectralNodes nodes = spectral_nodes(scene, positions);
  constexpr double kTellingError = 1e-3;
  if (nodes.error > kTellingError)
    execution.warn(fmt::format(
        "the radiance of the channels has an error of {:.2g} %: a response is too narrow or a "
        "spectrum too steep for the sampled wavelengths; split the channel into bands",
        100 * nodes.error));
  if (nodes.sources.front().wavelength() > 0)
    scene.camera.wavelength = nodes.sources.front().wavelength();
  const CompiledScene* const same = with_camera(scene.camera, earlier);
  // Warnings of a camera are among those of validate().
  Camera camera = same ? same->camera : Camera(scene.camera);
  PupilSampling pupils = same ? same->pupils : PupilSampling(camera, execution);
  const Compilation whole{scene, positions, loader, execution, earlier};
  const Flames flames = load_flames(whole, nodes.sources);
  check_flames_beside_windows(scene, flames.bright, positions);
  CompiledScene compiled = compile_content(whole, std::move(camera), std::move(pupils), flames,
                                           nodes.sources, nodes.emitters);
  if (compiled.surfaces) {
    check_camera_outside(compiled, positions, execution);
    warn_of_lights_inside(compiled, positions, execution);
  }
  check_surfaces_beside_windows(compiled, positions);
  compiled.mix = nodes.mix;
  compiled.part_mixes = nodes.part_mixes;
  compiled.spectral_error = nodes.error;
  warn_of_short_steps(compiled, execution);
  if (!is_dispersive(scene)) return compiled;
  Execution quiet = execution;  // the same warnings once are enough
  quiet.message = {};
  for (std::size_t n = 0; n < nodes.sources.size(); ++n) {
    const double wavelength = nodes.sources[n].wavelength();
    Scene part = scene;
    const int channel =
        nodes.mix.empty() ? static_cast<int>(n) : nodes.mix.channel_of(static_cast<int>(n));
    part.channels = {scene.channels[static_cast<std::size_t>(channel)]};
    part.camera = at_wavelength(compiled.camera,
                                wavelength > 0 ? wavelength : design_wavelength(scene), positions);
    set_indices(part.windows, part.camera.wavelength, positions);
    EarlierScenes earlier_parts;
    for (const CompiledScene* other : earlier)
      if (other && n < other->dispersed.size()) earlier_parts.push_back(&other->dispersed[n]);
    const CompiledScene* const same_part = with_camera(part.camera, earlier_parts);
    Camera part_camera = same_part ? same_part->camera : Camera(part.camera);
    PupilSampling part_pupils = same_part ? same_part->pupils
                                : have_same_indices(part.camera, compiled.camera.spec())
                                    ? compiled.pupils
                                    : PupilSampling(part_camera, quiet);
    const Compilation one{part, positions, loader, quiet, earlier_parts};
    Flames part_flames = flames_of_channel(one, flames, static_cast<int>(n), nodes.sources[n]);
    compiled.dispersed.push_back(compile_content(one, std::move(part_camera),
                                                 std::move(part_pupils), std::move(part_flames),
                                                 {nodes.sources[n]}, {nodes.emitters[n]}));
    compiled.dispersed.back().film_channel = {channel};
    for (const ChannelMix& mix : nodes.part_mixes)
      compiled.dispersed.back().part_mixes.emplace_back(
          1, std::vector<double>{mix.weight(channel, static_cast<int>(n))});
  }
  return compiled;
}

CompiledScene compile(const SceneDocument& document, const MediumLoader& loader,
                      const Execution& execution, const EarlierScenes& earlier,
                      const std::vector<IssueCode>& unsaid) {
  return compile(document.scene, loader, execution, document.positions, earlier, unsaid);
}

void fill_with_light(CompiledScene& compiled) {
  const auto fill = [](CompiledScene& path, double radiance) {
    path.medium = make_uniform_medium(radiance, path.node_count());
    path.scatterers.clear();
  };
  fill(compiled, 1);
  for (CompiledScene& path : compiled.paths()) {
    // Each of several wavelengths that stand for a channel sees a share of its light.
    double sharing = 0;
    for (const CompiledScene& other : compiled.paths())
      sharing += other.film_channel == path.film_channel ? 1 : 0;
    fill(path, 1 / sharing);
  }
}

}  // namespace plenoflame
