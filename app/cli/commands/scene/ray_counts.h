#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "plenoflame/base/report.h"

namespace plenoflame::cli {

/// Figures of a set of ray paths, as `rays` and `info` report them.
struct RayCounts {
  std::size_t rays = 0, vertices = 0;
  std::size_t of_images = 0;               ///< drawn for a pixel, of whose light they carry a share
  std::array<std::size_t, 4> by_status{};  ///< in the order of RayStatus
  std::vector<std::string> channels;
  std::vector<double> flux;  ///< [W] per channel: sum of weight times radiance
};

/// Adds a line for each figure.
void report_ray_counts(const RayCounts& counts, Report& report);

/// Counts a .csv or .json that `rays` wrote. @throws InputError when it is none, with the line
RayCounts count_rays_of_csv(const std::string& path);
RayCounts count_rays_of_json(const std::string& path);

}  // namespace plenoflame::cli
