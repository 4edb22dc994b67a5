// Meshes from files: what a file says, what is wrong with one, and rays that start on triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "core/solids/surface_samples.h"
#include "plenoflame/base/error.h"
#include "support/approx.h"
#include "support/temporary_folder.h"

namespace plenoflame::test::mesh_test {
namespace {

SolidSurfaceSpec mesh_spec(const std::string& file) {
  SolidSurfaceSpec spec;
  spec.shape = SolidShape::mesh;
  spec.file = file;
  return spec;
}

/// A cube of side 2 around the origin, as quads, wound so that it looks outwards.
const char* const kCubeObj =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

std::string tetrahedron_ply(const std::string& first_x) {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
         "float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n" +
         first_x + " 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
}

std::string stl_facet(const std::string& normal, const std::string& corners) {
  return "facet normal " + normal + "\nouter loop\n" + corners + "endloop\nendfacet\n";
}

// The same cube as a mesh and as a box: rays from everywhere meet both in the same places.
TEST(Mesh, ACubeIsABox) {
  TemporaryFolder folder;
  write_bytes(folder.file("cube.obj"), kCubeObj);
  SolidSurfaceSpec mesh = mesh_spec("cube.obj"), box = shaped(SolidShape::box, 1);
  mesh.file_unit = 0.01;
  mesh.rotation = box.rotation = {0.3, -0.4, 1.2};
  mesh.position = {1, 2, 3};
  box.size = {0.02, 0.02, 0.02};
  box.position = mesh.position - 0.01 * (rotation_xyz(box.rotation) * Vec3{0, 0, 1});
  const auto meshes = scene_of({mesh}, folder.path()), boxes = scene_of({box});
  EXPECT_TRUE(relative(meshes->area(0), boxes->area(0), 1e-5));
  EXPECT_EQ(meshes->inside_of(mesh.position), 0);
  EXPECT_EQ(meshes->inside_of(mesh.position + Vec3{0.02, 0, 0}), -1);
  Random random(1);
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vec3 target = mesh.position + 0.03 * Vec3{random() - 0.5, random() - 0.5, random() - 0.5};
    const Vec3 d = random.direction();
    const Ray ray{target - 2 * d, d};
    SurfaceHit a, b;
    const bool meets = boxes->intersect(ray, 0, kInfinity, {}, b);
    if (meets != meshes->intersect(ray, 0, kInfinity, {}, a)) continue;  // along an edge
    if (!meets) continue;
    ++hits;
    EXPECT_TRUE(relative(a.t, b.t, 1e-8));  // vertices are in single precision
    EXPECT_TRUE(a.front && b.front);
  }
  EXPECT_GT(hits, 1500);
}

// Rays that leave the faces of a finely divided cube: neighbours in the same plane never shadow
// each other, not at 1e-3 from grazing, in no unit and at no distance from the origin.
TEST(Mesh, FlatNeighboursDoNotShadowEachOther) {
  TemporaryFolder folder;
  std::string obj;
  constexpr int kSide = 40;
  for (int j = 0; j <= kSide; ++j)
    for (int i = 0; i <= kSide; ++i)
      obj += "v " + std::to_string(i / 7.0) + " " + std::to_string(j / 7.0) + " 0\n";
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const int a = j * (kSide + 1) + i + 1, b = a + kSide + 1;
      obj += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(b + 1) +
             "\nf " + std::to_string(a) + " " + std::to_string(b + 1) + " " + std::to_string(b) +
             "\n";
    }
  write_bytes(folder.file("sheet.obj"), obj);
  Random random(2);
  for (const double unit : {1e-6, 1.0, 1e4})
    for (const double away : {0.0, 100.0}) {
      SolidSurfaceSpec spec = mesh_spec("sheet.obj");
      spec.file_unit = unit;
      spec.position = away * unit * Vec3{1, -2, 0.7};
      const auto scene = scene_of({spec}, folder.path());
      int shadowed = 0;
      for (int i = 0; i < 20000; ++i) {
        const SurfacePoint start = scene->point_on(0, random(), random(), random());
        const double azimuth = 6.283185307179586 * random();
        const Vec3 d = normalize({std::cos(azimuth), std::sin(azimuth), 1e-3});
        shadowed += scene->occluded({start.point, d}, 0, kInfinity, start.where);
      }
      EXPECT_EQ(shadowed, 0) << unit << " " << away;
    }
}

// The front of a face is the side its corners run counterclockwise on, unless the file's normals
// say otherwise.
TEST(Mesh, NormalsDecideTheFront) {
  TemporaryFolder folder;
  const std::string corners = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
  write_bytes(folder.file("up.stl"), "solid s\n" + stl_facet("0 0 1", corners) + "endsolid s\n");
  write_bytes(folder.file("down.stl"), "solid s\n" + stl_facet("0 0 -1", corners) + "endsolid s\n");
  const Ray down{{0.2, 0.2, 1}, {0, 0, -1}};
  for (const bool up : {true, false}) {
    SolidSurfaceSpec spec = mesh_spec(up ? "up.stl" : "down.stl");
    spec.material.sides = MaterialSides::front;
    spec.material.reflectivity = 0.7;
    const auto scene = scene_of({spec}, folder.path());
    SurfaceHit hit;
    ASSERT_TRUE(scene->intersect(down, 0, kInfinity, {}, hit));
    EXPECT_EQ(hit.front, up);
    EXPECT_EQ(hit.reflectivity, up ? 0.7 : 0);
    EXPECT_EQ(hit.normal.z, 1);
  }
}

TEST(Mesh, PlyAndTextureCoordinates) {
  TemporaryFolder folder;
  write_bytes(folder.file("t.ply"), tetrahedron_ply("0"));
  const auto scene = scene_of({mesh_spec("t.ply")}, folder.path());
  EXPECT_TRUE(relative(scene->area(0), 1.5 + 0.5 * std::sqrt(3.0), 1e-6));
  // A square of texture coordinates 0 to 1, with a checkerboard of 2 x 2 squares on it.
  write_bytes(folder.file("square.obj"),
              "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
              "f 1/1 2/2 3/3 4/4\n");
  SolidSurfaceSpec spec = mesh_spec("square.obj");
  spec.material.reflectivity = 0.9;
  spec.material.texture = {TextureKind::checkerboard, 0.1, 0.5, 2, 2, 0.5, {1, 1}, ""};
  const auto board = scene_of({spec}, folder.path());
  const auto seen = [&](double x, double y) {
    SurfaceHit hit;
    EXPECT_TRUE(board->intersect({{x, y, 1}, {0, 0, -1}}, 0, kInfinity, {}, hit));
    return hit.reflectivity;
  };
  EXPECT_EQ(seen(1, 3), 0.1);  // top left is dark
  EXPECT_EQ(seen(3, 3), 0.9);
  EXPECT_EQ(seen(1, 1), 0.9);
  EXPECT_EQ(seen(3, 1), 0.1);
}

std::string message_of_loading(const SolidSurfaceSpec& spec, const std::string& folder) {
  try {
    scene_of({spec}, folder);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Mesh, BrokenFilesAreNamed) {
  TemporaryFolder folder;
  const auto message = [&](const std::string& name, const std::string& bytes) {
    write_bytes(folder.file(name), bytes);
    const std::string text = message_of_loading(mesh_spec(name), folder.path());
    EXPECT_NE(text.find(name), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text;
  };
  const std::string missing = message_of_loading(mesh_spec("nowhere.obj"), folder.path());
  EXPECT_NE(missing.find(folder.file("nowhere.obj")), std::string::npos) << missing;
  EXPECT_NE(message("a.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "");
  EXPECT_NE(message("b.ply", tetrahedron_ply("nan")).find("finite"), std::string::npos);
  EXPECT_NE(message("b2.ply", tetrahedron_ply("inf")).find("finite"), std::string::npos);
  EXPECT_NE(message("c.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").find("area"),
            std::string::npos);
  EXPECT_NE(message("d.obj", "v 0 0 0\n"), "");
  EXPECT_NE(message("e.obj", ""), "");
  for (const std::string rest :
       {"vertex 0 0", "nonsense 1 2 3\n", "vertex 0 0 0\nvertex 1 0 0\nendloop\n"})
    EXPECT_NE(
        message("f.stl", "solid s\n" +
                             stl_facet("0 0 1", "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n") +
                             "facet normal 0 0 1\nouter loop\n" + rest)
            .find("facet 2"),
        std::string::npos);
  EXPECT_NE(message("f2.stl", "solid s\nendsolid s\n"), "");
  EXPECT_NE(message("f3.stl", std::string(84, '\1')), "");
  EXPECT_NE(message("g.ply", "ply\nformat ascii 1.0\nelement vertex 1000000\n"), "");
  const std::string ply = tetrahedron_ply("0");
  EXPECT_NE(message("g2.ply", ply.substr(0, ply.size() - 12)).find("7 of 8 lines"),
            std::string::npos);
  EXPECT_NE(message("h.obj", "f 1 2 3\n"), "");
  EXPECT_NE(message("i.step", "x").find("OBJ, PLY or STL"), std::string::npos);
  // Some faces without area: the rest is used, and a warning says so.
  write_bytes(folder.file("some.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n");
  std::string warning;
  Execution execution;
  execution.message = [&](Severity severity, const std::string& text) {
    if (severity == Severity::warning) warning = text;
  };
  const auto scene = make_surface_scene({mesh_spec("some.obj")}, folder.path(),
                                        {SourceFunction::total()}, execution);
  EXPECT_NE(warning.find("1 faces without area"), std::string::npos) << warning;
  EXPECT_TRUE(relative(scene->area(0), 0.5, 1e-6));
}

double area_of(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  write_bytes(folder.file(name), bytes);
  return scene_of({mesh_spec(name)}, folder.path())->area(0);
}

// Twice the area of a polygon in the plane is a sum over its edges.
double shoelace(const std::vector<Vec2>& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 a = corners[i], b = corners[(i + 1) % corners.size()];
    sum += a.x * b.y - b.x * a.y;
  }
  return 0.5 * std::fabs(sum);
}

// Polygons with notches: what is cut up has the area of the whole, in any place and either way
// round, and its front where the corners run counterclockwise.
TEST(Mesh, PolygonsWithNotchesKeepTheirArea) {
  const std::vector<std::vector<Vec2>> polygons{
      {{0, 0}, {4, 0}, {4, 4}, {2, 1}},                                  // a dart
      {{0, 0}, {6, 0}, {6, 5}, {4, 5}, {4, 2}, {2, 2}, {2, 5}, {0, 5}},  // a U
      {{0, 0},
       {9, 0},
       {9, 1},
       {1, 1},
       {1, 8},
       {8, 8},
       {8, 3},
       {3, 3},
       {3, 6},
       {4, 6},
       {4, 4},
       {7, 4},
       {7, 7},
       {2, 7},
       {2, 2},
       {9, 2},
       {9, 9},
       {0, 9}}};  // a spiral
  for (const std::vector<Vec2>& polygon : polygons)
    for (const bool reversed : {false, true})
      for (int axis = 0; axis < 3; ++axis) {
        TemporaryFolder folder;
        std::string obj, face = "f";
        for (std::size_t i = 0; i < polygon.size(); ++i) {
          const Vec2 p = polygon[i];
          const double c[3] = {p.x, p.y, 0};
          for (int k = 0; k < 3; ++k)
            obj += (k == 0 ? "v " : " ") + std::to_string(c[(k + 3 - axis) % 3]);
          obj += "\n";
          const std::size_t at = reversed ? polygon.size() - i : i + 1;
          face += " " + std::to_string(at);
        }
        write_bytes(folder.file("p.obj"), obj + face + "\n");
        SolidSurfaceSpec spec = mesh_spec("p.obj");
        const auto scene = scene_of({spec}, folder.path());
        EXPECT_TRUE(relative(scene->area(0), shoelace(polygon), 1e-6)) << polygon.size();
        Vec3 towards;
        (axis == 0 ? towards.z : axis == 1 ? towards.x : towards.y) = -1;
        Vec3 inside{0.5, 0.5, 0};
        if (axis == 1) inside = {0, 0.5, 0.5};
        if (axis == 2) inside = {0.5, 0, 0.5};
        // The dart's notch takes the place above its diagonal.
        if (polygon.size() == 4) (axis == 0 ? inside.x : axis == 1 ? inside.y : inside.z) += 0.8;
        SurfaceHit hit;
        ASSERT_TRUE(scene->intersect({inside - towards, towards}, 0, kInfinity, {}, hit));
        EXPECT_EQ(hit.front, !reversed);
      }
}

template <class T>
std::string bytes_of(T value, bool big) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

// The same tetrahedron in every way that a file can say it.
TEST(Mesh, OneSolidInEveryFormat) {
  const double area = 1.5 + 0.5 * std::sqrt(3.0);
  const float places[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  for (const bool big : {false, true}) {
    std::string ply = "ply\nformat binary_" + std::string(big ? "big" : "little") +
                      "_endian 1.0\ncomment x\nelement face 4\nproperty uchar red\n"
                      "property list ushort int16 vertex_index\nelement vertex 4\n"
                      "property double x\nproperty list uchar float rest\nproperty float y\n"
                      "property float z\nend_header\n";
    for (const auto& face : faces) {
      ply += "c" + bytes_of(std::uint16_t{3}, big);
      for (const int corner : face) ply += bytes_of(static_cast<std::int16_t>(corner), big);
    }
    for (const auto& p : places)
      ply += bytes_of(static_cast<double>(p[0]), big) + "\1" + bytes_of(9.0F, big) +
             bytes_of(p[1], big) + bytes_of(p[2], big);
    EXPECT_TRUE(relative(area_of("t.ply", ply), area, 1e-6));
  }
  std::string stl = "solid in binary" + std::string(65, ' ') + bytes_of(std::uint32_t{4}, false);
  for (const auto& face : faces) {
    stl += std::string(12, '\0');
    for (const int corner : face)
      for (const float value : places[corner]) stl += bytes_of(value, false);
    stl += std::string(2, '\0');
  }
  EXPECT_TRUE(relative(area_of("t.stl", stl), area, 1e-6));
  // Numbers that count backwards, weights, continued lines, faces before vertices.
  EXPECT_TRUE(relative(area_of("t.obj",
                               "f 1//1 3//1 2//1\nvn 0 0 -1\nv 0 0 0\nv 2 0 0 2\nv 0 1 0 # a\n"
                               "v 0 0 1 0.5 0.5 0.5\nf -4 -3 \\\n-1\nf 2 3 4\nf 3 1 4\n"),
                       area, 1e-6));
}

TEST(Mesh, HeadersThatPromiseTooMuchTakeNoMemory) {
  TemporaryFolder folder;
  const auto message = [&](const std::string& name, const std::string& bytes) {
    write_bytes(folder.file(name), bytes);
    return message_of_loading(mesh_spec(name), folder.path());
  };
  const std::string vertices = "property float x\nproperty float y\nproperty float z\n";
  for (const std::string format : {"ascii", "binary_little_endian"})
    for (const std::string count : {"18446744073709551615", "4000000000000"}) {
      EXPECT_NE(message("a.ply", "ply\nformat " + format + " 1.0\nelement vertex " + count + "\n" +
                                     vertices + "end_header\n0 0 0\n"),
                "");
      EXPECT_NE(message("b.ply", "ply\nformat " + format + " 1.0\nelement vertex " + count +
                                     "\nend_header\n0 0 0\n"),
                "");
    }
  EXPECT_NE(message("c.ply", "ply\nformat ascii 1.0\nelement vertex 1\n" + vertices +
                                 "element face 1\nproperty list uint int vertex_index\nend_header\n"
                                 "0 0 0\n4294967295 0 0 0\n"),
            "");
  std::string round = "";
  for (int i = 0; i < 5000; ++i)
    round += "v " + std::to_string(i) + " " + std::to_string(i * i) + " 0\n";
  round += "f";
  for (int i = 1; i <= 5000; ++i) round += " " + std::to_string(i);
  EXPECT_NE(message("d.obj", round + "\n").find("5000 corners"), std::string::npos);
}

TEST(Mesh, TexturesThatCannotBeUsed) {
  TemporaryFolder folder;
  SolidSurfaceSpec plane = shaped(SolidShape::plane, 1);
  plane.material.texture.kind = TextureKind::image;
  plane.material.texture.file = "no.png";
  EXPECT_NE(message_of_loading(plane, folder.path()).find(folder.file("no.png")),
            std::string::npos);
  write_bytes(folder.file("bad.png"), "not a picture");
  plane.material.texture.file = "bad.png";
  EXPECT_NE(message_of_loading(plane, folder.path()).find("bad.png"), std::string::npos);
  write_bytes(folder.file("cube.obj"), kCubeObj);
  SolidSurfaceSpec cube = mesh_spec("cube.obj");
  cube.material.texture.kind = TextureKind::checkerboard;
  EXPECT_NE(message_of_loading(cube, folder.path()).find("texture coordinates"), std::string::npos);
}

}  // namespace
}  // namespace plenoflame::test::mesh_test
