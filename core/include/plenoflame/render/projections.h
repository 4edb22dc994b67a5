#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/render/point_images.h"

namespace plenoflame {

/// The two images of a point through one microlens.
struct PointProjection {
  std::size_t point = 0;  ///< its number
  LensIndex lens;
  int type = 0;               ///< of the microlens
  std::optional<Vec2> chief;  ///< column, row: of the ray through its middle, where that arrives
  std::optional<PointImage> light;  ///< of all light
};

/// Projects points of the world through all microlenses that see them. The images are ordered by
/// point, then by r, then by q. @param rays over the aperture for the centroids, for each point
/// @throws InputError with the number of a point that is not in front of the camera, Cancelled
std::vector<PointProjection> project_points(const Camera& camera, const std::vector<Vec3>& points,
                                            int rays, const Execution& execution);

}  // namespace plenoflame
