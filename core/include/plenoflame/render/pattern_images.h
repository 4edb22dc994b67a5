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
/// microlens by microlens; images whose centroid is off the sensor are left out, and so are points
/// that other surfaces hide.
/// @param rays over the camera's aperture, for each point
/// @throws InputError when the scene has no such patterns, Cancelled when stopped
std::vector<PatternImage> pattern_images(const CompiledScene& scene, int rays,
                                         const Execution& execution);

/// A table with a line for each image, as CSV; lengths in m. Written under a temporary name and
/// renamed. @throws FileError
void write_pattern_images(const std::string& path, const CompiledScene& scene,
                          const std::vector<PatternImage>& images);

}  // namespace plenoflame
