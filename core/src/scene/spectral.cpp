#include "plenoflame/scene/spectral.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "plenoflame/base/error.h"
#include "plenoflame/camera/pupil_filters.h"
#include "plenoflame/optics/glass.h"
#include "plenoflame/radiometry/filter_points.h"
#include "plenoflame/radiometry/spectral_nodes.h"
#include "plenoflame/scene/channel_kinds.h"
#include "scene/schema/schema_fields.h"

namespace plenoflame {
namespace {

SootIndex index_of(SootIndexSource source) {
  switch (source) {
    case SootIndexSource::chang:
      return SootIndex::chang;
    case SootIndexSource::dalzell:
      return SootIndex::dalzell;
    case SootIndexSource::constant:
      break;
  }
  return SootIndex::constant;
}

/// Every emission line of the flames, once.
std::vector<EmissionLine> lines_of(const Scene& scene) {
  std::vector<EmissionLine> lines;
  for (const FlameSpec& flame : scene.flames)
    for (const LineSpec& spec : flame.lines) {
      const EmissionLine line = emission_line(spec);
      if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
    }
  return lines;
}

}  // namespace

std::optional<SpectralResponse> spectral_response(const ChannelSpec& channel) {
  const std::optional<SpectralResponse> response = response_of_kind(channel);
  return response && channel.photons ? response->of_photons() : response;
}

std::vector<double> channel_wavelengths(const Scene& scene) {
  std::vector<double> wavelengths;
  for (const ChannelSpec& channel : scene.channels) {
    // A response to photons is normalised at the centroid of the curve itself.
    ChannelSpec plain = channel;
    plain.photons = false;
    const auto response =
        channel.photons ? spectral_response(plain) : camera_response(scene, channel);
    wavelengths.push_back(response ? response->centroid() : 0);
  }
  return wavelengths;
}

SourceFunction source_function(const ChannelSpec& channel) {
  if (channel.kind == ChannelKind::total) return SourceFunction::total();
  if (channel.kind == ChannelKind::band && !channel.photons)
    return SourceFunction::band(channel.wavelength, channel.width);
  return SourceFunction::of(*spectral_response(channel));
}

void read_curves(Scene& scene, const std::string& folder, const PositionMap& positions) {
  for (std::size_t i = 0; i < scene.channels.size(); ++i) {
    ChannelSpec& channel = scene.channels[i];
    if (channel.kind != ChannelKind::curve || !channel.curve.empty() || channel.file.empty())
      continue;
    const std::filesystem::path path = std::filesystem::path(folder) / channel.file;
    const SourcePosition named = positions.find("channels[" + std::to_string(i) + "].file");
    try {
      channel.curve = format_spectral_points(read_spectral_csv(path.string()));
    } catch (const FileError& error) {
      const std::string where = to_string(named);
      throw FileError(where.empty() ? error.what() : where + ": " + error.what());
    }
  }
}

AbsorptionSpectrum absorption_spectrum(const SpectrumSpec& spec) {
  switch (spec.kind) {
    case SpectrumKind::grey:
      break;
    case SpectrumKind::power:
      if (spec.exponent == 0) break;
      return AbsorptionSpectrum::power(spec.reference, spec.exponent);
    case SpectrumKind::soot:
      return AbsorptionSpectrum::soot(spec.reference, index_of(spec.index),
                                      spec.absorption_function);
    case SpectrumKind::table:
      return AbsorptionSpectrum::table(spec.reference, parse_spectral_points(spec.table));
  }
  return {};
}

std::vector<double> absorption_factors(const SpectrumSpec& spec,
                                       const std::vector<SourceFunction>& channels) {
  const AbsorptionSpectrum spectrum = absorption_spectrum(spec);
  if (spectrum.is_grey()) return {};
  std::vector<double> factors;
  for (const SourceFunction& channel : channels) {
    if (channel.is_total())
      throw InputError(
          "a channel of all wavelengths cannot have an absorption that depends on wavelength; use "
          "a band or a line");
    factors.push_back(spectrum.factor(channel.wavelength()));
  }
  return factors;
}

std::string_view line_word(LineKind kind) {
  return schema::Words<LineKind>::list[static_cast<std::size_t>(kind)];
}

EmissionLine emission_line(const LineSpec& spec) {
  return spec.kind == LineKind::custom ? EmissionLine::at(spec.wavelength, spec.width)
                                       : EmissionLine::named(line_word(spec.kind), spec.width);
}

std::vector<double> line_weights(const FlameSpec& flame,
                                 const std::vector<SourceFunction>& channels) {
  std::vector<double> weights;
  for (const SourceFunction& channel : channels)
    for (const LineSpec& line : flame.lines)
      weights.push_back(channel.line_share(emission_line(line)));
  return weights;
}

double layer_absorption(const EllipsoidSpec& layer, const SpectrumSpec& spec) {
  return layer.volume_fraction > 0
             ? layer.volume_fraction * absorption_spectrum(spec).per_volume_fraction()
             : layer.absorption;
}

std::optional<SpectralResponse> camera_response(const Scene& scene, const ChannelSpec& channel,
                                                const std::string& pupil_filter) {
  std::optional<SpectralResponse> response = spectral_response(channel);
  for (const std::string& text : {scene.camera.transmission.filter, pupil_filter}) {
    if (text.empty()) continue;
    const std::vector<SpectralPoint> points = parse_filter_points(text);
    if (is_opaque(points)) throw InputError("the filter lets nothing through");
    const SpectralResponse filter = SpectralResponse::curve(points);
    // The filter leaves of all wavelengths those that it lets through.
    response = response ? response->behind(filter) : filter;
  }
  return response;
}

bool is_dispersive(const Scene& scene) {
  const TransmissionSpec& transmission = scene.camera.transmission;
  double shortest = 0, longest = 0;
  for (const ChannelSpec& channel : scene.channels) {
    const auto response = spectral_response(channel);
    if (!response) continue;
    const double at = response->centroid();
    const double low = channel.wavelengths > 1 ? response->shortest() : at;
    const double high = channel.wavelengths > 1 ? response->longest() : at;
    shortest = shortest > 0 ? std::min(shortest, low) : low;
    longest = std::max(longest, high);
  }
  if (!(longest > shortest)) return false;
  if (scene.camera.lens.model == LensModel::real && transmission.fresnel &&
      transmission.coating_index > 0)
    return true;
  const auto disperses = [&](const std::string& glass) {
    if (glass.empty()) return false;
    const Glass made(glass);
    return std::fabs(made.index(shortest) - made.index(longest)) > 1e-9;
  };
  for (const SurfaceSpec& surface : scene.camera.lens.surfaces)
    if (disperses(surface.glass)) return true;
  for (const WindowSpec& window : scene.windows)
    if (disperses(window.glass)) return true;
  if (scene.camera.array.present)
    for (const MicrolensSpec& type : scene.camera.array.types)
      if (disperses(type.glass)) return true;
  return false;
}

namespace {

/// Behind the filter of one part of the pupil. @param numbers of the channels in the scene's file
SpectralNodes nodes_behind(const Scene& scene, const std::string& pupil_filter,
                           const std::vector<std::size_t>& numbers, const PositionMap& positions) {
  std::vector<AbsorptionSpectrum> spectra;
  for (const FlameSpec& flame : scene.flames)
    spectra.push_back(absorption_spectrum(flame.spectrum));
  const bool grey = std::all_of(spectra.begin(), spectra.end(),
                                [](const AbsorptionSpectrum& s) { return s.is_grey(); });
  const bool filtered = !scene.camera.transmission.filter.empty() || !pupil_filter.empty();
  const bool dispersive = is_dispersive(scene);
  const std::vector<EmissionLine> lines = lines_of(scene);
  SpectralNodes all;
  std::vector<int> channel_of_node;
  std::vector<SpectralResponse> responses;
  // A channel's only node takes the light of lines as well, where it travels like the rest.
  const auto with_lines = [&](std::vector<SourceFunction> nodes,
                              const std::optional<SpectralResponse>& response) {
    std::vector<SourceFunction::LineShare> seen;
    for (const EmissionLine& line : lines)
      if (const double share = line.seen_by(response); share > 0) seen.push_back({line, share});
    if (seen.empty()) return nodes;
    if (grey && !dispersive) {
      nodes.front() = nodes.front().with_lines(std::move(seen));
      return nodes;
    }
    for (const SourceFunction::LineShare& one : seen)
      nodes.push_back(SourceFunction::of_lines(one.line.wavelength(), {one}));
    return nodes;
  };
  const auto add = [&](const SourceFunction& whole, const std::vector<SourceFunction>& nodes,
                       std::size_t thermal, std::size_t channel, double filter) {
    all.sources.insert(all.sources.end(), nodes.begin(), nodes.end());
    const auto split = nodes.begin() + static_cast<std::ptrdiff_t>(thermal);
    for (const SourceFunction& emitter : SourceFunction::sharing(whole, {nodes.begin(), split}))
      all.emitters.push_back(emitter.with_share(filter * emitter.share()));
    all.emitters.insert(all.emitters.end(), split, nodes.end());  // nothing but lines
    channel_of_node.insert(channel_of_node.end(), nodes.size(), static_cast<int>(channel));
  };
  for (std::size_t c = 0; c < scene.channels.size(); ++c) {
    const ChannelSpec& channel = scene.channels[c];
    if (grey && !filtered && !(dispersive && channel.wavelengths > 1)) {
      const SourceFunction whole = source_function(channel);
      add(whole, with_lines({whole}, spectral_response(channel)), 1, c, 1);
      continue;
    }
    try {
      const std::optional<SpectralResponse> response =
          camera_response(scene, channel, pupil_filter);
      if (response) responses.push_back(*response);
      const ChannelNodes nodes =
          channel_nodes(response, spectra, dispersive ? channel.wavelengths : 1);
      all.error = std::max(all.error, nodes.error);
      // Light of unknown spectrum loses the same share in the filter as white light.
      const std::optional<SpectralResponse> open = spectral_response(channel);
      add(response ? SourceFunction::of(*response) : SourceFunction::total(),
          with_lines(nodes.nodes, response), nodes.nodes.size(), c,
          open ? response->integral() / open->integral() : 1);
    } catch (const InputError& error) {
      throw InputError(positions.find("channels[" + std::to_string(numbers[c]) + "].kind"),
                       "channel \"" + channel.name + "\": " + error.what());
    }
  }
  if (all.sources.size() > scene.channels.size()) all.mix = ChannelMix::of_parts(channel_of_node);
  // Other sources emit into channels as a whole, and light that disperses has its own way.
  const bool only_flames = scene.surfaces.empty() && scene.lights.empty() && lines.empty();
  if (all.mix.empty() || !only_flames || dispersive || responses.size() < scene.channels.size())
    return all;
  const int fewer = all.mix.nodes() - 1;
  if (std::optional<SharedNodes> shared = shared_nodes(responses, spectra, fewer)) {
    all.sources = all.emitters = std::move(shared->nodes);
    all.mix = std::move(shared->mix);
    all.error = shared->error;
  }
  return all;
}

/// The channels of which a filter lets anything through.
std::vector<std::size_t> channels_behind(const Scene& scene, const std::string& pupil_filter) {
  std::vector<std::size_t> seen;
  for (std::size_t c = 0; c < scene.channels.size(); ++c) {
    try {
      static_cast<void>(camera_response(scene, scene.channels[c], pupil_filter));
      seen.push_back(c);
    } catch (const InputError&) {
      // None of its light is seen through this part, which is what filters in the pupil are for.
    }
  }
  return seen;
}

}  // namespace

SpectralNodes spectral_nodes(const Scene& scene, const PositionMap& positions) {
  std::vector<std::size_t> numbers(scene.channels.size());
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  const PupilFilters filters(scene.camera.pupil_filters);
  if (filters.empty()) return nodes_behind(scene, {}, numbers, positions);
  const std::vector<double> areas = filters.areas();
  const auto parts = static_cast<std::size_t>(filters.parts());
  constexpr double kNothing = 1e-5;  // of the stop: below the raster's resolution
  std::vector<SpectralNodes> of_part(parts);
  std::vector<std::vector<std::size_t>> seen(parts);
  SpectralNodes all;
  for (std::size_t p = 0; p < parts; ++p) {
    if (areas[p] < kNothing) continue;
    const std::string filter = p + 1 < parts ? filters.filters()[p].transmission : std::string();
    seen[p] = p + 1 < parts ? channels_behind(scene, filter) : numbers;
    if (seen[p].empty()) continue;
    Scene behind = scene;
    behind.channels.clear();
    for (const std::size_t c : seen[p]) behind.channels.push_back(scene.channels[c]);
    of_part[p] = nodes_behind(behind, filter, seen[p], positions);
    all.sources.insert(all.sources.end(), of_part[p].sources.begin(), of_part[p].sources.end());
    all.emitters.insert(all.emitters.end(), of_part[p].emitters.begin(), of_part[p].emitters.end());
    all.error = std::max(all.error, of_part[p].error);
  }
  // An opaque stop: rays have to look for something, of which nothing counts.
  if (all.sources.empty()) {
    const SpectralNodes open = nodes_behind(scene, {}, numbers, positions);
    all.sources = open.sources;
    all.emitters = open.emitters;
  }
  const std::size_t nodes = all.sources.size(), size = scene.channels.size() * nodes;
  std::vector<double> mean(size);
  std::size_t first = 0;
  for (std::size_t p = 0; p < parts; ++p) {
    const SpectralNodes& own = of_part[p];
    std::vector<double> weights(size);
    for (std::size_t c = 0; c < seen[p].size(); ++c)
      for (std::size_t n = 0; n < own.sources.size(); ++n) {
        const double weight = own.mix.empty()
                                  ? (c == n ? 1.0 : 0.0)
                                  : own.mix.weight(static_cast<int>(c), static_cast<int>(n));
        weights[seen[p][c] * nodes + first + n] = weight;
        mean[seen[p][c] * nodes + first + n] = areas[p] * weight;
      }
    all.part_mixes.emplace_back(static_cast<int>(scene.channels.size()), std::move(weights));
    first += own.sources.size();
  }
  all.mix = ChannelMix(static_cast<int>(scene.channels.size()), std::move(mean));
  return all;
}

}  // namespace plenoflame
