#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/radiometry/absorption_spectrum.h"
#include "plenoflame/radiometry/channel_mix.h"
#include "plenoflame/radiometry/emission_line.h"
#include "plenoflame/radiometry/source_function.h"
#include "plenoflame/scene/scene.h"
#include "plenoflame/scene/scene_file.h"

/// From what a scene says about wavelengths to what computes with them.
namespace plenoflame {

/// The response of a channel; nothing for all wavelengths. A curve must have its points. The
/// camera's filter is not in it.
/// @throws InputError for impossible values
std::optional<SpectralResponse> spectral_response(const ChannelSpec& channel);

/// The same behind the camera's filter and a filter over a part of the pupil (points as text;
/// empty: none).
/// @throws InputError when they let nothing through
std::optional<SpectralResponse> camera_response(const Scene& scene, const ChannelSpec& channel,
                                                const std::string& pupil_filter = {});

/// Wavelengths [m] of the photons of the scene's channels; 0: all. @throws as camera_response()
std::vector<double> channel_wavelengths(const Scene& scene);

/// The source function of a channel as a whole. @throws as spectral_response
SourceFunction source_function(const ChannelSpec& channel);

/// Reads the curves that are in files, so that the scene is complete.
/// @param folder of the scene file; empty: the current one
/// @throws FileError, InputError with the place of the file's name
void read_curves(Scene& scene, const std::string& folder, const PositionMap& positions = {});

/// The dependence of a flame's absorption on wavelength. @throws InputError
AbsorptionSpectrum absorption_spectrum(const SpectrumSpec& spec);

/// On a flame's absorption in each channel of its medium; empty when it is grey.
/// @throws InputError where the spectrum is not known, or a channel has all wavelengths
std::vector<double> absorption_factors(const SpectrumSpec& spec,
                                       const std::vector<SourceFunction>& channels);

/// The word of scene files for a kind of line.
std::string_view line_word(LineKind kind);

/// @throws InputError for a custom line without a wavelength, or one that is too wide
EmissionLine emission_line(const LineSpec& spec);

/// The weight of each emission line in each channel of a flame's medium: channel c and line l at [c
/// * lines + l].
/// @throws InputError as emission_line
std::vector<double> line_weights(const FlameSpec& flame,
                                 const std::vector<SourceFunction>& channels);

/// Absorption of a layer [1/m], from its soot where it is given by that.
double layer_absorption(const EllipsoidSpec& layer, const SpectrumSpec& spec);

/// Tells whether the camera's optics depend on the wavelength. They do if its surfaces are coated,
/// or if a glass of it or of a window disperses (by more than 1e-9 between the channels).
bool is_dispersive(const Scene& scene);

/// The channels of media. A grey absorption needs one node per channel; others need several
/// wavelengths per channel. Emission lines belong to a channel's only node. If wavelengths differ
/// in absorption or in their way through the camera, lines have their own nodes. In a scene with
/// nothing but flames without lines, channels share wavelengths if this makes fewer.
struct SpectralNodes {
  std::vector<SourceFunction> sources;
  /// The light of surfaces and lights in them: exact for every channel as a whole, at any
  /// temperature (SourceFunction::sharing).
  std::vector<SourceFunction> emitters;
  ChannelMix mix;    ///< empty: the nodes are the channels
  double error = 0;  ///< stated error of the quadrature (radiometry/spectral_nodes.h)
  /// With filters over parts of the pupil, the mix of each of PupilFilters::parts(); `mix` is
  /// their mean over the stop.
  std::vector<ChannelMix> part_mixes = {};
};
/// If filters cover parts of the pupil, each part has nodes of its own.
/// @throws InputError naming the channel
SpectralNodes spectral_nodes(const Scene& scene, const PositionMap& positions = {});

}  // namespace plenoflame
