#include "plenoflame/scene/pupil_transmission.h"

#include <optional>

#include "plenoflame/base/error.h"
#include "plenoflame/camera/pupil_filters.h"
#include "plenoflame/scene/spectral.h"

namespace plenoflame {
namespace {

constexpr double kTypical = 1700;  ///< [K] of soot in flames

using Response = std::optional<SpectralResponse>;  ///< nothing: all wavelengths

SourceFunction source_of(const Response& response) {
  return response ? SourceFunction::of(*response) : SourceFunction::total();
}

/// Nothing where the filter is dark for the channel.
std::optional<Response> behind(const Scene& scene, const ChannelSpec& channel,
                               const std::string& filter) {
  try {
    return camera_response(scene, channel, filter);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// The light that is counted of all lines of the flames.
double light_of_lines(const Scene& scene, const Response& response) {
  double sum = 0;
  for (const FlameSpec& flame : scene.flames)
    for (const LineSpec& line : flame.lines) sum += emission_line(line).seen_by(response);
  return sum;
}

}  // namespace

std::vector<double> pupil_transmission(const Scene& scene, std::size_t channel) {
  const PupilFilters filters(scene.camera.pupil_filters);
  std::vector<double> shares(static_cast<std::size_t>(filters.parts()), 1.0);
  if (filters.empty()) return shares;
  const ChannelSpec& own = scene.channels.at(channel);
  const Response open = camera_response(scene, own);
  const double lines = light_of_lines(scene, open);
  for (std::size_t p = 0; p < filters.filters().size(); ++p) {
    const std::string& curve = filters.filters()[p].transmission;
    if (curve.empty()) continue;
    const std::optional<Response> response = behind(scene, own, curve);
    if (!response)
      shares[p] = 0;
    else if (lines > 0)
      shares[p] = light_of_lines(scene, *response) / lines;
    else
      shares[p] = source_of(*response)(kTypical) / source_of(open)(kTypical);
  }
  return shares;
}

}  // namespace plenoflame
