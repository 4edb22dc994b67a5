#include "scene/files/toml_guard.h"

#include <algorithm>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr int kMostParts = 32;

/// Position behind the string that begins at `at`; the end of the text when it is not closed.
std::size_t skip_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string_view three = text.substr(at, 3);
  const bool long_form = three.size() == 3 && three[1] == quote && three[2] == quote;
  at += long_form ? 3 : 1;
  while (at < text.size()) {
    if (text[at] == '\\' && quote == '"') {
      at += 2;
    } else if (long_form && text[at] == quote) {
      // Up to two quotes may stand in front of the three that close.
      std::size_t count = 0;
      while (at < text.size() && text[at] == quote && count < 5) ++count, ++at;
      if (count >= 3) return at;
    } else if (!long_form && (text[at] == quote || text[at] == '\n')) {
      return at + 1;
    } else {
      ++at;
    }
  }
  return text.size();
}

/// Tells whether a string that begins at `at` and ends before `end` is closed.
bool is_closed(std::string_view text, std::size_t at, std::size_t end) {
  const char quote = text[at];
  const std::string_view three = text.substr(at, 3);
  const bool long_form = three.size() == 3 && three[1] == quote && three[2] == quote;
  if (!long_form) return end - at >= 2 && text[end - 1] == quote;
  return end - at >= 6 && text.substr(end - 3, 3) == three;
}

}  // namespace

std::optional<OpenString> find_open_string(std::string_view text) {
  OpenString found;
  std::size_t line_start = 0;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    std::size_t next = at + 1;
    if (c == '"' || c == '\'') {
      next = std::min(skip_string(text, at), text.size());
      if (!is_closed(text, at, next)) {
        found.column = static_cast<int>(at - line_start) + 1;
        found.quote = c;
        found.long_form = text.substr(at).starts_with(std::string(3, c));
        return found;
      }
    } else if (c == '#') {
      next = std::min(text.find('\n', at), text.size());
    }
    for (; at < next; ++at)
      if (text[at] == '\n') {
        ++found.line;
        line_start = at + 1;
      }
  }
  return std::nullopt;
}

void check_is_text(std::string_view text, const std::string& name) {
  if (text.find('\0') != std::string_view::npos)
    throw InputError({name},
                     "this file holds binary data, not a scene; a scene is a text file in TOML");
}

void check_key_depth(std::string_view text, const std::string& name) {
  int line = 1, parts = 1;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    std::size_t next = at + 1;
    if (c == '"' || c == '\'') {
      next = skip_string(text, at);
    } else if (c == '#') {
      next = text.find('\n', at);
      if (next == std::string_view::npos) next = text.size();
    } else if (c == '.') {
      if (++parts > kMostParts)
        throw InputError({name, line, 0},
                         "a key has more than 32 parts, which no key of a scene has");
    } else if (c == '\n' || c == '=' || c == ',' || c == '[' || c == '{') {
      parts = 1;
    }
    for (; at < next && at < text.size(); ++at)
      if (text[at] == '\n') ++line;
  }
}

}  // namespace plenoflame
