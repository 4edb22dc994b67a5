#pragma once
#include <string>
#include <vector>

#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame {

/// The place of a micro-image, in pixels of the upright image: pixel (0, 0) has its centre at 0.5,
/// 0.5.
struct MicroImageTruth {
  LensIndex lens;
  int type = 0;
  Vec2 centre;        ///< column, row: of the ray through the middles of microlens and stop
  double radius = 0;  ///< of the stop's image
};

/// All micro-images that reach onto the sensor, ordered by r, then q.
std::vector<MicroImageTruth> micro_image_truth(const MicroImages& images);

/// Image of a point through one microlens: where the ray from it through the middle of the
/// microlens arrives.
struct PointTruth {
  LensIndex lens;
  int type = 0;
  Vec2 pixel;  ///< column, row
};

/// Projects a point of the world through every microlens whose middle light from it reaches, by
/// exact rays. Without array: where the ray through the middle of the paraxial exit pupil arrives,
/// for lens (0, 0). Empty when the point is not seen. A point that is far from sharp may be seen by
/// every microlens. @throws Cancelled
std::vector<PointTruth> project_point(const Camera& camera, Vec3 world,
                                      const Execution& execution = {});

/// Adds six layers to a raw image, in world axes. The layers chief.x, .y, .z [m] are the point
/// where the chief ray of the pixel leaves the plane of the front vertex. The layers chief.dx, .dy,
/// .dz are its unit direction into the scene. The chief ray runs from the pixel's centre through
/// the middle of the microlens whose micro-image the pixel is in. NaN between micro-images.
/// @throws Cancelled
void add_chief_rays(const MicroImages& images, LightField& light_field,
                    const Execution& execution = {});

/// "q,r,type,column,row,radius" with a header, one line per micro-image; names of the types as
/// text.
std::string micro_image_csv(const std::vector<MicroImageTruth>& truth, const CameraSpec& camera);

}  // namespace plenoflame
