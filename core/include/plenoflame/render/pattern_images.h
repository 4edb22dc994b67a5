#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/render/point_images.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// The image of one point of a calibration pattern through one microlens, by exact rays.
struct PatternImage {
  PatternPoint point;
  Vec3 in_camera;  ///< [m] the point in the camera's frame
  PointImage image;
};

/// The images of all points of the scene's checkerboards and dot grids, in the order of the scene,
/// microlens by microlens. Images whose centroid is off the sensor are left out. Points that other
/// surfaces hide are left out, too.
/// @param rays over the camera's aperture, for each point
/// @throws InputError when the scene has no such patterns, Cancelled when stopped
std::vector<PatternImage> pattern_images(const CompiledScene& scene, int rays,
                                         const Execution& execution);

/// Writes a CSV table with a line for each image; lengths in m. The file has a temporary name until
/// it is complete. @throws FileError
void write_pattern_images(const std::string& path, const CompiledScene& scene,
                          const std::vector<PatternImage>& images);

}  // namespace plenoflame
