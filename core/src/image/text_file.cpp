#include "plenoflame/image/text_file.h"

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame {

std::string read_text_file(const std::string& path) {
  std::string text = read_file(path);
  // Every second byte of the Latin letters of UTF-16 is 0, with a mark in front or without.
  const bool marked = text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff");
  const bool wide = text.size() >= 4 && (text[0] == '\0') != (text[1] == '\0') &&
                    (text[0] == '\0') == (text[2] == '\0') &&
                    (text[1] == '\0') == (text[3] == '\0');
  if (marked || wide)
    throw InputError({path},
                     "this text is UTF-16, as some programs save \"Unicode\"; save it as UTF-8");
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  return text;
}

}  // namespace plenoflame
