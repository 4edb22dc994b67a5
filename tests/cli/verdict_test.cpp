#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"
#include "reconstruct_verdict.h"

namespace plenoflame::verdict_test {
namespace {

TEST(Verdict, NamesAnAbsorptionBeyondTwoStatedErrors) {
  ReconstructResult result;
  result.figures.suspects = {{SuspectKind::absorption, 0, 0.3, 0.02, true},
                             {SuspectKind::exposure, 1, 0.05, 0.003, true},
                             {SuspectKind::up, 0, 1e-3, 1e-3, false}};
  const auto sentences = [&](double stated) {
    result.figures.absorption_error = stated;
    return what_is_wrong(result, "voxels", {"front", "side"});
  };
  for (const double stated : {0.0, 0.149}) {
    ASSERT_EQ(sentences(stated).size(), 2U) << stated;
    EXPECT_NE(sentences(stated)[0].find("absorption is 30"), std::string::npos);
  }
  ASSERT_EQ(sentences(0.151).size(), 1U);
  EXPECT_NE(sentences(0.151)[0].find("side"), std::string::npos);
}

TEST(Options, StandBesideTheMessagesOfErrorsThatTheyMend) {
  EXPECT_EQ(message_with_options(InputError("a")), "a");
  EXPECT_EQ(message_with_options(mended_by(InputError("a"), {"region", "margin"})),
            "a (--region, --margin)");
}

}  // namespace
}  // namespace plenoflame::verdict_test
