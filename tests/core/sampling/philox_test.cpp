#include "plenoflame/sampling/philox.h"

#include <gtest/gtest.h>

namespace plenoflame::philox_test {
namespace {

using Words = std::array<std::uint32_t, 4>;

// Known answers that the authors publish with Random123 (kat_vectors, philox4x32 with 10 rounds).
TEST(Philox, KnownAnswers) {
  EXPECT_EQ(philox({0, 0, 0, 0}, {0, 0}),
            (Words{0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u}));
  EXPECT_EQ(philox({~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}),
            (Words{0x408f276du, 0x41c83b0eu, 0xa20bc7c6u, 0x6d5451fdu}));
  EXPECT_EQ(
      philox({0x243f6a88u, 0x85a308d3u, 0x13198a2eu, 0x03707344u}, {0xa4093822u, 0x299f31d0u}),
      (Words{0xd16cfe09u, 0x94fdccebu, 0x5001e420u, 0x24126ea1u}));
}

TEST(Philox, SampleIsCounterAndSeedIsKey) {
  EXPECT_EQ(philox(0x299f31d0a4093822u, 0x85a308d3243f6a88u, 0x0370734413198a2eu),
            (Words{0xd16cfe09u, 0x94fdccebu, 0x5001e420u, 0x24126ea1u}));
}

TEST(Philox, UniformsStayInsideTheUnitInterval) {
  EXPECT_GT(unit_uniform(0u), 0.0);
  EXPECT_LT(unit_uniform(~0u), 1.0);
  EXPECT_GT(unit_uniform(0u, 0u), 0.0);
  EXPECT_LT(unit_uniform(~0u, ~0u), 1.0);
  EXPECT_EQ(unit_uniform(0x80000000u), 0.5 + 0x1p-33);
  EXPECT_EQ(unit_uniform(0x80000000u, 0u), 0.5 + 0x1p-53);
}

}  // namespace
}  // namespace plenoflame::philox_test
