#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/base/error.h"
#include "support/temporary_folder.h"

/// Files with damage at random places. Only std::mt19937_64's own numbers are used: the
/// distributions of the library differ between systems.
namespace plenoflame::test {

/// The number of damaged files that a test tries: PLENOFLAME_DAMAGED_FILES, where that is set.
inline int damaged_files_wanted(int otherwise) {
  const char* const text =
      std::getenv("PLENOFLAME_DAMAGED_FILES");  // NOLINT(concurrency-mt-unsafe)
  return text ? std::atoi(text) : otherwise;
}

inline std::size_t below(std::size_t limit, std::mt19937_64& random) {
  return static_cast<std::size_t>(random() % limit);
}

/// Overwrites, flips, inserts, removes or cuts bytes. Three quarters of the damage goes to the
/// first `header_size` bytes, where the structure is.
inline std::string damage_bytes(std::string bytes, std::size_t header_size,
                                std::mt19937_64& random) {
  const auto place = [&] {
    const bool in_header = below(4, random) != 0 && header_size < bytes.size();
    return below(in_header ? header_size : bytes.size(), random);
  };
  const std::size_t changes = 1 + below(6, random);
  for (std::size_t i = 0; i < changes && bytes.size() > 8; ++i) {
    const std::size_t at = place();
    switch (below(7, random)) {
      case 0:
        bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8, random)));
        break;
      case 2:
        bytes[at] = static_cast<char>(0xff);
        break;
      case 3:
        bytes[at] = 0;
        break;
      case 4:
        bytes.insert(at, 1 + below(8, random), static_cast<char>(random()));
        break;
      case 5:
        bytes.erase(at, 1 + below(8, random));
        break;
      default:
        if (below(8, random) == 0)
          bytes.resize(at);
        else
          for (std::size_t k = at; k < std::min(at + 4, bytes.size()); ++k)
            bytes[k] = static_cast<char>(random());
    }
  }
  return bytes;
}

/// The same for text: also doubles parts of it, and puts one of `words` in their place.
inline std::string damage_text(std::string text, const std::vector<std::string>& words,
                               std::mt19937_64& random) {
  const auto word = [&]() -> const std::string& { return words[below(words.size(), random)]; };
  const std::size_t changes = 1 + below(5, random);
  for (std::size_t i = 0; i < changes && text.size() > 4; ++i) {
    const std::size_t at = below(text.size(), random);
    switch (below(7, random)) {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text[at] = static_cast<char>(text[at] ^ (1 << below(8, random)));
        break;
      case 2:
        text.erase(at, 1 + below(16, random));
        break;
      case 3:
        text.insert(at, word());
        break;
      case 4: {
        const std::string part = text.substr(below(text.size(), random), 1 + below(60, random));
        text.insert(at, part);
        break;
      }
      case 5:
        text.replace(at, 1 + below(4, random), word());
        break;
      default:
        if (below(6, random) == 0) text.resize(at);
    }
  }
  return text;
}

/// Words that are wrong in most places of a text.
inline std::vector<std::string> awkward_words() {
  return {"-1",         "0",
          "4294967295", "1e300",
          "nan",        "inf",
          " ",          "\n",
          "\"",         "[",
          "]",          "=",
          "1e-320",     "-0.0",
          "true",       "1 m",
          "0 mm",       ",",
          "#",          "1e-50 mm",
          "{",          "}",
          ".",          "\xc3\xa9",
          "\x1b[31m",   "99999999999999999999"};
}

struct Outcomes {
  int read = 0, refused = 0;
};

/// Shares of the damaged files that must be read, and refused: with too little of either kind the
/// damage would test nothing, and a reader that takes everything, or nothing, would pass.
struct LeastShares {
  double read = 0.02, refused = 0.5;
};

/// Reads `files` damaged versions of the samples, in turn. Each is read, or refused with an Error
/// of one line; anything else fails. Prints both numbers.
inline Outcomes read_damaged(const char* what, int files, const std::vector<std::string>& samples,
                             const std::function<std::string(const std::string&)>& damage,
                             const std::function<void(const std::string&)>& read,
                             LeastShares least = {}) {
  Outcomes outcomes;
  for (int n = 0; n < files; ++n) {
    const std::string bytes = damage(samples[static_cast<std::size_t>(n) % samples.size()]);
    try {
      read(bytes);
      ++outcomes.read;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      ++outcomes.refused;
    } catch (const std::exception& other) {
      ADD_FAILURE() << what << ", file " << n << ": " << other.what();
    }
  }
  std::printf("%s: %d files, %d read, %d refused\n", what, outcomes.read + outcomes.refused,
              outcomes.read, outcomes.refused);
  EXPECT_GE(outcomes.read, least.read * files) << what;
  EXPECT_GE(outcomes.refused, least.refused * files) << what;
  return outcomes;
}

}  // namespace plenoflame::test
