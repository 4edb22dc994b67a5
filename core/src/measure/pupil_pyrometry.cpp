#include "plenoflame/measure/pupil_pyrometry.h"

#include <algorithm>

#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"
#include "plenoflame/lightfield/pupil_views.h"
#include "plenoflame/scene/spectral.h"

namespace plenoflame {

PupilPyrometry pupil_pyrometry(const LightField& field, const Scene& scene, std::size_t channel,
                               const std::string (&filters)[2], const AbsorptionSpectrum& law,
                               const PyrometrySettings& settings) {
  if (field.unit != "W" && field.unit != "e-" && field.unit != "DN")
    throw InputError(
        "filters take the flux of render or the electrons of develop; this light field holds " +
        field.unit);
  check_raw_image(field, scene.camera, "the light field");
  LightField light;
  light.sensor_width = field.sensor_width;
  light.sensor_height = field.sensor_height;
  light.window = field.window;
  LightFieldChannel own[2] = {light_in_proportion(field, scene, channel), {}};
  own[1].flux = own[0].flux;
  PupilPyrometry result;
  result.left_out = leave_out_bad_pixels(field, scene.camera.sensor.mosaic, channel, channel, own);
  light.channels = {std::move(own[0])};
  const MicroImages micro{Camera(scene.camera)};
  const std::vector<PupilView> views = extract_pupil_views(light, micro);
  const PupilView* seen[2];
  std::optional<SpectralResponse> response[2];
  for (int k = 0; k < 2; ++k) {
    const auto found = std::find_if(views.begin(), views.end(), [&](const PupilView& view) {
      return view.filter == filters[k];
    });
    if (found == views.end()) {
      std::string names;
      for (const PupilView& view : views) names += (names.empty() ? "" : ", ") + view.filter;
      throw mended_by(
          UsageError("the camera has no pupil filter '" + filters[k] + "'; it has: " + names),
          {"filters"});
    }
    seen[k] = &*found;
    const auto number = static_cast<std::size_t>(found - views.begin());
    response[k] = camera_response(scene, scene.channels.at(channel),
                                  scene.camera.pupil_filters[number].transmission);
    if (!response[k])
      throw InputError("pupil filter '" + filters[k] +
                       "' has no transmission curve, and the channel has all wavelengths; give one "
                       "of them a band");
    result.pixels[k] = found->pixels;
  }
  const TwoColour two(*response[0], *response[1], law);
  result.map = two_colour_map(seen[0]->light, seen[1]->light, two, settings);
  LightField& picture = result.picture;
  picture.sensor_width = result.map.temperature.width;
  picture.sensor_height = result.map.temperature.height;
  picture.window = {0, 0, picture.sensor_width, picture.sensor_height};
  picture.channels = {{"temperature", result.map.temperature, result.map.standard_error}};
  picture.unit = "K";
  picture.estimator = field.estimator;
  picture.seed = field.seed;
  picture.samples = field.samples;
  picture.complete = field.complete;
  picture.version = field.version;
  picture.texts["pyrometry.filters"] = filters[0] + "," + filters[1];
  return result;
}

}  // namespace plenoflame
