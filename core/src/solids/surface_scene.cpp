#include "plenoflame/solids/surface_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "plenoflame/base/error.h"
#include "solids/mesh.h"
#include "solids/shapes.h"
#include "solids/texture.h"
#include "solids/triangle_mesh.h"

namespace plenoflame {
namespace {

struct Surface {
  SolidSurfaceSpec spec;
  std::optional<Shape> shape;  ///< analytic kinds
  int mesh = -1;               ///< index of the mesh otherwise
  Texture texture;
  std::vector<double> emission;  ///< per channel; empty: dark
};

/// The single-precision number next above.
float up(double value) {
  return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity());
}

/// The data of the callbacks of one ray. Embree hands back the pointer to its first member.
struct Query {
  /// @param begin [m] along the ray, where the query begins
  Query(const Ray& whole, double begin, double end, Vec3 centre, SurfacePart part)
      : ray{begin == 0 ? whole.origin : whole.at(begin), whole.direction},
        origin(ray.origin - centre),
        shift(begin),
        t_far(end - begin),
        from(part) {
    rtcInitIntersectContext(&context);
  }
  void set(RTCRay& single) const {
    single.org_x = static_cast<float>(origin.x);
    single.org_y = static_cast<float>(origin.y);
    single.org_z = static_cast<float>(origin.z);
    single.dir_x = static_cast<float>(ray.direction.x);
    single.dir_y = static_cast<float>(ray.direction.y);
    single.dir_z = static_cast<float>(ray.direction.z);
    single.tnear = 0;
    single.tfar = up(t_far);
    single.time = 0;
    single.mask = ~0u;
    single.id = 0;
    single.flags = 0;
  }

  RTCIntersectContext context;
  Ray ray;       ///< world
  Vec3 origin;   ///< relative to the centre
  double shift;  ///< of the origin along the ray as it was given
  double t_near = 0, t_far;
  SurfacePart from, found;
};

Query& query_of(RTCIntersectContext* context) {
  return *reinterpret_cast<Query*>(context);
}

class EmbreeScene final : public SurfaceScene {
 public:
  EmbreeScene(const std::vector<SolidSurfaceSpec>& specs, const std::string& folder,
              const std::vector<SourceFunction>& channels, const Execution& execution,
              const std::function<std::string(int)>& place);
  ~EmbreeScene() override {
    if (scene_) rtcReleaseScene(scene_);
    if (device_) rtcReleaseDevice(device_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  bool intersect(const Ray& ray, double t_near, double t_far, SurfacePart from,
                 SurfaceHit& hit) const override;
  bool occluded(const Ray& ray, double t_near, double t_far, SurfacePart from) const override;
  int surface_count() const override { return static_cast<int>(surfaces_.size()); }
  const double* emission(int surface, bool front) const override {
    const Surface& s = at(surface);
    const bool dark =
        s.emission.empty() || (!front && s.spec.material.sides == MaterialSides::front);
    return dark ? nullptr : s.emission.data();
  }
  double area(int surface) const override;
  SurfacePoint point_on(int surface, double choice, double u, double v) const override;
  Box bounds() const override { return bounds_; }
  bool has_endless_plane() const override { return !endless_.empty(); }
  double feature_size() const override { return feature_size_; }
  int inside_of(Vec3 point) const override;
  std::vector<PatternPoint> pattern_points() const override;
  std::string description() const override;

 private:
  const Surface& at(int surface) const { return surfaces_[static_cast<std::size_t>(surface)]; }
  const TriangleMesh& mesh_of(const Surface& s) const {
    return meshes_[static_cast<std::size_t>(s.mesh)];
  }
  void load(const SolidSurfaceSpec& spec, const std::string& what, const std::string& folder,
            const std::vector<SourceFunction>& channels, const Execution& execution,
            std::vector<MeshData>& mesh_data);
  void find_bounds(const std::vector<MeshData>& mesh_data);
  void build(const Execution& execution);
  void add_shapes();
  void add_mesh(unsigned id, const TriangleMesh& mesh);
  void check_device() const;
  bool comes_near(const Ray& ray, double t_near, double t_far, double& begin) const;
  void describe_hit(const Ray& ray, SurfaceHit& hit) const;

  static void shape_bounds(const RTCBoundsFunctionArguments* args);
  static void intersect_shape(const RTCIntersectFunctionNArguments* args);
  static void occlude_shape(const RTCOccludedFunctionNArguments* args);
  static void filter_triangle(const RTCFilterFunctionNArguments* args);
  /// Meets shape `index` of shapes_ with a query's ray. @return whether it is hit
  bool try_shape(unsigned index, Query& query) const;

  std::vector<Surface> surfaces_;
  std::vector<TriangleMesh> meshes_;
  std::vector<int> mesh_surface_;  ///< whose each mesh is
  std::vector<int> shapes_;        ///< analytic surfaces with an end: Embree's user primitives
  std::vector<int> endless_;
  Box bounds_;
  Vec3 centre_;        ///< of the bounds: Embree's origin
  double radius_ = 0;  ///< of a sphere around the bounds
  double feature_size_ = kInfinity;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

EmbreeScene::EmbreeScene(const std::vector<SolidSurfaceSpec>& specs, const std::string& folder,
                         const std::vector<SourceFunction>& channels, const Execution& execution,
                         const std::function<std::string(int)>& place) {
  std::vector<MeshData> mesh_data;
  for (std::size_t i = 0; i < specs.size(); ++i) {
    const std::string where = place ? place(static_cast<int>(i)) : "";
    const std::string before = where.empty() ? "" : where + ": ";
    const std::string what = surface_name(specs, static_cast<int>(i));
    try {
      load(specs[i], before + what, folder, channels, execution, mesh_data);
    } catch (const FileError& error) {
      throw FileError(before + what + ": " + error.what());
    }
  }
  find_bounds(mesh_data);
  for (std::size_t i = 0; i < mesh_data.size(); ++i) {
    const SolidSurfaceSpec& spec = at(mesh_surface_[i]).spec;
    meshes_.emplace_back(std::move(mesh_data[i]),
                         RigidTransform{rotation_xyz(spec.rotation), spec.position}, spec.file_unit,
                         centre_);
    const TriangleMesh& mesh = meshes_.back();
    feature_size_ = std::min(feature_size_,
                             std::sqrt(mesh.area() / static_cast<double>(mesh.triangles().size())));
  }
  build(execution);
}

void EmbreeScene::load(const SolidSurfaceSpec& spec, const std::string& what,
                       const std::string& folder, const std::vector<SourceFunction>& channels,
                       const Execution& execution, std::vector<MeshData>& mesh_data) {
  const auto number = static_cast<int>(surfaces_.size());
  Surface surface;
  surface.spec = spec;
  const MaterialSpec& material = surface.spec.material;
  if (spec.shape == SolidShape::mesh) {
    const std::string path =
        folder.empty() || spec.file.starts_with('/') ? spec.file : folder + "/" + spec.file;
    mesh_data.push_back(read_mesh(path, what, execution));
    if (material.texture.kind != TextureKind::none && mesh_data.back().texture.empty())
      throw InputError(what + " has a texture, but the mesh file \"" + path +
                       "\" has no texture coordinates");
    surface.mesh = static_cast<int>(mesh_surface_.size());
    mesh_surface_.push_back(number);
  } else {
    surface.shape.emplace(spec);
    feature_size_ = std::min(feature_size_, surface.shape->feature_size());
    (surface.shape->endless() ? endless_ : shapes_).push_back(number);
  }
  if (material.kind == MaterialKind::lambertian) {
    surface.texture = Texture(material.texture, material.reflectivity, folder);
    feature_size_ = std::min(feature_size_, surface.texture.feature_size());
  }
  if (material.kind == MaterialKind::emitter)
    for (const SourceFunction& channel : channels)
      surface.emission.push_back(material.radiance * channel.share());
  if (material.kind == MaterialKind::blackbody)
    for (const SourceFunction& channel : channels)
      surface.emission.push_back(channel(material.temperature));
  surfaces_.push_back(std::move(surface));
}

void EmbreeScene::find_bounds(const std::vector<MeshData>& mesh_data) {
  Vec3 low{kInfinity, kInfinity, kInfinity}, high = -low;
  const auto include = [&](Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  };
  for (const int i : shapes_) {
    const Box box = at(i).shape->bounds();
    include(box.lower);
    include(box.upper);
  }
  for (std::size_t i = 0; i < mesh_data.size(); ++i) {
    const SolidSurfaceSpec& spec = at(mesh_surface_[i]).spec;
    const RigidTransform to_world{rotation_xyz(spec.rotation), spec.position};
    for (const auto& triangle : mesh_data[i].triangles)
      for (const std::uint32_t v : triangle)
        include(to_world.point(spec.file_unit * mesh_data[i].vertices[v]));
  }
  if (low.x > high.x) return;  // nothing that ends
  bounds_ = {low, high};
  centre_ = 0.5 * (low + high);
  radius_ = 0.5 * length(high - low);
}

void EmbreeScene::check_device() const {
  if (rtcGetDeviceError(device_) != RTC_ERROR_NONE)
    throw InputError(
        "the surfaces are too many for the memory: Embree could not build its search tree");
}

void EmbreeScene::build(const Execution& execution) {
  if (bounds_.empty()) return;
  const std::string config = "threads=" + std::to_string(execution.thread_count());
  device_ = rtcNewDevice(config.c_str());
  if (!device_) throw InputError("Embree, which traces surfaces, does not start on this processor");
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  if (!shapes_.empty()) add_shapes();
  for (std::size_t i = 0; i < meshes_.size(); ++i)
    add_mesh(static_cast<unsigned>(i) + 1, meshes_[i]);
  check_device();
  rtcCommitScene(scene_);
  check_device();
}

void EmbreeScene::add_shapes() {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(shapes_.size()));
  rtcSetGeometryUserData(geometry, this);
  rtcSetGeometryBoundsFunction(geometry, shape_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect_shape);
  rtcSetGeometryOccludedFunction(geometry, occlude_shape);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_, geometry, 0);
  rtcReleaseGeometry(geometry);
}

void EmbreeScene::add_mesh(unsigned id, const TriangleMesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree reads 16 bytes at the last vertex: its own buffer is padded, ours is not.
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(TriangleMesh::Vertex), mesh.vertices().size());
  void* triangles =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              sizeof(TriangleMesh::Triangle), mesh.triangles().size());
  check_device();
  std::copy(mesh.vertices().begin(), mesh.vertices().end(),
            static_cast<TriangleMesh::Vertex*>(vertices));
  std::copy(mesh.triangles().begin(), mesh.triangles().end(),
            static_cast<TriangleMesh::Triangle*>(triangles));
  rtcSetGeometryUserData(geometry, this);
  rtcSetGeometryIntersectFilterFunction(geometry, filter_triangle);
  rtcSetGeometryOccludedFilterFunction(geometry, filter_triangle);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_, geometry, id);
  rtcReleaseGeometry(geometry);
}

void EmbreeScene::shape_bounds(const RTCBoundsFunctionArguments* args) {
  const auto& self = *static_cast<const EmbreeScene*>(args->geometryUserPtr);
  const Box box = self.at(self.shapes_[args->primID]).shape->bounds();
  // Embree walks its tree with a ray in single precision. Its origin is at most 1.5 radii from the
  // centre, and its direction is over 3 radii. Both are rounded, by at most 5 radii * 2^-24
  // together. Twice this margin also covers the rounding of the box.
  const double margin = 10 * 0x1p-24 * self.radius_;
  const Vec3 low = box.lower - self.centre_, high = box.upper - self.centre_;
  RTCBounds& out = *args->bounds_o;
  out.lower_x = static_cast<float>(low.x - margin);
  out.lower_y = static_cast<float>(low.y - margin);
  out.lower_z = static_cast<float>(low.z - margin);
  out.upper_x = static_cast<float>(high.x + margin);
  out.upper_y = static_cast<float>(high.y + margin);
  out.upper_z = static_cast<float>(high.z + margin);
}

bool EmbreeScene::try_shape(unsigned index, Query& query) const {
  const int number = shapes_[index];
  const int from = query.from.surface == number ? query.from.part : kNoPart;
  double t = 0;
  const int part = at(number).shape->intersect(query.ray, query.t_near, query.t_far, from, t);
  if (part == kNoPart) return false;
  query.t_far = t;
  query.found = {number, part};
  return true;
}

void EmbreeScene::intersect_shape(const RTCIntersectFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  const auto& self = *static_cast<const EmbreeScene*>(args->geometryUserPtr);
  Query& query = query_of(args->context);
  if (!self.try_shape(args->primID, query)) return;
  RTCRayHit& single = *reinterpret_cast<RTCRayHit*>(args->rayhit);
  single.ray.tfar = up(query.t_far);  // only cuts the search: the exact distance is the query's
  single.hit.geomID = args->geomID;
  single.hit.primID = args->primID;
}

void EmbreeScene::occlude_shape(const RTCOccludedFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  const auto& self = *static_cast<const EmbreeScene*>(args->geometryUserPtr);
  if (self.try_shape(args->primID, query_of(args->context)))
    reinterpret_cast<RTCRay*>(args->ray)->tfar = -std::numeric_limits<float>::infinity();
}

void EmbreeScene::filter_triangle(const RTCFilterFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  const auto& self = *static_cast<const EmbreeScene*>(args->geometryUserPtr);
  Query& query = query_of(args->context);
  const auto mesh = static_cast<std::size_t>(RTCHitN_geomID(args->hit, args->N, 0)) - 1;
  const std::uint32_t triangle = RTCHitN_primID(args->hit, args->N, 0);
  const SurfacePart part{self.mesh_surface_[mesh], static_cast<int>(triangle)};
  double t = 0;
  if (part == query.from ||
      !self.meshes_[mesh].plane_crossing(triangle, {query.origin, query.ray.direction}, t) ||
      !(t > query.t_near && t < query.t_far)) {
    args->valid[0] = 0;
    return;
  }
  query.t_far = t;
  query.found = part;
}

/// @param begin where the ray enters the sphere: single precision then counts from nearby
/// @return false when the ray cannot meet anything with an end
bool EmbreeScene::comes_near(const Ray& ray, double t_near, double t_far, double& begin) const {
  if (!scene_) return false;
  const Vec3 to_centre = centre_ - ray.origin;
  const double nearest = dot(to_centre, ray.direction);
  const Vec3 miss = to_centre - nearest * ray.direction;
  const double reach = radius_ * (1 + 1e-9);  // for the rounding of this line alone
  begin = std::max(t_near, nearest - reach);
  return !(dot(miss, miss) > reach * reach || nearest - reach > t_far || nearest + reach < t_near);
}

bool EmbreeScene::intersect(const Ray& ray, double t_near, double t_far, SurfacePart from,
                            SurfaceHit& hit) const {
  hit.where = {};
  for (const int i : endless_) {
    const int part =
        at(i).shape->intersect(ray, t_near, t_far, from.surface == i ? from.part : kNoPart, hit.t);
    if (part == kNoPart) continue;
    t_far = hit.t;
    hit.where = {i, part};
  }
  double begin = 0;
  if (comes_near(ray, t_near, t_far, begin)) {
    Query query(ray, begin, t_far, centre_, from);
    RTCRayHit single;
    query.set(single.ray);
    single.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    single.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &query.context, &single);
    if (query.found.surface >= 0) {
      hit.where = query.found;
      hit.t = query.t_far + query.shift;
    }
  }
  if (hit.where.surface < 0) return false;
  describe_hit(ray, hit);
  return true;
}

bool EmbreeScene::occluded(const Ray& ray, double t_near, double t_far, SurfacePart from) const {
  double t = 0;
  for (const int i : endless_)
    if (at(i).shape->intersect(ray, t_near, t_far, from.surface == i ? from.part : kNoPart, t) !=
        kNoPart)
      return true;
  double begin = 0;
  if (!comes_near(ray, t_near, t_far, begin)) return false;
  Query query(ray, begin, t_far, centre_, from);
  RTCRay single;
  query.set(single);
  rtcOccluded1(scene_, &query.context, &single);
  return query.found.surface >= 0;
}

void EmbreeScene::describe_hit(const Ray& ray, SurfaceHit& hit) const {
  const Surface& surface = at(hit.where.surface);
  hit.point = ray.at(hit.t);
  Vec3 normal;
  if (surface.shape) {
    normal = surface.shape->normal(hit.where.part, hit.point);
  } else {
    normal = mesh_of(surface).normal(static_cast<std::uint32_t>(hit.where.part));
  }
  hit.front = dot(normal, ray.direction) < 0;
  hit.normal = hit.front ? normal : -normal;
  hit.reflectivity = 0;
  const MaterialSpec& material = surface.spec.material;
  if (material.kind != MaterialKind::lambertian) return;
  if (!hit.front && material.sides == MaterialSides::front) return;
  if (material.texture.kind == TextureKind::none) {
    hit.reflectivity = material.reflectivity;
    return;
  }
  Vec2 place;
  if (surface.shape) {
    place = surface.shape->coordinates(hit.where.part, hit.point);
  } else {
    const Vec2 uv = mesh_of(surface).texture_at(static_cast<std::uint32_t>(hit.where.part),
                                                hit.point - centre_);
    place = {(uv.x - 0.5) * material.texture.size.x, (uv.y - 0.5) * material.texture.size.y};
  }
  hit.reflectivity = surface.texture.reflectivity(place);
}

double EmbreeScene::area(int surface) const {
  const Surface& s = at(surface);
  return s.shape ? s.shape->area() : mesh_of(s).area();
}

SurfacePoint EmbreeScene::point_on(int surface, double choice, double u, double v) const {
  const Surface& s = at(surface);
  SurfacePoint result;
  result.where.surface = surface;
  if (s.shape) {
    result.point = s.shape->draw(choice, u, v, result.where.part);
    result.normal = s.shape->normal(result.where.part, result.point);
  } else {
    std::uint32_t triangle = 0;
    result.point = mesh_of(s).draw(choice, u, v, triangle) + centre_;
    result.normal = mesh_of(s).normal(triangle);
    result.where.part = static_cast<int>(triangle);
  }
  return result;
}

int EmbreeScene::inside_of(Vec3 point) const {
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const Surface& s = surfaces_[i];
    const bool inside = s.shape ? s.shape->contains(point)
                                : std::fabs(mesh_of(s).winding_number(point - centre_)) > 0.5;
    if (inside) return static_cast<int>(i);
  }
  return -1;
}

std::vector<PatternPoint> EmbreeScene::pattern_points() const {
  std::vector<PatternPoint> points;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const Surface& s = surfaces_[i];
    const bool flat = s.spec.shape == SolidShape::plane || s.spec.shape == SolidShape::disc;
    if (!flat || s.spec.material.kind != MaterialKind::lambertian) continue;
    const bool round = s.spec.shape == SolidShape::disc;
    for (const Texture::Mark& mark : s.texture.marks()) {
      const bool on_it = round ? length(mark.at) < s.spec.radius
                               : 2 * std::fabs(mark.at.x) < s.spec.extent.x &&
                                     2 * std::fabs(mark.at.y) < s.spec.extent.y;
      if (on_it)
        points.push_back(
            {static_cast<int>(i), mark.column, mark.row, s.shape->flat_point(mark.at)});
    }
  }
  return points;
}

std::string EmbreeScene::description() const {
  std::size_t triangles = 0;
  for (const TriangleMesh& mesh : meshes_) triangles += mesh.triangles().size();
  const std::size_t analytic = shapes_.size() + endless_.size();
  std::string text;
  if (analytic > 0) text = std::to_string(analytic) + " exact surfaces";
  if (triangles > 0)
    text += (text.empty() ? "" : ", ") + std::to_string(meshes_.size()) + " meshes of " +
            std::to_string(triangles) + " triangles";
  return text;
}

}  // namespace

std::unique_ptr<SurfaceScene> make_surface_scene(const std::vector<SolidSurfaceSpec>& surfaces,
                                                 const std::string& folder,
                                                 const std::vector<SourceFunction>& channels,
                                                 const Execution& execution,
                                                 const std::function<std::string(int)>& place) {
  return std::make_unique<EmbreeScene>(surfaces, folder, channels, execution, place);
}

}  // namespace plenoflame
