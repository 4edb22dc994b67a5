#include "plenoflame/base/error.h"

namespace plenoflame {

std::string to_string(const SourcePosition& position) {
  std::string text = position.file;
  if (position.line > 0) {
    if (!text.empty()) text += ':';
    text += std::to_string(position.line);
    if (position.column > 0) text += ':' + std::to_string(position.column);
  }
  return text;
}

namespace {
std::string with_position(const SourcePosition& position, const std::string& message) {
  const std::string where = to_string(position);
  return where.empty() ? message : where + ": " + message;
}
}  // namespace

InputError::InputError(const SourcePosition& position, const std::string& message)
    : Error(with_position(position, message)), position_(position) {}

}  // namespace plenoflame
