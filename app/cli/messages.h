#pragma once
#include <string>

namespace plenoflame::cli {

/// "plenoflame: TEXT" as one line on standard error. Text from files or users cannot act on the
/// terminal (base/printable.h).
void say(const std::string& text);
/// "plenoflame: warning: TEXT".
void warn(const std::string& text);

}  // namespace plenoflame::cli
