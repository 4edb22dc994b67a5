#include "plenoflame/optics/lens_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "optics/reflection.h"
#include "optics/surface_kernel.h"
#include "optics/surface_kinds.h"

namespace plenoflame {

std::string to_string(RayStatus status) {
  switch (status) {
    case RayStatus::vignetted:
      return "vignetted";
    case RayStatus::total_internal_reflection:
      return "total internal reflection";
    case RayStatus::missed:
      return "missed";
    case RayStatus::reached:
      break;
  }
  return "reached";
}

LensSystem::LensSystem(std::vector<SurfaceSpec> surfaces, double first_vertex)
    : surfaces_(std::move(surfaces)) {
  double z = first_vertex;
  for (const SurfaceSpec& surface : surfaces_) {
    vertices_.push_back(z);
    z -= surface.thickness;
  }
}

TraceStatus LensSystem::trace_to_scene(Ray& ray, std::vector<Vec3>* path,
                                       PassedLight* passed) const {
  return trace(ray, true, path, passed);
}

TraceStatus LensSystem::trace_to_sensor(Ray& ray, std::vector<Vec3>* path,
                                        PassedLight* passed) const {
  return trace(ray, false, path, passed);
}

TraceStatus LensSystem::trace(Ray& ray, bool to_scene, std::vector<Vec3>* path,
                              PassedLight* passed) const {
  // The kernel propagates towards +z: mirror z for rays towards the sensor.
  const double sign = to_scene ? 1.0 : -1.0;
  const int count = static_cast<int>(surfaces_.size());
  Vec3 p = ray.origin, d = ray.direction;
  d.z *= sign;
  for (int step = 0; step < count; ++step) {
    const int i = to_scene ? count - 1 - step : step;
    const SurfaceSpec& surface = surfaces_[static_cast<std::size_t>(i)];
    const double vertex = vertices_[static_cast<std::size_t>(i)];
    const double index_scene_side = i > 0 ? surfaces_[static_cast<std::size_t>(i) - 1].index : 1.0;
    const double before = to_scene ? surface.index : index_scene_side;
    const double behind = to_scene ? index_scene_side : surface.index;
    // radius > 0 has its centre on the sensor's side, which is behind for rays to the scene.
    const double curvature = (to_scene ? -1.0 : 1.0) / surface.radius;
    const double radius = 0.5 * surface.diameter;
    const KernelSurface<double> kernel{0.0, curvature, radius * radius, before / behind,
                                       (behind - before) * (behind + before) / (behind * behind)};
    double z = sign * (p.z - vertex);
    int code = 0;
    const Vec3 d_before = d;
    const KernelShape<double> shape = kernel_shape<double>(surface, to_scene);
    if (shape.kind != ShapeKind::sphere)
      scalar::refract_at_shape(kernel, shape, 4 * i, p.x, p.y, z, d.x, d.y, d.z, code);
    else
      scalar::refract_at(kernel, 4 * i, p.x, p.y, z, d.x, d.y, d.z, code);
    p.z = vertex + sign * z;
    if (path) path->push_back(p);
    if (code != 0) {
      ray = {p, {d.x, d.y, sign * d.z}};
      const int cause = code % 4;
      return {cause == kCauseVignetted         ? RayStatus::vignetted
              : cause == kCauseTotalReflection ? RayStatus::total_internal_reflection
                                               : RayStatus::missed,
              i};
    }
    if (passed && before != behind) {
      // By Snell's law before * d_before - behind * d is along the normal.
      const Vec3 along_normal = before * d_before - behind * d;
      const double cosine = std::fabs(dot(d_before, normalize(along_normal)));
      passed->share *= surface_transmission(
          coating_of({passed->coating_index, passed->coating_wavelength, passed->wavelength},
                     before, behind),
          std::min(cosine, 1.0));
    }
  }
  ray = {p, {d.x, d.y, sign * d.z}};
  return {};
}

}  // namespace plenoflame
