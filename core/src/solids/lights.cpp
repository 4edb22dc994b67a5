#include "plenoflame/solids/lights.h"

#include <cmath>

#include "plenoflame/base/constants.h"

namespace plenoflame {

double DeltaLight::solid_angle() const {
  return 2 * constants::pi * versine;
}

Lights compile_lights(const std::vector<LightSpec>& specs,
                      const std::vector<SourceFunction>& channels) {
  Lights lights;
  const SourceFunction all = SourceFunction::total();
  for (const LightSpec& spec : specs) {
    const auto share = [&](const SourceFunction& channel) {
      return spec.temperature > 0 ? channel(spec.temperature) / all(spec.temperature)
                                  : channel.share();
    };
    if (spec.kind == LightKind::environment) {
      lights.environment.resize(channels.size());
      for (std::size_t c = 0; c < channels.size(); ++c)
        lights.environment[c] += spec.radiance * share(channels[c]);
      continue;
    }
    DeltaLight light;
    light.parallel = spec.kind == LightKind::parallel;
    light.position = spec.position;
    light.direction = normalize(spec.direction);
    if (spec.cone > 0) {
      // 1 - cos x = 2 sin^2(x / 2), with x half the full angle.
      const double sine = std::sin(0.25 * spec.cone);
      light.versine = 2 * sine * sine;
    }
    const double strength = light.parallel ? spec.irradiance : spec.power / light.solid_angle();
    for (const SourceFunction& channel : channels)
      light.strength.push_back(strength * share(channel));
    lights.delta.push_back(std::move(light));
  }
  return lights;
}

}  // namespace plenoflame
