#pragma once
#include <cstddef>
#include <vector>

#include "render/forward/forward_surfaces.h"

namespace plenoflame {

/// The arrays with which one chunk of bundles is traced.
struct SurfaceBundles::Work {
  Work(const Medium* medium, const MediumOptions& options, std::size_t channel_count)
      : channels(channel_count), segments(medium, options), emission(channel_count) {}
  std::size_t channels;
  MediumSegments segments;
  std::vector<double> emission;
  std::vector<double> spectra;  ///< channels values for each bundle
  /// Shares of bundles that media scatter: the density with which each node as the driver
  /// would have drawn their ways, over the mean of all.
  std::vector<double> shares;
  std::vector<Camera::Arrival> arrivals;
  std::vector<Arrived> arrived;
  std::vector<Ray> ways;     ///< of what arrived, from where it last left; stretches in air
  std::vector<double> ends;  ///< [m] of these ways
  WindowPath window_path;
};

}  // namespace plenoflame
