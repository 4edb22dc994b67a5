#include "plenoflame/render/projections.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/lightfield/ground_truth.h"

namespace plenoflame {

std::vector<PointProjection> project_points(const Camera& camera, const std::vector<Vec3>& points,
                                            int rays, const Execution& execution) {
  std::vector<PointProjection> all;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 point = points[i];
    if (!(camera.to_world().inverse().point(point).z > 0))
      throw InputError(fmt::format("point {} at {}, {}, {} m is not in front of the camera", i,
                                   point.x, point.y, point.z));
    std::map<std::pair<int, int>, PointProjection> found;  // by r, then q
    const auto of = [&](LensIndex lens) -> PointProjection& {
      PointProjection& projection = found[{lens.r, lens.q}];
      projection.point = i;
      projection.lens = lens;
      return projection;
    };
    const double share = 1 / static_cast<double>(points.size());
    for (const PointTruth& image : project_point(
             camera, point, part_of_progress(execution, static_cast<double>(i) * share, share))) {
      PointProjection& projection = of(image.lens);
      projection.type = image.type;
      projection.chief = image.pixel;
    }
    for (const PointImage& image : point_images(camera, point, rays)) {
      PointProjection& projection = of(image.lens);
      projection.type = std::max(0, image.type);
      projection.light = image;
    }
    for (const auto& [lens, projection] : found) all.push_back(projection);
  }
  return all;
}

}  // namespace plenoflame
