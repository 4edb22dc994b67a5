// Boards at known places before two cameras: the second camera's place comes back, and what noise
// makes of it lies within its stated error.
#include "plenoflame/calibration/camera_rig.h"

#include <gtest/gtest.h>

#include <random>

#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::test::camera_rig_test {
namespace {

struct Boards {
  std::vector<RigidTransform> first, second;
};

const RigidTransform kSecondToFirst{rotation_xyz({0.1, -0.4, 0.2}), {0.2, -0.03, 0.05}};

Boards boards(double noise) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> error(0, noise);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Boards all;
  for (int k = 0; k < 12; ++k) {
    const RigidTransform world{
        rotation_xyz({0.5 * uniform(random), 0.5 * uniform(random), uniform(random)}),
        {0.02 * uniform(random), 0.02 * uniform(random), 0.4 + 0.05 * uniform(random)}};
    const RigidTransform back = kSecondToFirst.inverse();
    RigidTransform other{back.rotation * world.rotation, back.point(world.translation)};
    other.translation = other.translation + Vec3{error(random), error(random), error(random)};
    all.first.push_back(world);
    all.second.push_back(other);
  }
  return all;
}

double apart(const RelativePose& found) {
  return length(found.to_first.translation - kSecondToFirst.translation);
}

TEST(CameraRig, WithoutNoiseThePlaceItself) {
  const Boards all = boards(0);
  const RelativePose found = register_cameras(all.first, all.second, 0.05);
  EXPECT_LT(apart(found), 1e-12 * length(kSecondToFirst.translation) + 1e-14);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_LT(length(found.to_first.rotation.rows[k] - kSecondToFirst.rotation.rows[k]), 1e-12);
  EXPECT_LT(found.rms, 1e-14);
}

TEST(CameraRig, NoiseStaysWithinTheStatedError) {
  const Boards all = boards(1e-4);
  const RelativePose found = register_cameras(all.first, all.second, 0.05);
  EXPECT_LT(apart(found), 4 * found.place_error);
  EXPECT_GT(found.place_error, 1e-5);
  EXPECT_LT(found.place_error, 1e-2);
  // Four points of each board move by one error: what the fit leaves is about that error.
  EXPECT_TRUE(relative(found.rms, std::sqrt(3.0) * 1e-4, 0.35));
}

TEST(CameraRig, NeedsABoard) {
  EXPECT_THROW(register_cameras({}, {}, 0.05), InputError);
}

}  // namespace
}  // namespace plenoflame::test::camera_rig_test
