#pragma once
#include <cstddef>
#include <vector>

#include "render/forward/forward_surfaces.h"

namespace plenoflame {

/// The arrays for tracing one chunk of bundles.
struct SurfaceBundles::Work {
  Work(const Medium* medium, const MediumOptions& options, std::size_t channel_count)
      : channels(channel_count), segments(medium, options), emission(channel_count) {}
  std::size_t channels;
  MediumSegments segments;
  std::vector<double> emission;
  std::vector<double> spectra;  ///< one value per channel for each bundle
  /// Weights of bundles that media scatter: the density of their paths with each node as the hero
  /// wavelength, over the mean of all nodes.
  std::vector<double> shares;
  std::vector<Camera::Arrival> arrivals;
  std::vector<Arrived> arrived;
  std::vector<Ray> ways;     ///< stretches in air of the arrivals, from their last event
  std::vector<double> ends;  ///< [m] ends of these stretches
  WindowPath path;
};

}  // namespace plenoflame
