#pragma once
#include <concepts>
#include <initializer_list>
#include <ranges>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace plenoflame {

/// A value as JSON text: a number, a word, a list of values. Pairs of a word and a value in a list
/// are an object. NaN and infinite become null.
class Figure {
 public:
  template <class Number>
  requires std::is_arithmetic_v<Number> Figure(Number value) : text_(text_of(value)) {}
  Figure(const char* word) : Figure(std::string(word)) {}
  Figure(const std::string& word);
  /// A list, or an object of a map.
  template <std::ranges::input_range Values>
  requires(!std::is_convertible_v<const Values&, std::string> &&
           !requires(const Values& json) { json.dump(); }) Figure(const Values& values) {
    constexpr bool kMap = requires {
      typename Values::mapped_type;
    };
    for (const auto& value : values) {
      text_ += text_.empty() ? "" : ",";
      if constexpr (kMap)
        text_ += Figure(value.first).text_ + ":" + Figure(value.second).text_;
      else
        text_ += Figure(value).text_;
    }
    text_ = kMap ? "{" + text_ + "}" : "[" + text_ + "]";
  }
  Figure(std::initializer_list<Figure> values);
  /// A value of a JSON library.
  template <class Json>
  requires requires(const Json& json) { json.dump(); }
  Figure(const Json& json) : text_(json.dump(-1, ' ', false, Json::error_handler_t::replace)) {}

  const std::string& json() const { return text_; }

 private:
  static std::string text_of(double value);
  static std::string text_of(bool value) { return value ? "true" : "false"; }
  static std::string text_of(std::integral auto value) { return std::to_string(value); }

  std::string text_;
};

/// Figures as aligned lines for people and as JSON (SI units, full precision). One call per figure
/// feeds both, so that neither lacks what the other has.
class Report {
 public:
  /// @param label for people @param text its value @param key of the JSON object
  void add(const std::string& label, const std::string& text, const std::string& key,
           const Figure& value);
  /// A line for people only.
  void add_text(const std::string& label, const std::string& text);
  /// A value for JSON only.
  void add_json(const std::string& key, const Figure& value);
  /// Adds all of another one.
  void add_all(const Report& other);
  /// Labels and values.
  const std::vector<std::pair<std::string, std::string>>& lines() const { return lines_; }
  /// The lines, "label: text".
  std::string text() const;
  /// The JSON object as text, ending with a line break.
  std::string json_text() const;

 private:
  std::vector<std::pair<std::string, std::string>> lines_;
  std::vector<std::pair<std::string, std::string>> figures_;  ///< keys and JSON texts
};

}  // namespace plenoflame
