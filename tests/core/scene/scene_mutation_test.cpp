#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/scene/presets.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/validate.h"
#include "scene_samples.h"

namespace plenoflame::scene_mutation_test {
namespace {

/// Changes a text in the ways in which files get damaged or mistyped.
class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::string operator()(std::string text) {
    static constexpr const char* kPieces[] = {"\"",
                                              "'''",
                                              "[",
                                              "]]",
                                              "{",
                                              "}",
                                              "=",
                                              "\n",
                                              ",",
                                              ".",
                                              "#",
                                              "\\u0000",
                                              "nan",
                                              "-inf",
                                              "inf",
                                              "1e999",
                                              "-0",
                                              "0x7f",
                                              "99999999999999999999",
                                              "\xFF",
                                              "\xC3",
                                              "preset",
                                              "true",
                                              "[[a]]",
                                              " mm",
                                              "1979-05-27T07:32:00Z",
                                              "\r",
                                              "\t"};
    const int count = 1 + static_cast<int>(below(4));
    for (int i = 0; i < count && !text.empty(); ++i) {
      const std::size_t at = below(text.size());
      const std::size_t length = std::min(text.size() - at, 1 + below(20));
      switch (below(6)) {
        case 0:
          text[at] = static_cast<char>(below(256));
          break;
        case 1:
          text.erase(at, length);
          break;
        case 2:
          text.insert(at, kPieces[below(std::size(kPieces))]);
          break;
        case 3:
          text.insert(at, text.substr(below(text.size()), length));
          break;
        case 4:
          text.resize(at);
          break;
        case 5: {  // whole lines change places
          const std::size_t end = text.find('\n', at);
          if (end == std::string::npos) break;
          const std::string line = text.substr(at, end + 1 - at);
          text.erase(at, line.size());
          text.insert(text.empty() ? 0 : below(text.size()), line);
          break;
        }
      }
    }
    return text;
  }

 private:
  std::size_t below(std::size_t bound) {
    return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random_);
  }
  std::mt19937_64 random_;
};

// A damaged file is read, or refused with one line; nothing else may happen. What is read can be
// validated and written again.
TEST(SceneMutation, DamagedFilesAreReadOrRefused) {
  std::vector<std::string> sources = {write_scene(test::full_scene())};
  for (const PresetKind kind : {PresetKind::camera, PresetKind::flame})
    for (const std::string& name : preset_names(kind))
      sources.emplace_back(preset_text(kind, name));
  for (const char* name : {"paper-flame-1m", "lenslets-30", "candle"})
    sources.push_back(test::source_text(std::string("examples/") + name + ".toml"));
  Mutator mutate(1946);
  int read = 0, refused = 0;
  for (int round = 0; round < 500; ++round) {
    for (const std::string& source : sources) {
      const std::string text = mutate(source);
      try {
        const SceneDocument document = parse_scene(text, "mutant.toml");
        ++read;
        EXPECT_EQ(parse_scene(write_scene(document.scene), "mutant.toml").scene, document.scene)
            << text;
        check_scene(document.scene, document.positions);
      } catch (const InputError& error) {
        ++refused;
        const std::string message = error.what();
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        EXPECT_TRUE(message.starts_with("mutant.toml:")) << message << "\n" << text;
        EXPECT_LT(message.size(), 2000u);
      }
    }
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 1000);
}

std::string repeated(const std::string& piece, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += piece;
  return text;
}

// Texts that are deep or long enough to break a reader that recurses or is quadratic.
TEST(SceneMutation, DeepAndLongFilesAreRefused) {
  const std::string texts[] = {
      "a = " + repeated("[", 1000000),
      repeated("[", 300000),
      "a" + repeated(".a", 100000) + " = 1",
      "[camera" + repeated(" . \"a\"", 100000) + "]",
      "[camera]\nlens = {a" + repeated(".'b'", 100000) + " = 1}",
      "x = [\"\\\"\", '\\', \"\"\"\"\n\"\"\"\"\"]\ny" + repeated(".y", 100000) + " = 1",
      "camera = " + repeated("{a = ", 100000),
      "camera.position = \"" + repeated("x", 3000000) + "\"",
      repeated("a", 100000) + " = 1",
      std::string("\0a = 1", 6),
      "render.samples = 9223372036854775808",
      "[camera]\npreset = ''",
      "[camera.array]\ntypes = [{name = 'a'}]\n[[camera.array.types]]\nname = 'c'",
  };
  for (const std::string& text : texts) {
    const std::string message = test::message_of([&] { parse_scene(text, "deep.toml"); });
    EXPECT_TRUE(message.starts_with("deep.toml:")) << message << " for " << text.substr(0, 60);
    EXPECT_LT(message.size(), 2000u) << text.substr(0, 60);
  }
  // Dots in strings, comments and numbers are no parts of keys.
  const std::string dots = repeated(".", 1000);
  const std::string harmless = "# " + dots + "\n[[flames]]\nname = \"" + dots + "\"\nfile = '''" +
                               dots + "\n'" + dots + "'''\n" +
                               "position = [\"1.0 m\", \"1.5 m\", \"2.5 m\"] # " + dots + "\n";
  EXPECT_EQ(parse_scene(harmless, "").scene.flames.at(0).name, dots);
  EXPECT_EQ(parse_scene("\xEF\xBB\xBF[render]\r\nsamples = 3\r\n", "").scene.render.samples, 3);
}

}  // namespace
}  // namespace plenoflame::scene_mutation_test
