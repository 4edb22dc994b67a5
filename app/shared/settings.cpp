#include "settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"

namespace plenoflame {

std::string SettingNames::operator()(std::string_view setting) const {
  std::string name(setting);
  if (style_ == Style::option) return "--" + name;
  std::ranges::replace(name, '-', style_ == Style::argument ? '_' : ' ');
  return name;
}

std::string SettingNames::operator()(std::string_view setting, std::string_view value) const {
  if (style_ != Style::argument) return fmt::format("{} {}", (*this)(setting), value);
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

std::string setting_text(double value) {
  return fmt::format("{}", value);
}
std::string setting_text(std::uint64_t value) {
  return fmt::format("{}", value);
}
std::string setting_text(const std::vector<int>& value) {
  return fmt::format("{}", fmt::join(value, ","));
}
std::string setting_text(const Vec3& value) {
  return fmt::format("{} m, {} m, {} m", value.x, value.y, value.z);
}

void SettingReader::to(std::string& value, const std::vector<std::string>& words) const {
  if (!words.empty()) check_choice(setting_, text_, words);
  value = text_;
}

void SettingReader::to(int& value, const std::vector<std::string>& words, double least,
                       double greatest) const {
  const auto word = std::ranges::find(words, text_);
  value = word != words.end() ? -1 - static_cast<int>(word - words.begin())
                              : whole_number_option(setting_, text_, static_cast<int>(least),
                                                    static_cast<int>(greatest));
}

void SettingReader::to(std::vector<int>& values, double least, double greatest) const {
  values.clear();
  std::istringstream words(text_);
  for (std::string word; std::getline(words, word, ',');)
    SettingReader(setting_, word).to(values.emplace_back(), {}, least, greatest);
}

void SettingReader::to(std::optional<Vec3>& value, const std::vector<std::string>& words) const {
  value.reset();
  if (text_.empty() || std::ranges::count(words, text_) > 0) return;
  const auto [x, y, z] = point_option(setting_, text_);
  value = {x, y, z};
}

void SettingReader::to(std::uint64_t& value) const {
  value = whole_number_option<std::uint64_t>(setting_, text_, 0);
}

void SettingReader::to(double& value, double least, double greatest) const {
  value = number_option(setting_, text_, least, greatest);
}

void SettingReader::to(bool& value) const {
  check_choice(setting_, text_, {"true", "false"});
  value = text_ == "true";
}

}  // namespace plenoflame
