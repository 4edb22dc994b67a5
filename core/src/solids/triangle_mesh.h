#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "plenoflame/math/vector.h"
#include "solids/mesh.h"

namespace plenoflame {

/// A mesh in its place. Vertices are kept in single precision relative to a centre, as Embree needs
/// them. The rounded vertices are the surface, and all its properties are computed from them in
/// double precision.
class TriangleMesh {
 public:
  struct Vertex {
    float x, y, z;
  };
  using Triangle = std::array<std::uint32_t, 3>;

  /// @param to_world of the mesh's frame @param unit [m] of its lengths @param centre world
  TriangleMesh(MeshData data, const RigidTransform& to_world, double unit, Vec3 centre);

  const std::vector<Vertex>& vertices() const { return vertices_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }

  /// Finds where a line (relative to the centre) meets a triangle's plane. Near the plane the sign
  /// of its distance is lost in rounding: a start there counts as lying on it.
  /// @return false when it is parallel, or when the crossing cannot be told from t = 0
  bool plane_crossing(std::uint32_t triangle, const Ray& ray, double& t) const;
  Vec3 normal(std::uint32_t triangle) const;  ///< unit, towards the front
  /// Texture coordinates at a point (relative to the centre) of a triangle; 0 without any.
  Vec2 texture_at(std::uint32_t triangle, Vec3 point) const;
  bool textured() const { return !texture_.empty(); }
  double area() const { return cumulative_area_.back(); }
  /// A point drawn evenly, relative to the centre.
  Vec3 draw(double choice, double u, double v, std::uint32_t& triangle) const;
  /// Share of all directions that the mesh covers seen from a point, seen from behind counted
  /// positive: 1 inside of a closed mesh, 0 outside.
  double winding_number(Vec3 point) const;
  Box bounds() const;  ///< relative to the centre

 private:
  Vec3 vertex(std::uint32_t index) const {
    const Vertex& v = vertices_[index];
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
  }
  std::array<Vec3, 3> corners(std::uint32_t triangle) const {
    const Triangle& t = triangles_[triangle];
    return {vertex(t[0]), vertex(t[1]), vertex(t[2])};
  }
  std::vector<Vertex> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<Vec2> texture_;
  std::vector<double> cumulative_area_;
};

}  // namespace plenoflame
