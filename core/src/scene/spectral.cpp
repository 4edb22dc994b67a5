#include "plenoflame/scene/spectral.h"

#include <algorithm>
#include <filesystem>

#include "plenoflame/base/error.h"
#include "plenoflame/radiometry/spectral_nodes.h"

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

}  // namespace

std::optional<SpectralResponse> spectral_response(const ChannelSpec& channel) {
  const auto made = [&]() -> std::optional<SpectralResponse> {
    switch (channel.kind) {
      case ChannelKind::total:
        break;
      case ChannelKind::band:
        return SpectralResponse::band(channel.wavelength, channel.width);
      case ChannelKind::line:
        return SpectralResponse::gaussian(channel.wavelength, channel.width);
      case ChannelKind::curve:
        return SpectralResponse::curve(parse_spectral_points(channel.curve));
      case ChannelKind::named:
        return SpectralResponse::named(channel.response);
    }
    return std::nullopt;
  };
  const std::optional<SpectralResponse> response = made();
  return response && channel.photons ? response->of_photons() : response;
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
      throw InputError("a channel of all wavelengths at once has no absorption that depends on it");
    factors.push_back(spectrum.factor(channel.wavelength()));
  }
  return factors;
}

double layer_absorption(const EllipsoidSpec& layer, const SpectrumSpec& spec) {
  return layer.volume_fraction > 0
             ? layer.volume_fraction * absorption_spectrum(spec).per_volume_fraction()
             : layer.absorption;
}

SpectralNodes spectral_nodes(const Scene& scene, const PositionMap& positions) {
  std::vector<AbsorptionSpectrum> spectra;
  for (const FlameSpec& flame : scene.flames)
    spectra.push_back(absorption_spectrum(flame.spectrum));
  const bool grey = std::all_of(spectra.begin(), spectra.end(),
                                [](const AbsorptionSpectrum& s) { return s.is_grey(); });
  SpectralNodes all;
  for (std::size_t c = 0; c < scene.channels.size(); ++c) {
    const ChannelSpec& channel = scene.channels[c];
    if (grey) {
      all.sources.push_back(source_function(channel));
      all.channel.push_back(static_cast<int>(c));
      continue;
    }
    try {
      const ChannelNodes nodes = channel_nodes(spectral_response(channel), spectra);
      all.error = std::max(all.error, nodes.error);
      for (const SourceFunction& node : nodes.nodes) {
        all.sources.push_back(node);
        all.channel.push_back(static_cast<int>(c));
      }
    } catch (const InputError& error) {
      throw InputError(positions.find("channels[" + std::to_string(c) + "].kind"),
                       "channel \"" + channel.name + "\": " + error.what());
    }
  }
  return all;
}

}  // namespace plenoflame
