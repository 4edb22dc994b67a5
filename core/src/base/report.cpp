#include "plenoflame/base/report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "plenoflame/base/printable.h"

namespace plenoflame {

using Json = nlohmann::json;

Figure::Figure(const std::string& word) : Figure(Json(word)) {}

Figure::Figure(std::initializer_list<Figure> values) {
  Json list = Json::array();
  for (const Figure& value : values) list.push_back(Json::parse(value.text_));
  const bool pairs = std::ranges::all_of(list, [](const Json& value) {
    return value.is_array() && value.size() == 2 && value[0].is_string();
  });
  if (pairs && !list.empty()) {
    Json object;
    for (const Json& pair : list) object[pair[0].get<std::string>()] = pair[1];
    list = object;
  }
  text_ = list.dump();
}

std::string Figure::text_of(double value) {
  return Json(value).dump();
}

void Report::add(const std::string& label, const std::string& text, const std::string& key,
                 const Figure& value) {
  add_text(label, text);
  add_json(key, value);
}

void Report::add_text(const std::string& label, const std::string& text) {
  lines_.emplace_back(label, text);
}

void Report::add_json(const std::string& key, const Figure& value) {
  figures_.emplace_back(key, value.json());
}

void Report::add_all(const Report& other) {
  lines_.insert(lines_.end(), other.lines_.begin(), other.lines_.end());
  figures_.insert(figures_.end(), other.figures_.begin(), other.figures_.end());
}

std::string Report::text() const {
  std::string text;
  for (const auto& [label, value] : lines_) text += label + ": " + value + '\n';
  return text;
}

std::string Report::json_text() const {
  nlohmann::ordered_json object = nlohmann::ordered_json::object();
  for (const auto& [key, value] : figures_) object[key] = nlohmann::ordered_json::parse(value);
  return printable(object.dump(2, ' ', false, Json::error_handler_t::replace), true) + '\n';
}

}  // namespace plenoflame
