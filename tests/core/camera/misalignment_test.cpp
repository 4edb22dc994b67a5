// Cameras that are not mounted as they should be: laws and closed forms of moved, tilted and
// unequal lenses, and the vector kernels against the path in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "camera/block_tracing.h"
#include "plenoflame/camera/camera.h"
#include "support/approx.h"
#include "support/isas.h"
#include "support/small_scene.h"

namespace plenoflame::test::misalignment_test {
namespace {

CameraSpec hexagonal(LensModel model = LensModel::real) {
  return small_scene(model == LensModel::real ? singlet() : ideal_singlet(),
                     large_array(Lattice::hexagonal, model))
      .camera;
}

struct Draw {
  std::mt19937_64 random{5};
  std::uniform_real_distribution<double> uniform{-1, 1};
  double operator()() { return uniform(random); }
  Vec2 pair(double size) { return {size * (*this)(), size * (*this)()}; }
};

// Moving the lens is moving everything else the other way.
TEST(Misalignment, DecentredLensIsAShiftedArray) {
  for (const LensModel model : {LensModel::real, LensModel::ideal}) {
    const CameraSpec spec = hexagonal(model);
    const Vec2 d{1.3e-3, -0.7e-3};
    CameraSpec moved = spec, shifted = spec;
    moved.lens.decentre = d;
    shifted.array.offset = spec.array.offset - d;
    const Camera a(moved), b(shifted);
    EXPECT_TRUE(a.foot() == d);
    Draw draw;
    int reached = 0;
    for (int i = 0; i < 500; ++i) {
      const Vec2 s = draw.pair(5e-3);
      const LensIndex lens = a.lattice().nearest(s);
      const Vec3 place = a.lens_place(lens);
      const Vec2 aim = Vec2{place.x, place.y} + draw.pair(0.3e-3);
      const Camera::Path one = a.trace(s, lens, aim), other = b.trace(s - d, lens, aim - d);
      ASSERT_EQ(one.status, other.status);
      if (one.status.status != RayStatus::reached) continue;
      ++reached;
      const Vec3 back = one.exit.origin - Vec3{d.x, d.y, 0};
      EXPECT_TRUE(within(length(back - other.exit.origin), 0, 1e-12, 1));
      EXPECT_TRUE(within(length(one.exit.direction - other.exit.direction), 0, 1e-12, 1));
    }
    EXPECT_GT(reached, 100);
  }
}

// A ball is the same from all sides: tilted around its front vertex it has only moved.
TEST(Misalignment, TiltedBallAsMainLens) {
  const double r = 0.05;
  CameraSpec spec = small_scene(singlet(), {}).camera;
  spec.lens.surfaces = {{r, 2 * r, 1.5, 1.2 * r, true}, {-r, 0, 1, 1.2 * r, false}};
  spec.focus = {FocusMode::distance, 0.03, 0, "sensor"};
  spec.lens.tilt = {0.05, -0.08};
  const Camera camera(spec);
  const Vec3 centre{0, 0, -r};
  const Vec3 shift = rotation_xyz({0.05, -0.08, 0}) * centre - centre;
  const LensSystem ball(spec.lens.surfaces);
  Draw draw;
  for (int i = 0; i < 200; ++i) {
    const Vec2 s = draw.pair(1e-3), aim = draw.pair(3e-3);
    const Camera::Path path = camera.trace(s, std::nullopt, aim);
    const Vec3 start{s.x, s.y, camera.sensor()};
    Ray ray{start - shift, normalize(Vec3{aim.x, aim.y, camera.aim_plane(0)} - start)};
    ASSERT_EQ(path.status.status, RayStatus::reached);
    ASSERT_EQ(ball.trace_to_scene(ray).status, RayStatus::reached);
    EXPECT_TRUE(within(length(path.exit.origin - (ray.origin + shift)), 0, 1e-12, r));
    EXPECT_TRUE(within(length(path.exit.direction - ray.direction), 0, 1e-12, 1));
  }
}

// Balls as microlenses, of a tilted array with focal lengths of their own: where the spheres are
// and how they refract is plain geometry.
TEST(Misalignment, TiltedArrayOfBalls) {
  CameraSpec spec = hexagonal();
  const double r = 0.6e-3, index = 1.5;
  spec.array.types = {{"ball", r, r, index, 0}};
  spec.array.thickness = 2 * r;
  spec.array.diameter = 0.5e-3;
  spec.array.tilt = {0.06, 0.1};
  spec.lens.tilt = {};
  const Camera camera(spec);
  const Mat3 turn = rotation_xyz({0.06, 0.1, 0});
  const Vec3 pivot{0, 0, camera.array_front()};
  Draw draw;
  int met = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec2 s = draw.pair(5e-3);
    const LensIndex lens = camera.lattice().nearest(s);
    const Vec2 cell = camera.lattice().centre(lens);
    const Vec3 centre = pivot + turn * Vec3{cell.x, cell.y, -r};
    const Vec3 place = camera.lens_place(lens);
    EXPECT_TRUE(within(length(place - (pivot + turn * Vec3{cell.x, cell.y, -2 * r})), 0, 1e-15, 1));
    const Camera::Path path =
        camera.trace(s, lens, Vec2{place.x, place.y} + draw.pair(0.1e-3), true);
    if (path.points.size() < 4) continue;
    ++met;
    const Vec3 &p0 = path.points[0], &p1 = path.points[1], &p2 = path.points[2],
               &p3 = path.points[3];
    EXPECT_TRUE(relative(length(p1 - centre), r, 1e-11));
    EXPECT_TRUE(relative(length(p2 - centre), r, 1e-11));
    // n sin is the same on both sides, in one plane.
    const auto snell = [&](Vec3 a, Vec3 at, Vec3 b, double before, double behind) {
      const Vec3 n = (1 / r) * (at - centre);
      const Vec3 in = before * cross(normalize(at - a), n),
                 out = behind * cross(normalize(b - at), n);
      EXPECT_TRUE(within(length(in - out), 0, 1e-10, 1));
    };
    snell(p0, p1, p2, 1, index);
    snell(p1, p2, p3, index, 1);
  }
  EXPECT_GT(met, 100);
}

TEST(Misalignment, FocalJitterIsSeededAndStaysInItsRange) {
  ArraySpec array = hexagonal().array;
  array.focal_jitter = 0.03;
  const MicrolensLattice one(array);
  array.jitter_seed = 2;
  const MicrolensLattice other(array);
  double sum = 0, squares = 0, count = 0;
  for (int q = -60; q <= 60; ++q)
    for (int r = -60; r <= 60; ++r) {
      const double x = (one.focal_factor({q, r}) - 1) / 0.03;
      EXPECT_LE(std::fabs(x), 1);
      EXPECT_EQ(one.focal_factor({q, r}) == other.focal_factor({q, r}), q == 0 && r == 0);
      sum += x, squares += x * x, count += 1;
    }
  // Uniform from -1 to 1.
  EXPECT_TRUE(within_standard_errors(sum / count, 0, std::sqrt(1 / (3 * count)), 5));
  EXPECT_TRUE(within_standard_errors(squares / count, 1.0 / 3, std::sqrt(4 / (45 * count)), 5));
}

// An ideal microlens bends a ray by its height over its own focal length.
TEST(Misalignment, EveryLensHasItsFocalLength) {
  CameraSpec spec = hexagonal(LensModel::ideal);
  spec.array.focal_jitter = 0.1;
  const Camera camera(spec);
  for (int q = -3; q <= 3; ++q) {
    const LensIndex lens{q, 1};
    const Vec3 place = camera.lens_place(lens);
    const Microlens& type =
        camera.microlenses()[static_cast<std::size_t>(camera.lattice().type(lens))];
    const double h = 0.2e-3;
    // Parallel to the axis, h beside the middle; the main lens' principal plane is where it went.
    const Camera::Path path =
        camera.trace({place.x + h, place.y}, lens, {place.x + h, place.y}, true);
    const double focal = type.first_order.focal_length * camera.lattice().focal_factor(lens);
    const double way = path.points[2].z - type.front_principal;
    EXPECT_TRUE(relative(path.points[2].x - place.x, h * (1 - way / focal), 1e-12)) << q;
  }
}

TEST(Misalignment, AlignedIsThePerfectCamera) {
  CameraSpec spec = hexagonal();
  spec.array.centre_jitter = 0;
  spec.array.spacing_error = 1e-5;
  const Camera straight(spec);
  spec.lens.decentre = {1e-3, 0};
  spec.array.focal_jitter = 0.1;
  spec.array.tilt = {0.01, 0};
  const Camera camera(spec);
  EXPECT_TRUE(camera.misaligned());
  const Camera aligned = camera.aligned();
  EXPECT_FALSE(aligned.misaligned());
  EXPECT_TRUE(relative(aligned.sensor(), straight.sensor(), 1e-14));
  EXPECT_TRUE(relative(aligned.array_front(), straight.array_front(), 1e-14));
  const Camera::Path a = aligned.trace({1e-3, 0}, LensIndex{1, 0}, {1.1e-3, 0});
  const Camera::Path b = straight.trace({1e-3, 0}, LensIndex{1, 0}, {1.1e-3, 0});
  EXPECT_EQ(a.status, b.status);
  EXPECT_TRUE(within(length(a.exit.origin - b.exit.origin), 0, 1e-11, 1));
}

/// Rays through the kernels against Camera::trace, in the plane of an anchor 1 m ahead.
template <class Real>
void follow(const CameraSpec& spec, double tolerance, double direction_tolerance) {
  const Camera camera(spec);
  const Vec3 anchor{2e-3, -1e-3, 1};
  const auto kernel = kernel_camera<Real>(camera, anchor, RigidTransform{});
  const auto types = kernel_microlenses<Real>(camera);
  constexpr int kRays = 64;
  for (const Isa isa : supported_isas()) {
    const CameraKernels<Real> kernels = camera_kernels<Real>(isa);
    Draw draw;
    int reached = 0, differ = 0;
    for (int repeat = 0; repeat < 40; ++repeat) {
      const Vec2 near = draw.pair(4e-3);
      const LensIndex lens = camera.lattice().nearest(near);
      KernelMicrolens<Real> own = types[static_cast<std::size_t>(camera.lattice().type(lens))];
      if (camera.misaligned()) set_lens(camera, lens, own);
      const Vec3 place = camera.lens_place(lens);
      struct alignas(64) Arrays {
        Real values[9][kBlockRays + kBlockSlack];
        int code[kBlockRays + kBlockSlack];
      };
      const auto arrays = std::make_unique<Arrays>();
      auto& v = arrays->values;
      const KernelBlock<Real> block{v[0], v[1], v[2],         v[3],        v[4],
                                    v[5], v[6], {v[7], v[8]}, arrays->code};
      std::vector<Camera::Path> exact;
      for (int i = 0; i < kRays; ++i) {
        const Vec2 s = draw.pair(0.6e-3), u = draw.pair(0.35e-3);
        const double z = place.z - camera.sensor();
        const Vec3 d = normalize({u.x - s.x, u.y - s.y, z});
        v[0][i] = static_cast<Real>(u.x), v[1][i] = static_cast<Real>(u.y), v[2][i] = 0;
        v[3][i] = static_cast<Real>(d.x), v[4][i] = static_cast<Real>(d.y);
        v[5][i] = static_cast<Real>(d.z), v[6][i] = 1;
        arrays->code[i] = 0;
        const Vec2 middle{place.x, place.y};
        exact.push_back(camera.trace(middle + s, lens, middle + u));
      }
      kernels.pass_microlens(own, static_cast<Real>(place.x), static_cast<Real>(place.y), 0, kRays,
                             block);
      kernels.trace_lens(kernel, kRays, block);
      for (int i = 0; i < kRays; ++i) {
        const Camera::Path& path = exact[static_cast<std::size_t>(i)];
        const bool passes = path.status.status == RayStatus::reached;
        differ += passes != (arrays->code[i] == 0);
        if (!passes || arrays->code[i] != 0) continue;
        ++reached;
        const Vec3 d = path.exit.direction;
        // The kernel leaves rays in the plane through the anchor across the lens' axis.
        const Vec3 p{static_cast<double>(v[0][i]) + anchor.x,
                     static_cast<double>(v[1][i]) + anchor.y,
                     static_cast<double>(v[2][i]) + anchor.z};
        const Vec3 off = p - path.exit.origin;
        EXPECT_TRUE(within(length(off - dot(off, d) * d), 0, tolerance, 1));
        const Vec3 k{static_cast<double>(v[3][i]), static_cast<double>(v[4][i]),
                     static_cast<double>(v[5][i])};
        EXPECT_TRUE(within(length(k - d), 0, direction_tolerance, 1));
      }
    }
    EXPECT_GT(reached, 200);
    EXPECT_LE(differ, sizeof(Real) == 4 ? 5 : 0);  // at the rims of apertures
  }
}

TEST(Misalignment, KernelsFollowTheDoublePath) {
  for (const LensModel model : {LensModel::real, LensModel::ideal}) {
    CameraSpec spec = hexagonal(model);
    spec.lens.decentre = {1e-3, -2e-3};
    spec.lens.tilt = {0.01, 0.02};
    spec.array.tilt = {0.04, -0.03};
    spec.array.focal_jitter = 0.05;
    follow<double>(spec, 1e-12, 1e-12);
    follow<float>(spec, 1e-5, 2e-6);
  }
}

TEST(Misalignment, AsphericKernelsFollowTheDoublePath) {
  CameraSpec spec = hexagonal();
  spec.lens.surfaces[0].conic = -0.8;
  spec.lens.surfaces[1].conic = 0.5;
  spec.lens.surfaces[1].aspheric = {1.2, 0, -900, 0, 0, 0, 1e9};
  follow<double>(spec, 1e-12, 1e-12);
  follow<float>(spec, 1e-5, 2e-6);
}

TEST(Misalignment, BiconicKernelsFollowTheDoublePath) {
  CameraSpec spec = hexagonal();
  SurfaceSpec& surface = spec.lens.surfaces[0];
  surface.radius = std::numeric_limits<double>::infinity();
  surface.radius_x = 0.25, surface.radius_y = 0.4;
  surface.conic_x = -1.5, surface.conic_y = 0.7;
  ASSERT_FALSE(Camera(spec).lens_is_round());
  ASSERT_TRUE(Camera(spec).misaligned());
  ASSERT_FALSE(Camera(spec).aligned().misaligned());
  follow<double>(spec, 1e-12, 1e-12);
  follow<float>(spec, 1e-5, 2e-6);
}

}  // namespace
}  // namespace plenoflame::test::misalignment_test
