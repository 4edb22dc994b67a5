#include "messages.h"

#include <iostream>

#include "plenoflame/base/printable.h"

namespace plenoflame::cli {

void say(const std::string& text) {
  std::cerr << "plenoflame: " << printable(text) << '\n';
}

void warn(const std::string& text) {
  say("warning: " + text);
}

}  // namespace plenoflame::cli
