// Glasses against the index at the d line and the Abbe number that the makers print beside their
// coefficients: a wrong digit in one shows in the others.
#include "plenoflame/optics/glass.h"

#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::test::glass_test {
namespace {

double abbe(const Glass& glass) {
  return (glass.index(kLineD) - 1) / (glass.index(kLineF) - glass.index(kLineC));
}

TEST(Glass, CatalogueAgreesWithItsPrintedFigures) {
  EXPECT_GE(glass_catalogue().size(), 30u);
  for (const CatalogueGlass& row : glass_catalogue()) {
    const Glass glass(row.name);
    EXPECT_TRUE(within(glass.index(kLineD), row.nd, 0.6e-5, 1)) << row.name;
    EXPECT_TRUE(within(abbe(glass), row.vd, 0.6e-2, 1)) << row.name;
  }
}

TEST(Glass, Bk7AndSilica) {
  for (const char* name : {"N-BK7", "bk7", "BK7",
                           "sellmeier 1.03961212 0.231792344 1.01046945 0.00600069867 0.0200179144 "
                           "103.560653"}) {
    const Glass bk7(name);
    EXPECT_TRUE(within(bk7.index(kLineD), 1.516800, 6e-7, 1));
    EXPECT_TRUE(within(bk7.index(kLineF), 1.522376, 6e-7, 1));
    EXPECT_TRUE(within(bk7.index(kLineC), 1.514322, 6e-7, 1));
  }
  const Glass silica("fused-silica");
  EXPECT_TRUE(within(silica.index(kLineD), 1.458464, 6e-7, 1));
  EXPECT_TRUE(within(silica.index(kLineF), 1.463126, 6e-7, 1));
  EXPECT_TRUE(within(silica.index(kLineC), 1.456367, 6e-7, 1));
}

TEST(Glass, ModelGlasses) {
  const Glass glass("abbe 1.744 44.7");
  EXPECT_TRUE(relative(glass.index(kLineD), 1.744, 1e-15));
  EXPECT_TRUE(relative(abbe(glass), 44.7, 1e-12));
  EXPECT_TRUE(relative(Glass("constant 1.5").index(1e-6), 1.5, 1e-15));
}

std::string message(const char* text) {
  try {
    Glass(text).index(kLineD);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Glass, NamesMayHaveSpaces) {
  EXPECT_EQ(Glass("fused silica").index(kLineD), Glass("FUSED-SILICA").index(kLineD));
  EXPECT_NE(message("fused silicon").find("did you mean \"FUSED-SILICA\""), std::string::npos);
}

TEST(Glass, Errors) {
  EXPECT_NE(message("N-BK8").find("did you mean \"N-BK7\""), std::string::npos);
  EXPECT_NE(message("LSF").find("no glass \"LSF\""), std::string::npos);
  EXPECT_NE(message("sellmeier 1 2 3").find("6 numbers"), std::string::npos);
  EXPECT_NE(message("sellmeier 1 2 3 4 5 x").find("6 numbers"), std::string::npos);
  EXPECT_NE(message("constant 0.5").find("at least 1"), std::string::npos);
  EXPECT_NE(message("abbe 1.5 -3").find("positive"), std::string::npos);
  EXPECT_NE(message("").find("empty"), std::string::npos);
  // Below the ultraviolet resonance.
  EXPECT_THROW(Glass("N-BK7").index(90e-9), InputError);
  EXPECT_THROW(Glass("N-BK7").index(-1), InputError);
}

}  // namespace
}  // namespace plenoflame::test::glass_test
