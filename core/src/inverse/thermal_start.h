#pragma once
#include <cstddef>
#include <vector>

#include "plenoflame/image/image.h"
#include "plenoflame/inverse/row_noise.h"
#include "plenoflame/inverse/thermal_reconstruction.h"

namespace plenoflame {

/// Temperatures and absorptions that Gauss and Newton begin with.
struct ThermalStart {
  std::vector<double> temperature, absorption;
  std::vector<char> solved;  ///< 0: known to be empty
  /// Reconstruction::hidden of the first channel's light. Empty: there was no linear
  /// reconstruction.
  std::vector<double> hidden = {};
  RayError rays_error;     ///< of the first channel's rows
  std::size_t unseen = 0;  ///< unknowns that no ray meets
  /// The first linear reconstruction's; negative and empty: there was none.
  double strength = -1;
  std::vector<double> light_outside = {};
  /// Pictures of the first channels, as far as they were reconstructed: per view, at the first
  /// pixel of each row.
  std::vector<std::vector<Image>> explained = {};
  Reconstruction reached = {};  ///< where a stop came before the end of the linear reconstructions
  bool complete = true;
};

/// True if parts of the stop show the first channel in two colours.
bool has_two_colours(const ThermalInput& input);

/// By linear reconstructions, or what the input says. A stop leaves what the first one had reached.
/// @param share of the whole work that it is, for progress @throws InputError and Cancelled as
///        reconstruct()
ThermalStart thermal_start(const ThermalInput& input, const ThermalSettings& settings, double share,
                           const Execution& execution);

/// Each channel has rays of its own: errors of two channels for their finite number are as
/// independent as the weights take them to be.
/// @param number of the channel among those that are solved with @param channel of the scene
inline CameraRaySettings rays_of_channel(CameraRaySettings rays, std::size_t number, int channel) {
  rays.channel = channel;
  rays.seed += number;
  return rays;
}

}  // namespace plenoflame
