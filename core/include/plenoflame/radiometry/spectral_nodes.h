#pragma once
#include <optional>
#include <vector>

#include "plenoflame/radiometry/absorption_spectrum.h"
#include "plenoflame/radiometry/channel_mix.h"
#include "plenoflame/radiometry/source_function.h"

namespace plenoflame {

/// Wavelengths that represent a channel whose light is absorbed differently at each of them.
struct ChannelNodes {
  std::vector<SourceFunction> nodes;
  /// Largest relative error of the radiance of a homogeneous path, found by comparison with
  /// hundreds of wavelengths. The range is 1000 to 2600 K, and optical thicknesses of 0 to 10 at
  /// the reference.
  double error = 0;
};

/// Limit of that error.
inline constexpr double kSpectralTolerance = 5e-4;

/// The fewest wavelengths that keep it below kSpectralTolerance: the Gauss rule of the channel's
/// response times Planck's function (docs/radiometry.md). One wavelength means the whole channel at
/// its effective wavelength.
/// @param response nothing: all wavelengths (0.15 to 300 um)
/// @param spectra of everything that absorbs
/// @param fewest wavelengths, even where fewer would do
ChannelNodes channel_nodes(const std::optional<SpectralResponse>& response,
                           const std::vector<AbsorptionSpectrum>& spectra, int fewest = 1);

/// Wavelengths that represent several channels together.
struct SharedNodes {
  std::vector<SourceFunction> nodes;
  ChannelMix mix;
  double error = 0;  ///< as of ChannelNodes, the largest of any channel
};

/// The fewest wavelengths that keep every channel's error below kSpectralTolerance. They are nodes
/// of the Gauss rule of the sum of all normalised responses. Each channel has its own weights,
/// which integrate polynomials through a subset of the nodes exactly. The subset is one at which
/// all of its weights are positive.
/// @param most wavelengths
/// @return nothing if more are needed
std::optional<SharedNodes> shared_nodes(const std::vector<SpectralResponse>& responses,
                                        const std::vector<AbsorptionSpectrum>& spectra, int most);

}  // namespace plenoflame
