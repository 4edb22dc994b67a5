#include "plenoflame/base/printable.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>

namespace plenoflame {
namespace {

/// A character of UTF-8; size 0: there is none at this place.
struct Character {
  std::uint32_t code = 0;
  std::size_t size = 0;
};

Character character_at(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t size = lead < 0xC2   ? 0
                           : lead < 0xE0 ? 2
                           : lead < 0xF0 ? 3
                           : lead < 0xF5 ? 4
                                         : 0;
  if (size == 0 || size > text.size()) return {};
  std::uint32_t code = lead & (0xFFu >> (size + 1));
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3Fu);
  }
  // Longer than need be, a half of a pair of UTF-16, or beyond Unicode.
  constexpr std::array<std::uint32_t, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
  if (code < kLeast[size] || (code >= 0xD800 && code < 0xE000) || code > 0x10FFFF) return {};
  return {code, size};
}

/// Tells whether a terminal would act on it, or show what follows elsewhere or in another order.
bool acts(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x061C ||
         (code >= 0x200E && code <= 0x200F) || (code >= 0x2028 && code <= 0x202E) ||
         (code >= 0x2066 && code <= 0x2069) || code == 0xFEFF;
}

}  // namespace

std::string printable(std::string_view text, bool keep_lines) {
  std::string result;
  result.reserve(text.size());
  char escape[8];
  while (!text.empty()) {
    const Character c = character_at(text);
    const std::size_t size = c.size > 0 ? c.size : 1;
    if (c.size == 0) {
      std::snprintf(escape, sizeof escape, "\\x%02x",
                    static_cast<unsigned>(static_cast<unsigned char>(text[0])));
      result += escape;
    } else if (acts(c.code) &&
               !(keep_lines && (c.code == '\n' || c.code == '\t' || text.starts_with("\r\n")))) {
      std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(c.code));
      result += escape;
    } else {
      result.append(text.substr(0, size));
    }
    text.remove_prefix(size);
  }
  return result;
}

}  // namespace plenoflame
