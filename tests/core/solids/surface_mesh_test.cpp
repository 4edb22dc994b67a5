#include "plenoflame/solids/surface_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "plenoflame/base/error.h"
#include "support/approx.h"
#include "support/temporary_folder.h"

namespace plenoflame::surface_mesh_test {
namespace {

using test::relative;

constexpr double kPi = 3.14159265358979323846;

SolidSurfaceSpec placed(SolidShape shape) {
  SolidSurfaceSpec spec;
  spec.shape = shape;
  spec.position = {1, -2, 0.5};
  spec.rotation = {0.3, -0.7, 1.1};
  spec.radius = 0.04;
  spec.height = 0.15;
  spec.extent = {0.2, 0.1};
  spec.size = {0.3, 0.2, 0.1};
  spec.material.reflectivity = 0.7;
  return spec;
}

struct Sums {
  double area = 0;    ///< [m^2]
  double volume = 0;  ///< [m^3] by the divergence theorem: negative when inside out
};
Sums sums_of(const SurfaceMesh& mesh, Vec3 about) {
  Sums sums;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - about, b = mesh.vertices[t[1]] - about,
               c = mesh.vertices[t[2]] - about;
    sums.area += 0.5 * length(cross(b - a, c - a));
    sums.volume += dot(a, cross(b, c)) / 6;
  }
  return sums;
}

// Areas and volumes of the bodies by their formulas; 256 sides of a polygon miss 1e-4 of a circle.
TEST(SurfaceMesh, HasTheBodiesAreasAndVolumes) {
  struct Case {
    SolidShape shape;
    double area, volume;
  };
  const double r = 0.04, h = 0.15, slant = std::hypot(r, h);
  SurfaceMeshSettings fine;
  fine.around = 256;
  for (const Case& c : {Case{SolidShape::sphere, 4 * kPi * r * r, 4 * kPi / 3 * r * r * r},
                        Case{SolidShape::cylinder, 2 * kPi * r * (r + h), kPi * r * r * h},
                        Case{SolidShape::cone, kPi * r * (r + slant), kPi / 3 * r * r * h},
                        Case{SolidShape::box, 2 * (0.06 + 0.03 + 0.02), 0.006}}) {
    const SolidSurfaceSpec spec = placed(c.shape);
    const Sums sums = sums_of(surface_mesh(spec, "", fine), spec.position);
    EXPECT_TRUE(relative(sums.area, c.area, 1e-3)) << static_cast<int>(c.shape);
    EXPECT_TRUE(relative(sums.volume, c.volume, 1e-3)) << static_cast<int>(c.shape);
  }
  const double disc = sums_of(surface_mesh(placed(SolidShape::disc), "", fine), {}).area;
  EXPECT_TRUE(relative(disc, kPi * r * r, 1e-3));
  const double plane = sums_of(surface_mesh(placed(SolidShape::plane), "", fine), {}).area;
  EXPECT_TRUE(relative(plane, 0.02, 1e-9));
}

// The front of every triangle is where its vertices' normals point to.
TEST(SurfaceMesh, TrianglesFaceAsTheirNormals) {
  for (const SolidShape shape : {SolidShape::sphere, SolidShape::cylinder, SolidShape::cone,
                                 SolidShape::disc, SolidShape::plane, SolidShape::box}) {
    const SurfaceMesh mesh = surface_mesh(placed(shape), "");
    ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
    ASSERT_EQ(mesh.reflectivity.size(), mesh.triangles.size());
    for (const auto& t : mesh.triangles) {
      const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
      const Vec3 face = normalize(cross(b - a, c - a));
      for (const std::uint32_t corner : t)
        ASSERT_GT(dot(face, mesh.normals[corner]), 0.9) << static_cast<int>(shape);
    }
    for (const float value : mesh.reflectivity) ASSERT_EQ(value, 0.7F);
  }
}

// Half of a checkerboard with an even number of squares is dark; the board is half of the plane.
TEST(SurfaceMesh, ShowsTextures) {
  SolidSurfaceSpec spec = placed(SolidShape::plane);
  spec.extent = {0.16, 0.06};
  spec.material.texture.kind = TextureKind::checkerboard;
  spec.material.texture.dark = 0.1;
  spec.material.texture.cell = 0.01;
  spec.material.texture.columns = 8;
  spec.material.texture.rows = 6;
  SurfaceMeshSettings settings;
  settings.across = 96;  // a whole number of pieces in every square
  const SurfaceMesh mesh = surface_mesh(spec, "", settings);
  std::size_t dark = 0;
  for (const float value : mesh.reflectivity) {
    ASSERT_TRUE(value == 0.1F || value == 0.7F) << value;
    dark += value == 0.1F ? 1 : 0;
  }
  EXPECT_EQ(4 * dark, mesh.reflectivity.size());
}

TEST(SurfaceMesh, PlaneWithoutEndIsASquareNearTheScene) {
  SolidSurfaceSpec spec = placed(SolidShape::plane);
  spec.position = {};
  spec.rotation = {};
  spec.extent = {kInfinity, kInfinity};
  SurfaceMeshSettings settings;
  settings.endless = 4;
  settings.endless_near = {5, 1, 2};
  const SurfaceMesh mesh = surface_mesh(spec, "", settings);
  Vec3 middle;
  for (const Vec3 v : mesh.vertices) {
    EXPECT_EQ(v.z, 0);
    middle = middle + (1.0 / static_cast<double>(mesh.vertices.size())) * v;
  }
  EXPECT_TRUE(relative(middle.x, 5, 1e-12));
  EXPECT_TRUE(relative(middle.y, 1, 1e-12));
  EXPECT_TRUE(relative(sums_of(mesh, {}).area, 16, 1e-12));
}

TEST(SurfaceMesh, ReadsMeshFiles) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.file("a.obj")) << "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 4\nf 1 3 2\nf 1 2 4\n"
                                         "f 1 4 3\nf 2 3 4\n";
  SolidSurfaceSpec spec = placed(SolidShape::mesh);
  spec.file = "a.obj";
  spec.file_unit = 1e-2;
  const SurfaceMesh mesh = surface_mesh(spec, folder.path());
  EXPECT_EQ(mesh.triangles.size(), 4U);
  EXPECT_TRUE(relative(sums_of(mesh, spec.position).volume, 4e-6, 1e-5));
  spec.file = "missing.obj";
  EXPECT_THROW(surface_mesh(spec, folder.path()), FileError);
}

}  // namespace
}  // namespace plenoflame::surface_mesh_test
