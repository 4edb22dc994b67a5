#include "settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "options.h"

namespace plenoflame {

std::string setting_text(double value) {
  return fmt::format("{}", value);
}
std::string setting_text(std::uint64_t value) {
  return fmt::format("{}", value);
}
std::string setting_text(const std::vector<int>& value) {
  return fmt::format("{}", fmt::join(value, ","));
}
std::string setting_text(const std::vector<double>& value) {
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
  for (const std::string& word : list())
    SettingReader(setting_, word).to(values.emplace_back(), {}, least, greatest);
}

void SettingReader::to(std::vector<double>& values, double least, double greatest) const {
  values.clear();
  for (const std::string& word : list())
    values.push_back(number_option(setting_, word, least, greatest));
}

int SettingReader::choice(const std::vector<std::string>& words) const {
  check_choice(setting_, text_, words);
  return static_cast<int>(std::ranges::find(words, text_) - words.begin());
}

std::vector<std::string> SettingReader::list() const {
  std::vector<std::string> words;
  std::istringstream stream(text_);
  for (std::string word; std::getline(stream >> std::ws, word, ',');) words.push_back(word);
  return words;
}

Vec3 SettingReader::lengths() const {
  const auto [x, y, z] = point_option(setting_, text_);
  return {x, y, z};
}

double SettingReader::quantity(Dimension dimension) const {
  return quantity_option(setting_, text_, dimension);
}

void SettingReader::to(std::optional<Vec3>& value, const std::vector<std::string>& words) const {
  value.reset();
  if (!text_.empty() && std::ranges::count(words, text_) == 0) value = lengths();
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
