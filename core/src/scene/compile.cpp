#include "plenoflame/scene/compile.h"

#include "plenoflame/base/error.h"
#include "plenoflame/media/layered_medium.h"

namespace plenoflame {

SourceFunction source_function(const ChannelSpec& channel) {
  return channel.kind == ChannelKind::total
             ? SourceFunction::total()
             : SourceFunction::band(channel.wavelength, channel.width);
}

std::unique_ptr<Medium> load_core_medium(const FlameSpec& flame, const std::string&,
                                         const std::vector<SourceFunction>& channels,
                                         const Execution&) {
  if (flame.kind != FlameKind::layered)
    throw InputError("flame \"" + flame.name +
                     "\" is an OpenVDB file; this program was built without OpenVDB");
  std::vector<EllipsoidLayer> layers;
  for (const EllipsoidSpec& layer : flame.layers)
    layers.push_back({layer.centre, layer.semi_axes, layer.temperature, layer.absorption});
  return make_layered_medium(std::move(layers), {rotation_xyz(flame.rotation), flame.position},
                             channels);
}

CompiledScene compile(const Scene& scene, const MediumLoader& loader, const Execution& execution) {
  std::vector<std::string> warnings;
  Camera camera(scene.camera, &warnings);
  for (const std::string& warning : warnings) execution.warn(warning);
  PupilSampling pupils(camera, execution);
  std::vector<SourceFunction> channels;
  for (const ChannelSpec& channel : scene.channels) channels.push_back(source_function(channel));
  const auto slash = scene.file.find_last_of('/');
  const std::string folder = slash == std::string::npos ? "" : scene.file.substr(0, slash);
  std::vector<std::unique_ptr<Medium>> media;
  for (const FlameSpec& flame : scene.flames)
    media.push_back(loader(flame, folder, channels, execution));
  std::unique_ptr<Medium> medium;
  if (media.size() == 1) medium = std::move(media.front());
  if (media.size() > 1) medium = make_composite_medium(std::move(media));
  return {scene, std::move(camera), std::move(pupils), std::move(medium)};
}

}  // namespace plenoflame
