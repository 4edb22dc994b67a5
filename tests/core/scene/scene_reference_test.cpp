#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "plenoflame/scene/scene_schema.h"
#include "scene_samples.h"
#include "support/source_folder.h"

namespace plenoflame::scene_reference_test {
namespace {

// The committed page is the generated one. With PLENOFLAME_UPDATE_DOCS set, the test
// writes it first.
TEST(SceneReference, CommittedPageIsTheGeneratedOne) {
  const std::string page = scene_reference_markdown();
  if (std::getenv("PLENOFLAME_UPDATE_DOCS"))
    std::ofstream(PLENOFLAME_SOURCE_DIR "/docs/reference/scene.md", std::ios::binary) << page;
  EXPECT_EQ(test::source_text("docs/reference/scene.md"), page)
      << "run this test with PLENOFLAME_UPDATE_DOCS=1 and commit docs/reference/scene.md";
}

TEST(SceneReference, NamesEveryKeyAndPreset) {
  const std::string page = scene_reference_markdown();
  for (const SchemaKey& key : schema_keys()) {
    EXPECT_NE(page.find("| `" + std::string(key.path.substr(key.path.rfind('.') + 1)) + "` |"),
              std::string::npos);
    EXPECT_NE(page.find(key.description), std::string::npos) << key.path;
  }
  for (const PresetKind kind : {PresetKind::camera, PresetKind::flame})
    for (const std::string& name : preset_names(kind))
      EXPECT_NE(page.find("`" + name + "`"), std::string::npos);
}

}  // namespace
}  // namespace plenoflame::scene_reference_test
