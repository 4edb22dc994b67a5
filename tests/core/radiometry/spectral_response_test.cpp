#include "plenoflame/radiometry/spectral_response.h"

#include <fstream>

#include "plenoflame/base/error.h"
#include "plenoflame/radiometry/source_function.h"
#include "support/approx.h"
#include "support/temporary_folder.h"

namespace plenoflame::spectral_response_test {
namespace {

using test::relative;

/// The message of a call that refuses.
template <class Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing";
}

SpectralResponse some_curve() {
  return SpectralResponse::curve({{400e-9, 0}, {450e-9, 0.5}, {600e-9, 0.25}, {700e-9, 1}});
}

struct Row {
  double temperature, radiance;
};

// mpmath, 30 digits: the filter to 4 standard deviations, and the curve above.
TEST(SpectralResponse, ChannelsAreIntegratedToTwelveDigits) {
  const SourceFunction line = SourceFunction::of(SpectralResponse::gaussian(650e-9, 20e-9));
  for (const Row row : {Row{200, 4.6183790462783545206e-41}, Row{1650, 32.746984089751003607},
                        Row{1e5, 88341045.843360991216}})
    EXPECT_TRUE(relative(line(row.temperature), row.radiance, 1e-12)) << row.temperature;
  const SourceFunction curve = SourceFunction::of(some_curve());
  for (const Row row : {Row{200, 1.099176428553833048e-38}, Row{1650, 124.97573623307123222},
                        Row{1e5, 1099627593.9295330069}})
    EXPECT_TRUE(relative(curve(row.temperature), row.radiance, 1e-12)) << row.temperature;
  EXPECT_LT(curve.nodes().size(), 40u);
}

TEST(SpectralResponse, TheRuleOfABandIsTheBandItself) {
  const SourceFunction rule = SourceFunction::of(SpectralResponse::band(550e-9, 100e-9));
  const SourceFunction band = SourceFunction::band(550e-9, 100e-9);
  for (const double t : {200.0, 1000.0, 1800.0, 6000.0, 1e5})
    EXPECT_TRUE(relative(rule(t), band(t), 1e-12)) << t;
}

TEST(SpectralResponse, CentroidsAndPhotons) {
  EXPECT_TRUE(relative(SpectralResponse::band(650e-9, 30e-9).centroid(), 650e-9, 1e-15));
  EXPECT_TRUE(relative(SpectralResponse::gaussian(589e-9, 5e-9).centroid(), 589e-9, 1e-13));
  EXPECT_TRUE(relative(some_curve().centroid(), 5.7698412698412698413e-7, 1e-13));
  EXPECT_TRUE(
      relative(SourceFunction::of(some_curve().of_photons())(1650), 142.31873151004466466, 1e-12));
}

// The integrals of the tables of CIE 015:2018 at 1 nm are 106.865, 106.857 and 106.892; the fit
// stays within 0.3 % of them. Its maximum is at 555 nm.
TEST(SpectralResponse, TheStandardObserver) {
  const double integrals[] = {106.865, 106.857, 106.892};
  const char* const names[] = {"cie_x", "cie_y", "cie_z"};
  for (int k = 0; k < 3; ++k) {
    const SpectralResponse response = SpectralResponse::named(names[k]);
    double sum = 0;
    for (int w = 360; w <= 830; ++w) sum += response(1e-9 * w);
    EXPECT_TRUE(relative(sum, integrals[k], 3e-3)) << names[k];
  }
  EXPECT_TRUE(relative(SpectralResponse::named("cie_y")(555e-9), 1, 0.01));
  EXPECT_EQ(SpectralResponse::named("cie_y")(300e-9), 0);
}

// As measured (Darrodi et al. 2015): where each colour has its maximum of 1.
TEST(SpectralResponse, ACameraHasItsMaximaWhereTheyWereMeasured) {
  EXPECT_TRUE(relative(SpectralResponse::named("nikon_d5100_red")(595e-9), 1, 0.05));
  EXPECT_TRUE(relative(SpectralResponse::named("nikon_d5100_green")(530e-9), 1, 0.03));
  EXPECT_TRUE(relative(SpectralResponse::named("nikon_d5100_blue")(460e-9), 1, 0.01));
  EXPECT_TRUE(relative(SpectralResponse::named("nikon_d5100_red")(650e-9), 0.343, 0.1));
  for (const NamedResponse& known : response_names()) {
    EXPECT_FALSE(known.source.empty());
    EXPECT_GT(SpectralResponse::named(known.name).centroid(), 400e-9);
  }
}

TEST(SpectralResponse, PointsAsText) {
  const auto points = parse_spectral_points("450 nm 0.2, 0.6 um 1,");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1], (SpectralPoint{600e-9, 1}));
  EXPECT_EQ(parse_spectral_points(format_spectral_points(points)), points);
}

TEST(SpectralResponse, SaysWhatIsWrongWithPoints) {
  const auto said = [](const char* text) { return refusal([&] { parse_spectral_points(text); }); };
  EXPECT_NE(said("450 nm 0.2, 440 nm 1").find("must ascend"), std::string::npos);
  EXPECT_NE(said("450 nm 0.2, 460 nm -1").find("negative"), std::string::npos);
  EXPECT_NE(said("450 nm 0, 460 nm 0").find("above 0"), std::string::npos);
  EXPECT_NE(said("450 nm 1").find("two points"), std::string::npos);
  EXPECT_NE(said("450 1, 460 1").find("unit"), std::string::npos);
  EXPECT_NE(said("2 mm 1, 3 mm 1").find("10 nm and 1 mm"), std::string::npos);
  EXPECT_NE(said("red, blue").find("450 nm 0.2"), std::string::npos);
  const std::string unknown = refusal([] { SpectralResponse::named("kodak"); });
  EXPECT_NE(unknown.find("nikon_d5100_red"), std::string::npos);
  EXPECT_THROW(SpectralResponse::gaussian(650e-9, 0), InputError);
  EXPECT_THROW(SpectralResponse::band(650e-9, 1400e-9), InputError);
}

class SpectralCsv : public ::testing::Test {
 protected:
  std::string file(const std::string& text) {
    const std::string path = folder_.file("curve.csv");
    std::ofstream(path) << text;
    return path;
  }
  std::string said(const std::string& text) {
    const std::string path = file(text);
    return refusal([&] { read_spectral_csv(path); });
  }
  test::TemporaryFolder folder_;
};

TEST_F(SpectralCsv, HeadersAndUnits) {
  const std::vector<SpectralPoint> expected{{450e-9, 0.25}, {650e-9, 1}};
  for (const char* text :
       {"450,0.25\n650,1\n", "# a comment\nwavelength,response\n450, 0.25\n650 ,1 # peak\n",
        "wavelength_um,response\n0.45,0.25\n0.65,1\n", "um;response\n0.45;0.25\n0.65;1\n",
        "wavelength (\xc2\xb5m)\tphotons per nm\n0.45\t0.25\n0.65\t1\n",
        "\xef\xbb\xbf"
        "450,0.25\n650,1\n",
        "wavelength [nm];value\n450;0.25\n650;1\n"}) {
    const auto points = read_spectral_csv(file(text));
    ASSERT_EQ(points.size(), 2u) << text;
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_TRUE(relative(points[i].wavelength, expected[i].wavelength, 1e-15)) << text;
      EXPECT_EQ(points[i].value, expected[i].value) << text;
    }
  }
}

TEST_F(SpectralCsv, GuessesTheUnitThatWasMeant) {
  const std::string um = said("wavelength,response\n0.45,1\n0.65,1\n");
  EXPECT_NE(um.find("curve.csv:2"), std::string::npos) << um;
  EXPECT_NE(um.find("is in um, it seems, and not in nm"), std::string::npos) << um;
  const std::string nm = said("lambda_um,r\n450,1\n650,1\n");
  EXPECT_NE(nm.find("is in nm, it seems, and not in um"), std::string::npos) << nm;
}

TEST_F(SpectralCsv, NamesTheLine) {
  EXPECT_NE(said("450,1\nred,1\n").find("curve.csv:2"), std::string::npos);
  EXPECT_NE(said("450,1\n440,1\n").find("must ascend"), std::string::npos);
  EXPECT_NE(said("450,1\n460,-0.5\n").find("curve.csv:2"), std::string::npos);
  EXPECT_NE(said("").find("two points"), std::string::npos);
  EXPECT_THROW(read_spectral_csv(folder_.file("none.csv")), FileError);
}

}  // namespace
}  // namespace plenoflame::spectral_response_test
