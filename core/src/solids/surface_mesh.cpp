#include "plenoflame/solids/surface_mesh.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/constants.h"
#include "solids/mesh.h"
#include "solids/shapes.h"
#include "solids/texture.h"
#include "solids/triangle_mesh.h"

namespace plenoflame {
namespace {

/// Builds the mesh of an analytic shape, part by part, in the shape's own frame.
class Builder {
 public:
  Builder(const SolidSurfaceSpec& spec, const std::string& folder,
          const SurfaceMeshSettings& settings)
      : spec_(spec),
        settings_(settings),
        shape_(spec),
        to_world_{rotation_xyz(spec.rotation), spec.position},
        texture_(spec.material.texture, spec.material.reflectivity, folder) {}

  SurfaceMesh build() {
    const double r = spec_.radius, h = spec_.height;
    const bool plain = spec_.material.texture.kind == TextureKind::none;
    const int around = plain ? settings_.around : std::max(settings_.around, settings_.across);
    const int along = plain ? 1 : settings_.across;
    const auto angle = [](double u) { return 2 * constants::pi * u; };
    switch (spec_.shape) {
      case SolidShape::sphere:
        add(0, around, plain ? std::max(2, settings_.around / 2) : settings_.across,
            [&](double u, double v) {
              const double height = constants::pi * (v - 0.5), ring = r * std::cos(height);
              return Vec3{ring * std::cos(angle(u)), ring * std::sin(angle(u)),
                          r * std::sin(height)};
            });
        break;
      case SolidShape::cylinder:
        add(0, around, along, [&](double u, double v) {
          return Vec3{r * std::cos(angle(u)), r * std::sin(angle(u)), h * v};
        });
        if (spec_.caps) {
          add_disc(1, 0, -1);
          add_disc(2, h, 1);
        }
        break;
      case SolidShape::cone:
        // Not quite to the tip, where the cone has no normal.
        add(0, around, plain ? 8 : along, [&](double u, double v) {
          const double height = std::min(v, 1 - 1e-6), ring = r * (1 - height);
          return Vec3{ring * std::cos(angle(u)), ring * std::sin(angle(u)), h * height};
        });
        if (spec_.caps) add_disc(1, 0, -1);
        break;
      case SolidShape::disc:
        add_disc(0, 0, 1);
        break;
      case SolidShape::plane:
        add_plane(along);
        break;
      case SolidShape::box:
        add_box(along);
        break;
      case SolidShape::mesh:
        break;
    }
    return std::move(mesh_);
  }

 private:
  /// A grid of points place(u, v), u and v from 0 to 1, counterclockwise seen from the front.
  template <class Place>
  void add(int part, int columns, int rows, const Place& place) {
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (int j = 0; j <= rows; ++j)
      for (int i = 0; i <= columns; ++i) {
        const Vec3 world =
            to_world_.point(place(static_cast<double>(i) / columns, static_cast<double>(j) / rows));
        mesh_.vertices.push_back(world);
        mesh_.normals.push_back(shape_.normal(part, world));
      }
    const auto width = static_cast<std::uint32_t>(columns) + 1;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        const std::uint32_t a =
            first + static_cast<std::uint32_t>(j) * width + static_cast<std::uint32_t>(i);
        const Vec3 middle = to_world_.point(place((i + 0.5) / columns, (j + 0.5) / rows));
        const auto value =
            static_cast<float>(texture_.reflectivity(shape_.coordinates(part, middle)));
        for (const std::array<std::uint32_t, 3>& triangle :
             {std::array{a, a + 1, a + 1 + width}, std::array{a, a + 1 + width, a + width}})
          if (has_area(triangle)) {
            mesh_.triangles.push_back(triangle);
            mesh_.reflectivity.push_back(value);
          }
      }
  }
  /// At the poles of a sphere and at the tip of a cone the quadrilaterals are triangles.
  bool has_area(const std::array<std::uint32_t, 3>& t) const {
    const auto& v = mesh_.vertices;
    const Vec3 a = v[t[1]] - v[t[0]], b = v[t[2]] - v[t[0]];
    return length(cross(a, b)) > 1e-9 * (dot(a, a) + dot(b, b));
  }

  void add_disc(int part, double z, double front) {
    const bool plain = spec_.material.texture.kind == TextureKind::none;
    add(part, settings_.around, plain ? 1 : settings_.across / 2, [&](double u, double v) {
      // From the rim to the middle, or its reverse, so that the front is the front.
      const double radius = spec_.radius * (front > 0 ? 1 - v : v);
      const double at = 2 * constants::pi * u;
      return Vec3{radius * std::cos(at), radius * std::sin(at), z};
    });
  }

  void add_plane(int pieces) {
    double x = 0.5 * spec_.extent.x, y = 0.5 * spec_.extent.y;
    Vec3 middle;
    const Vec3 near = to_world_.inverse().point(settings_.endless_near);
    if (std::isinf(x)) {
      x = 0.5 * settings_.endless;
      middle.x = near.x;
    }
    if (std::isinf(y)) {
      y = 0.5 * settings_.endless;
      middle.y = near.y;
    }
    add(0, pieces, pieces, [&](double u, double v) {
      return middle + Vec3{(2 * u - 1) * x, (2 * v - 1) * y, 0};
    });
  }

  void add_box(int pieces) {
    const Vec3 half = 0.5 * spec_.size;
    for (int part = 0; part < 6; ++part) {
      const int axis = part / 2;
      const double sign = part % 2 == 0 ? -1 : 1;
      add(part, pieces, pieces, [&](double u, double v) {
        const double a = sign * (2 * u - 1), b = 2 * v - 1;
        // (axis, first, second) is right-handed.
        const Vec3 p = axis == 0   ? Vec3{sign, a, b}
                       : axis == 1 ? Vec3{b, sign, a}
                                   : Vec3{a, b, sign};
        return Vec3{half.x * p.x, half.y * p.y, half.z * (1 + p.z)};
      });
    }
  }

  const SolidSurfaceSpec& spec_;
  const SurfaceMeshSettings& settings_;
  Shape shape_;
  RigidTransform to_world_;
  Texture texture_;
  SurfaceMesh mesh_;
};

SurfaceMesh file_mesh(const SolidSurfaceSpec& spec, const std::string& folder,
                      const Execution& execution) {
  const std::string path =
      folder.empty() || spec.file.starts_with('/') ? spec.file : folder + "/" + spec.file;
  const RigidTransform to_world{rotation_xyz(spec.rotation), spec.position};
  const TriangleMesh placed(read_mesh(path, "surface", execution), to_world, spec.file_unit,
                            spec.position);
  const Texture texture(spec.material.texture, spec.material.reflectivity, folder);
  SurfaceMesh mesh;
  for (std::uint32_t k = 0; k < placed.triangles().size(); ++k) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    Vec3 middle;
    for (const std::uint32_t corner : placed.triangles()[k]) {
      const TriangleMesh::Vertex& v = placed.vertices()[corner];
      const Vec3 p{static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
      middle = middle + (1.0 / 3) * p;
      mesh.vertices.push_back(spec.position + p);
      mesh.normals.push_back(placed.normal(k));
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    const Vec2 uv = placed.texture_at(k, middle);
    const Vec2 size = spec.material.texture.size;
    mesh.reflectivity.push_back(
        static_cast<float>(texture.reflectivity({(uv.x - 0.5) * size.x, (uv.y - 0.5) * size.y})));
  }
  return mesh;
}

}  // namespace

SurfaceMesh surface_mesh(const SolidSurfaceSpec& spec, const std::string& folder,
                         const SurfaceMeshSettings& settings, const Execution& execution) {
  SurfaceMesh mesh = spec.shape == SolidShape::mesh ? file_mesh(spec, folder, execution)
                                                    : Builder(spec, folder, settings).build();
  if (spec.material.kind != MaterialKind::lambertian)
    std::fill(mesh.reflectivity.begin(), mesh.reflectivity.end(), 0.0F);
  return mesh;
}

}  // namespace plenoflame
