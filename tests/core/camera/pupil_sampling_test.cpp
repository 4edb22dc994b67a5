#include "plenoflame/camera/pupil_sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "support/approx.h"
#include "support/cameras.h"

namespace plenoflame::test::pupil_sampling_test {
namespace {

void expect_same_cuts(const PupilNode& a, const PupilNode& b) {
  for (int i = 0; i < 40; ++i) {
    const double angle = 0.7 * i, distance = a.outer_radius * i / 40;
    const Vec2 place{distance * std::cos(angle), distance * std::sin(angle)};
    const double half = 0.03 * a.outer_radius;
    const PixelView p = a.cuts.look(place, half, {0.6, 0.8});
    const PixelView q = b.cuts.look(place, half, {0.6, 0.8});
    ASSERT_EQ(p.dark, q.dark);
    ASSERT_EQ(p.open, q.open);
    for (const double off : {-half, 0.0, half}) {
      const auto at = static_cast<float>(distance + off);
      ASSERT_EQ(cut_at(*p.column, at), cut_at(*q.column, at));
    }
  }
}

TEST(PupilSampling, TablesAreTheSameForAnyNumberOfThreads) {
  // A wide field: it needs many nodes.
  const CameraSpec plain = preset_camera("raytrix-r29");
  CameraSpec tilted = plain;
  tilted.array.tilt = {0.004, -0.002};
  for (const CameraSpec& spec : {plain, tilted}) {
    const Camera camera(spec);
    const PupilSampling one(camera, one_thread());
    for (const int count : {2, 7}) {
      const PupilSampling many(camera, threads(count));
      ASSERT_EQ(many.tables().size(), 3u);
      for (std::size_t type = 0; type < 3; ++type) {
        const PupilTable &a = one.tables()[type], &b = many.tables()[type];
        ASSERT_EQ(a.nodes.size(), b.nodes.size());
        int lit = 0;
        for (std::size_t i = 0; i < a.nodes.size(); ++i) {
          const PupilNode &n = a.nodes[i], &m = b.nodes[i];
          ASSERT_EQ(n.dark(), m.dark());
          if (n.dark()) continue;
          ++lit;
          EXPECT_EQ(n.centre, m.centre);
          EXPECT_EQ(n.outer_radius, m.outer_radius);
          EXPECT_EQ(n.opened, m.opened);
          EXPECT_EQ(a.edges[i].size(), b.edges[i].size());
          expect_same_cuts(n, m);
        }
        EXPECT_GT(lit, 20);
      }
    }
  }
}

/// Share of a microlens' aperture through which rays from its sensor points at these distances
/// from the micro-image's centre leave the camera: traced, one by one.
double traced_share(const Camera& camera, LensIndex lens, const PupilTable& table,
                    const PupilNode& node, double from, double to) {
  constexpr int kAzimuths = 16, kDistances = 5, kRings = 10, kSpokes = 16;
  const Vec3 middle = camera.lens_place(lens);
  const Vec2 place{middle.x, middle.y}, outward = place - camera.foot();
  const Vec2 field = (1 / length(outward)) * outward;
  int open = 0;
  for (int a = 0; a < kAzimuths; ++a)
    for (int d = 0; d < kDistances; ++d) {
      const double angle = 2 * std::numbers::pi * (a + 0.5) / kAzimuths;
      const double distance = from + (to - from) * (d + 0.5) / kDistances;
      const Vec2 s = node.centre * field + distance * Vec2{std::cos(angle), std::sin(angle)};
      for (int i = 0; i < kRings * kSpokes; ++i) {
        const double r = table.discs.radius_at(s) * std::sqrt((i % kRings + 0.5) / kRings);
        const double turn = 2 * std::numbers::pi * (i / kRings + 0.31) / kSpokes;
        const Vec2 u = table.discs.far_centre(s) + r * Vec2{std::cos(turn), std::sin(turn)};
        open += camera.trace(place + s, lens, place + u).status.status == RayStatus::reached;
      }
    }
  return open / double(kAzimuths * kDistances * kRings * kSpokes);
}

// The unvignetted share decides how many rays a pixel is worth.
TEST(PupilSampling, MeanShareOfTheApertureThatIsOpen) {
  const Camera camera(preset_camera("paper-plenoptic2"));
  const PupilSampling pupils(camera, threads(2));
  for (const Vec2 at : {Vec2{2e-4, 1e-4}, Vec2{-7e-3, 9e-3}}) {
    std::array<bool, 3> done{};
    for (const LensIndex lens :
         camera.lattice().within(at - Vec2{3e-4, 3e-4}, at + Vec2{3e-4, 3e-4})) {
      const auto type = static_cast<std::size_t>(camera.lattice().type(lens));
      if (std::exchange(done[type], true)) continue;
      const PupilTable& table = pupils.tables()[type];
      const Vec3 place = camera.lens_place(lens);
      const PupilNode node = table.at(length(Vec2{place.x, place.y} - camera.foot()));
      const double half = 0.5 * camera.spec().sensor.pixel_pitch;
      double dimmest = 1;
      for (const double share : {0.0, 0.3, 0.6, 0.8, 0.9, 1.0}) {
        const double distance = share * node.outer_radius;
        const double expected = traced_share(camera, lens, table, node,
                                             std::max(distance - half, 0.0), distance + half);
        EXPECT_TRUE(within(OpenShare(node, half).mean(distance), expected, 0.03, 1))
            << type << " at " << share;
        dimmest = std::min(dimmest, expected);
      }
      EXPECT_LT(dimmest, 0.1);
    }
    EXPECT_TRUE(done[0] && done[1] && done[2]);
  }
}

// Micro-images of tilted arrays may reach farther; within them as much is open, of apertures that
// are taken to be a little larger.
TEST(PupilSampling, TiltedArraysSeeAsMuchOpen) {
  CameraSpec spec = preset_camera("paper-plenoptic2");
  const double half = 0.5 * spec.sensor.pixel_pitch;
  const PupilSampling straight(Camera(spec), threads(2));
  spec.array.tilt = {0.003, 0};
  const PupilSampling tilted(Camera(spec), threads(2));
  for (std::size_t type = 0; type < 3; ++type)
    for (const double h : {0.0, 3e-3, 8e-3}) {
      const PupilNode a = straight.tables()[type].at(h), b = tilted.tables()[type].at(h);
      EXPECT_GT(b.outer_radius, a.outer_radius);
      const OpenShare expected(a, half), found(b, half);
      for (const double part : {0.0, 0.3, 0.6, 0.9})
        EXPECT_TRUE(within(found.mean(part * a.outer_radius), expected.mean(part * a.outer_radius),
                           0.15, 1))
            << type << " at " << h << ", " << part;
    }
}

}  // namespace
}  // namespace plenoflame::test::pupil_sampling_test
