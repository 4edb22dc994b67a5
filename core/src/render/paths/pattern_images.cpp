#include "plenoflame/render/pattern_images.h"

#include <fmt/format.h>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame {
namespace {

std::vector<PatternImage> images_of(const CompiledScene& scene, const PatternPoint& point,
                                    int rays) {
  const LightStop stopped = [&](Vec3 direction, double end) {
    return scene.surfaces->occluded({point.point, direction}, 0, end, {point.surface, 0});
  };
  std::vector<PatternImage> images;
  const Vec3 in_camera = scene.camera.to_world().inverse().point(point.point);
  for (const PointImage& image : point_images(scene.camera, point.point, rays, stopped))
    images.push_back({point, in_camera, image});
  return images;
}

}  // namespace

std::vector<PatternImage> pattern_images(const CompiledScene& scene, int rays,
                                         const Execution& execution) {
  const std::vector<PatternPoint> points =
      scene.surfaces ? scene.surfaces->pattern_points() : std::vector<PatternPoint>{};
  if (points.empty())
    throw InputError(
        "the scene has no checkerboard or dot grid: give a plane or disc a texture of kind "
        "\"checkerboard\" or \"dots\"");
  std::vector<std::vector<PatternImage>> found(points.size());
  if (!parallel_for(execution, points.size(),
                    [&](std::size_t i, int) { found[i] = images_of(scene, points[i], rays); }))
    throw Cancelled();
  std::vector<PatternImage> images;
  for (const auto& part : found) images.insert(images.end(), part.begin(), part.end());
  return images;
}

void write_pattern_images(const std::string& path, const CompiledScene& scene,
                          const std::vector<PatternImage>& images) {
  std::string text =
      "surface,name,column,row,x_m,y_m,z_m,camera_x_m,camera_y_m,camera_z_m,lens_q,lens_r,type,"
      "image_column,image_row,spread_pixels,share\n";
  for (const auto& [point, in_camera, image] : images) {
    std::string name = scene.scene.surfaces[static_cast<std::size_t>(point.surface)].name;
    for (char& c : name)
      if (c == '"' || c == '\n' || c == '\r') c = '\'';
    const Vec3 p = point.point, q = in_camera;
    text +=
        fmt::format("{},\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", point.surface, name,
                    point.column, point.row, p.x, p.y, p.z, q.x, q.y, q.z, image.lens.q,
                    image.lens.r, image.type, image.column, image.row, image.spread, image.share);
  }
  write_file(path, text);
}

}  // namespace plenoflame
