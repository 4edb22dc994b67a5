// The rate at which the error falls with the number of samples.
#include "statistical/measured_errors.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"

namespace plenoflame::test::convergence_test {
namespace {

TEST(Convergence, PaperFlameWithClippedApertures) {
  EXPECT_LT(convergence_slope(compile(paper_flame(300, 300)), {140, 140, 24, 24}), -0.65);
}

TEST(Convergence, WhereThePupilIsNotClipped) {
  EXPECT_LT(convergence_slope(compile(bare_flame(200, 170, 1e-4)), {90, 75, 20, 20}), -1.2);
}

}  // namespace
}  // namespace plenoflame::test::convergence_test
