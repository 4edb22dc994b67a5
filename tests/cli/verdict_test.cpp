#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"
#include "plenoflame/volumes/reconstruct_verdict.h"
#include "reconstruct_settings.h"

namespace plenoflame::verdict_test {
namespace {

TEST(Verdict, NamesAnAbsorptionBeyondTwoStatedErrors) {
  ReconstructResult result;
  result.figures.suspects = {{SuspectKind::absorption, 0, 0.3, 0.02, true},
                             {SuspectKind::exposure, 1, 0.05, 0.003, true},
                             {SuspectKind::up, 0, 1e-3, 1e-3, false}};
  const auto sentences = [&](double stated) {
    result.figures.absorption_error = stated;
    return what_is_wrong(result, UnknownKind::voxels, {"front", "side"});
  };
  for (const double stated : {0.0, 0.149}) {
    ASSERT_EQ(sentences(stated).size(), 2U) << stated;
    EXPECT_NE(sentences(stated)[0].find("absorption is 30"), std::string::npos);
  }
  ASSERT_EQ(sentences(0.151).size(), 1U);
  EXPECT_NE(sentences(0.151)[0].find("side"), std::string::npos);
}

TEST(Verdict, SaysWhetherNoiseExplainsThePictures) {
  const auto unknowns = make_layer_unknowns({{}, {1, 1, 1}, 1});
  ReconstructResult result;
  result.figures.complete = true;
  result.estimate.emission = {2};
  result.estimate.emission_deviation = {0.2};
  result.figures.noise_factor = 1.3;
  for (const bool explained : {true, false}) {
    result.figures.explained_by_noise = explained;
    const std::string words = verdict(result, *unknowns, UnknownKind::layers, {"front"});
    EXPECT_NE(words.find("known to 10 %"), std::string::npos) << words;
    EXPECT_EQ(words.find("within their noise") != std::string::npos, explained) << words;
    EXPECT_EQ(words.find("1.3 times their noise") != std::string::npos, !explained) << words;
  }
}

TEST(Options, StandBesideTheMessagesOfErrorsThatTheyMend) {
  EXPECT_EQ(kOptionNames.message(InputError("a")), "a");
  EXPECT_EQ(kOptionNames.message(mended_by(InputError("a"), {"region", "margin"})),
            "a (--region, --margin)");
}

TEST(SettingNames, AreWrittenAsTheCallerWritesThem) {
  const auto written = [](const SettingNames& names) {
    return names("absorption-error") + ", " + names("solver", "mart") + ", " + names("memory", "0");
  };
  EXPECT_EQ(written(kOptionNames), "--absorption-error, --solver mart, --memory 0");
  EXPECT_EQ(written({}), "absorption_error, solver='mart', memory=0");
  EXPECT_EQ(written(kWordNames), "absorption error, solver mart, memory 0");
}

TEST(Settings, OfARequestAreSetByName) {
  ReconstructRequest request;
  set_option(request, "iterations", "7");
  set_option(request, "spread", "1 m, 0 m, 0 m");
  set_option(request, "spread", "2 m, 0 m, 0 m");
  set_option(request, "strength", "0.5");
  set_option(request, "unknowns", "rings");
  EXPECT_EQ(request.iterations, 7);
  EXPECT_EQ(request.spreads.size(), 2U);
  EXPECT_EQ(request.strength, 0.5);
  EXPECT_EQ(request.unknowns.kind, UnknownKind::rings);
  const auto refusal = [&](const char* name, const char* text) -> std::string {
    try {
      set_option(request, name, text);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("absorption-error", "2"), "absorption_error: 2 is not a number from 0 to 1");
  EXPECT_NE(refusal("solver", "mat").find("solver: 'mat' is not one of"), std::string::npos);
  EXPECT_EQ(refusal("colour", "red"), "there is no setting colour");
}

}  // namespace
}  // namespace plenoflame::verdict_test
