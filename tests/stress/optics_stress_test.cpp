// Refraction where it is hardest, against 113-bit arithmetic.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "plenoflame/base/isa.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/optics/lens_system.h"
#include "render/tracer/pixel_sampler.h"
#include "stress/quad_optics.h"
#include "stress/stress_table.h"
#include "support/cameras.h"

namespace plenoflame::optics_stress_test {
namespace {

using test::distance;
using test::Quad;
using test::QuadRay;
using test::QuadRefraction;
using test::QuadVec;
using test::StressCase;
using test::text;
using test::unit;

constexpr const char* kArea = "Optics";
constexpr const char* kReference = "113-bit arithmetic, textbook form";

std::vector<Isa> isas() {
  std::vector<Isa> list;
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512})
    if (is_supported(isa)) list.push_back(isa);
  return list;
}

/// Rays towards the sensor, at up to 0.9 of a height, from one height away, in units of that
/// height.
std::vector<Ray> rays_at(double height) {
  std::vector<Ray> rays;
  for (const double part : {0.0, 1e-6, 0.1, -0.5, 0.8})
    for (const Vec3 d : {Vec3{0, 0, -1}, Vec3{0.03, -0.05, -1}, Vec3{-0.2, 0.1, -1}}) {
      const Vec3 direction = normalize(d);
      // Aimed at the vertex plane, at the part of the height.
      const Vec3 at{0.8 * part * height, 0.6 * part * height, 0};
      rays.push_back({at - height * direction, direction});
    }
  return rays;
}

std::vector<double> radii() {
  std::vector<double> list{kInfinity};
  for (double r = 1e-5; r < 1.01e3; r *= 10)
    for (const double sign : {1.0, -1.0}) list.push_back(sign * r);
  return list;
}

/// A lens of one surface and a plane behind it, far enough not to touch it.
std::vector<SurfaceSpec> plano(double radius, double height, double index) {
  return {{radius, 2.5 * height, index, 2 * height, false}, {kInfinity, 0, 1, 20 * height, false}};
}

double height_of(double radius) {
  return std::isinf(radius) ? 0.05 : std::min(0.9 * std::fabs(radius), 0.1);
}

TEST(OpticsStress, RadiiInDoublePrecision) {
  StressCase points(kArea, "plano lenses of radius 10 um to 1 km and plane, points, double [path]",
                    kReference, 1e-15);
  StressCase directions(kArea, "plano lenses, directions, double [1]", kReference, 2e-15);
  for (const double radius : radii()) {
    const double height = height_of(radius);
    const LensSystem lens(plano(radius, height, 1.6));
    for (const Ray& start : rays_at(height)) {
      QuadRay exact{start.origin, unit(start.direction)};
      const QuadRefraction first = quad_refract(exact, 0, radius, 1, 1.6);
      const QuadRefraction second = quad_refract(exact, -Quad(2.5 * height), kInfinity, 1.6, 1);
      if (first.status != RayStatus::reached || second.status != RayStatus::reached ||
          first.height2 > 0.99 * height * height || second.height2 > 81 * height * height)
        continue;
      Ray ray = start;
      EXPECT_EQ(lens.trace_to_sensor(ray), TraceStatus{});
      const double path = distance(exact.origin, start.origin);
      const std::string where = text("radius", radius) + " m";
      points.add(distance(ray.origin, exact.origin) / path, where);
      directions.add(distance(ray.direction, exact.direction), where);
    }
  }
}

/// One surface as the kernels see it: rays travel towards +z, from the vertex plane of the surface
/// before (here: a plane at -height).
template <class Real>
void kernel_radii(const std::string& precision, double point_bound, double direction_bound) {
  StressCase points(kArea, "plano lenses, vector kernels, points, " + precision + " [path]",
                    kReference, point_bound);
  StressCase directions(kArea, "plano lenses, vector kernels, directions, " + precision + " [1]",
                        kReference, direction_bound);
  for (const double radius : radii())
    for (const Isa isa : isas()) {
      const double height = height_of(radius);
      KernelCamera<Real> camera{};
      camera.surface_count = 2;
      // For rays towards +z a positive curvature has its centre ahead.
      camera.surfaces[0] = {static_cast<Real>(height), static_cast<Real>(1 / radius),
                            static_cast<Real>(height * height), static_cast<Real>(1 / 1.6),
                            static_cast<Real>((1.6 - 1) * (1.6 + 1) / (1.6 * 1.6))};
      camera.surfaces[1] = {static_cast<Real>(2.5 * height), Real(0),
                            static_cast<Real>(100 * height * height), static_cast<Real>(1.6),
                            static_cast<Real>((1 - 1.6) * (1 + 1.6))};
      camera.refracts[0] = camera.refracts[1] = true;
      for (int i = 0; i < 3; ++i) camera.rotation[4 * i] = 1;
      const std::vector<Ray> rays = rays_at(height);
      std::vector<std::vector<Real>> columns(7, std::vector<Real>(kBlockRays));
      std::vector<int> code(kBlockRays);
      for (std::size_t i = 0; i < static_cast<std::size_t>(kBlockRays); ++i) {
        const Ray& ray = rays[i % rays.size()];
        const double values[7] = {ray.origin.x,
                                  ray.origin.y,
                                  height - ray.origin.z,
                                  ray.direction.x,
                                  ray.direction.y,
                                  -ray.direction.z,
                                  1};
        for (std::size_t c = 0; c < 7; ++c) columns[c][i] = static_cast<Real>(values[c]);
      }
      // Rounded inputs are what the reference starts from: the kernel is judged, not the rounding.
      std::vector<QuadRay> exact;
      for (std::size_t i = 0; i < rays.size(); ++i)
        exact.push_back({QuadVec(columns[0][i], columns[1][i], columns[2][i]),
                         QuadVec(columns[3][i], columns[4][i], columns[5][i])});
      camera_kernels<Real>(isa).trace_lens(camera, 32,
                                           {columns[0].data(),
                                            columns[1].data(),
                                            columns[2].data(),
                                            columns[3].data(),
                                            columns[4].data(),
                                            columns[5].data(),
                                            columns[6].data(),
                                            {},
                                            code.data()});
      for (std::size_t i = 0; i < rays.size(); ++i) {
        QuadRay& ray = exact[i];
        const QuadVec start = ray.origin;
        ray.direction = unit(ray.direction);
        const QuadRefraction first =
            quad_refract(ray, static_cast<Quad>(camera.surfaces[0].gap),
                         // Towards +z the centre lies ahead for the same sign.
                         -1 / static_cast<double>(camera.surfaces[0].curvature), 1, 1.6);
        const QuadRefraction second = quad_refract(
            ray,
            static_cast<Quad>(camera.surfaces[0].gap) + static_cast<Quad>(camera.surfaces[1].gap),
            kInfinity, 1.6, 1);
        if (first.status != RayStatus::reached || second.status != RayStatus::reached ||
            first.height2 > 0.99 * height * height || second.height2 > 81 * height * height)
          continue;
        EXPECT_EQ(code[i], 0) << radius << " ray " << i;
        const std::string where = text("radius", radius) + " m, " + std::string(name(isa));
        const double path = distance(ray.origin, start);
        // Afterwards z counts from the last vertex, at which the kernel stops: the anchor's plane.
        const QuadVec point{columns[0][i], columns[1][i], ray.origin.z};
        points.add(distance(point, ray.origin) / path, where);
        directions.add(distance({columns[3][i], columns[4][i], columns[5][i]}, ray.direction),
                       where);
      }
    }
}

TEST(OpticsStress, RadiiInKernels) {
  kernel_radii<float>("single", 2e-6, 1e-6);
  kernel_radii<double>("double", 1e-15, 2e-15);
}

// Heights up to 1 - 1e-12 of the radius: the direction depends on 1 / cos i there, so the error is
// taken times cos i.
TEST(OpticsStress, HemisphericalCaps) {
  StressCase directions(kArea,
                        "hemispherical caps to 1 - 1e-12 of the radius, direction times cos i [1]",
                        kReference, 1e-15);
  for (const double radius : {1e-5, 0.01, 1e3})
    for (double d = 0.3; d > 1e-12; d /= 3) {
      const LensSystem lens({{radius, radius, 1.5, 2 * radius, false}});
      const double height = radius * (1 - d);
      const Ray start{{0.6 * height, 0.8 * height, radius}, {0, 0, -1}};
      QuadRay exact{start.origin, start.direction};
      const QuadRefraction refraction = quad_refract(exact, 0, radius, 1, 1.5);
      Ray ray = start;
      EXPECT_EQ(lens.trace_to_sensor(ray), TraceStatus{});
      directions.add(
          distance(ray.direction, exact.direction) * static_cast<double>(refraction.cos_in),
          text("radius", radius) + text(" m, 1 - height/radius", d));
    }
}

TEST(OpticsStress, IndexSteps) {
  StressCase deflection(kArea, "index steps of 1e-12 to 1e-3, error of the direction [1]",
                        kReference, 3e-16);
  StressCase relative(kArea, "index step 1e-9, error over deflection [1]", kReference, 3e-7);
  for (double step = 1e-12; step < 2e-3; step *= 10)
    for (const double radius : {0.05, -0.05, 1e-4})
      for (const double part : {0.1, 0.5, 0.9}) {
        const double behind = 1 + step, height = part * std::fabs(radius);
        const LensSystem lens({{radius, 0, behind, 1.9 * std::fabs(radius), false}});
        const Ray start{{height, 0, 2 * std::fabs(radius)}, {0, 0, -1}};
        QuadRay exact{start.origin, start.direction};
        quad_refract(exact, 0, radius, 1, behind);
        Ray ray = start;
        EXPECT_EQ(lens.trace_to_sensor(ray), TraceStatus{});
        const double error = distance(ray.direction, exact.direction);
        const std::string where = text("step", step) + text(", radius", radius) + " m";
        deflection.add(error, where);
        if (step > 0.9e-9 && step < 1.1e-9)
          relative.add(error / distance(exact.direction, start.direction), where);
      }
}

// From glass into air at angles within 1e-1 to 1e-15 of the critical one, both sides.
TEST(OpticsStress, TotalInternalReflectionAtItsLimit) {
  StressCase wrong(
      kArea,
      "wrong verdicts on total reflection, critical angle +-1e-15 to 1e-1, beyond rounding [count]",
      kReference, 0);
  StressCase directions(kArea,
                        "refraction just below the critical angle, direction times cos t [1]",
                        kReference, 1e-15);
  double count = 0;
  for (const double index : {1 + 1e-6, 1.0003, 1.5, 3.9})
    for (double d = 1e-1; d > 1e-15; d /= 2)
      for (const double side : {1.0, -1.0}) {
        const double sine = (1 + side * d) / index;
        if (!(sine < 1)) continue;
        const Vec3 direction = normalize({sine, 0, -std::sqrt((1 - sine) * (1 + sine))});
        // A plane from glass to air.
        KernelCamera<double> camera{};
        camera.surface_count = 1;
        camera.surfaces[0] = {0, 0, 1, index, (1 - index) * (1 + index)};
        camera.refracts[0] = true;
        for (int i = 0; i < 3; ++i) camera.rotation[4 * i] = 1;
        std::vector<std::vector<double>> columns(7, std::vector<double>(kBlockRays));
        std::vector<int> code(kBlockRays);
        for (std::size_t i = 0; i < static_cast<std::size_t>(kBlockRays); ++i) {
          columns[3][i] = direction.x;
          columns[5][i] = -direction.z;
        }
        camera_kernels<double>(best_isa())
            .trace_lens(camera, 16,
                        {columns[0].data(),
                         columns[1].data(),
                         columns[2].data(),
                         columns[3].data(),
                         columns[4].data(),
                         columns[5].data(),
                         columns[6].data(),
                         {},
                         code.data()});
        QuadRay exact{QuadVec{0, 0, 0}, QuadVec{direction.x, 0, -direction.z}};
        exact.direction = unit(exact.direction);
        const QuadRefraction r = quad_refract(exact, 0, kInfinity, index, 1);
        const bool reflected = code[0] != 0;
        const double margin = std::fabs(static_cast<double>(r.cos2_out));
        if (margin > 8 * index * index * std::numeric_limits<double>::epsilon())
          count += reflected != (r.status == RayStatus::total_internal_reflection);
        if (!reflected && r.status == RayStatus::reached)
          directions.add(distance({columns[3][0], columns[4][0], columns[5][0]}, exact.direction) *
                             std::sqrt(margin) / (index * index),
                         text("index", index) + text(", 1 - sine/critical", d));
      }
  wrong.add(count, "-");
}

// The last lens and pixel of the largest sensor among the presets: 18 mm from the axis.
TEST(OpticsStress, FarCornerOfTheLargestSensor) {
  StressCase centres(kArea, "centres of microlenses in the corner of raytrix-r29 [pitch]",
                     kReference, 3e-14);
  StressCase points(kArea, "rays through these microlenses, front face [path]", kReference, 1e-14);
  const CameraSpec spec = test::preset_camera("raytrix-r29");
  const Camera camera(spec);
  const Vec2 corner = camera.sensor_point(0, 0);
  const double reach = 3 * spec.array.pitch;
  const Quad cos30 = test::quad_sqrt(Quad(3)) / 2;
  for (const LensIndex lens : camera.lattice().within(corner - Vec2{reach, reach}, corner)) {
    const Vec2 centre = camera.lattice().centre(lens);
    const Quad pitch = spec.array.pitch;
    const QuadVec exact_centre{pitch * (Quad(lens.q) + Quad(lens.r) / 2),
                               pitch * cos30 * Quad(lens.r), 0};
    centres.add(distance({centre.x, centre.y, 0}, exact_centre) / spec.array.pitch, "corner");
    const Microlens& type =
        camera.microlenses()[static_cast<std::size_t>(camera.lattice().type(lens))];
    for (const double part : {0.0, 0.4, 0.9})
      for (const Vec2 pixel : {Vec2{0.5, 0.5}, Vec2{20.5, 9.5}}) {
        const Vec2 from = camera.sensor_point(pixel.x, pixel.y);
        if (length(from - centre) > spec.array.pitch) continue;
        const Vec2 aim = centre + 0.5 * part * spec.array.diameter * Vec2{0.6, -0.8};
        const Camera::Path path = camera.trace(from, lens, aim, true);
        if (path.points.size() < 3) continue;
        // In coordinates of the microlens, upwards.
        QuadRay ray{
            QuadVec{Quad(from.x) - centre.x, Quad(from.y) - centre.y, Quad(camera.sensor())},
            QuadVec{Quad(aim.x) - from.x, Quad(aim.y) - from.y,
                    Quad(camera.array_back()) - camera.sensor()}};
        ray.direction = unit(ray.direction);
        const QuadVec start = ray.origin;
        // radius > 0 is convex towards the sensor (back) or the scene (front).
        const QuadRefraction back =
            quad_refract(ray, Quad(camera.array_back()), -type.radius_back, 1, type.index);
        const QuadRefraction front =
            quad_refract(ray, Quad(camera.array_front()), type.radius_front, type.index, 1);
        if (back.status != RayStatus::reached || front.status != RayStatus::reached) continue;
        const Vec3 found = path.points[2];
        points.add(distance({Quad(found.x) - centre.x, Quad(found.y) - centre.y, Quad(found.z)},
                            ray.origin) /
                       distance(ray.origin, start),
                   "corner");
      }
  }
}

}  // namespace
}  // namespace plenoflame::optics_stress_test
