#include "plenoflame/base/setting_names.h"

#include <fmt/format.h>

#include <algorithm>

#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"

namespace plenoflame {

std::string SettingNames::operator()(std::string_view setting) const {
  std::string name(setting);
  std::ranges::replace(name, '-', separator);
  return std::string(prefix) + name;
}

std::string SettingNames::operator()(std::string_view setting, std::string_view value) const {
  if (!is_argument) return fmt::format("{} {}", (*this)(setting), value);
  const bool number = value.find_first_not_of("0123456789.e+-") == std::string_view::npos;
  const char* const quote = number ? "" : "'";
  return fmt::format("{}={}{}{}", (*this)(setting), quote, value, quote);
}

std::string SettingNames::message(const Error& error) const {
  std::string text = error.what();
  const auto* mended = dynamic_cast<const MendedBy*>(&error);
  if (!mended) return text;
  for (std::size_t i = 0; i < mended->names.size(); ++i)
    text += (i == 0 ? " (" : ", ") + (*this)(mended->names[i]);
  return text + ')';
}

}  // namespace plenoflame
