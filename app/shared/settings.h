#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "plenoflame/math/vector.h"

/// Settings of requests, described once: the command's options with their help, the arguments of
/// Python and the texts of the desktop come from these rows.
namespace plenoflame {

class Error;

/// How a front end writes the names of settings, so that messages name them as their caller does.
class SettingNames {
 public:
  enum class Style {
    option,    ///< of the command: --absorption-error
    argument,  ///< of Python: absorption_error
    words,     ///< in a window: absorption error
  };
  constexpr SettingNames(Style style = Style::option) : style_(style) {}

  /// @param setting its own name, words with hyphens: "absorption-error"
  std::string operator()(std::string_view setting) const;
  /// With its value: "--solver mart", "solver='mart'".
  std::string operator()(std::string_view setting, std::string_view value) const;
  /// The text of an error, with the settings that mend it: "... (--region, --margin)".
  std::string message(const Error& error) const;

 private:
  Style style_;
};

/// The kinds of texts that settings take.
enum class SettingKind {
  text,
  word,
  whole,
  number,
  flag,
  lengths,
  sides,  ///< two whole numbers, "9x6"
  file
};

/// A setting, for front ends that list them.
struct SettingFacts {
  std::string_view name;  ///< "absorption-error"
  std::string_view form;  ///< of its value, "SHARE"; empty: a flag
  std::string help;       ///< with the default in parentheses
  std::string value;      ///< the default as text; empty: none
  SettingKind kind = SettingKind::text;
  bool repeated = false, required = false;
};

/// A setting of a request, and where its value is kept.
template <class Request>
struct SettingRow {
  using Field = std::variant<std::string Request::*, int Request::*, std::optional<int> Request::*,
                             std::optional<std::uint64_t> Request::*, double Request::*,
                             std::optional<double> Request::*, bool Request::*,
                             std::vector<std::string> Request::*, std::vector<int> Request::*,
                             std::optional<Vec3> Request::*>;
  std::string_view name, form, help;
  Field field;
  SettingKind kind = SettingKind::text;
  /// The words that it takes; empty: any text. For a number they stand for -1, -2, ..., for a place
  /// for nothing.
  std::vector<std::string> words = {};
  double least = 0, greatest = 2e9;  ///< of a number
  bool required = false;
};

/// The rows of a request. Specialised beside each request.
template <class Request>
std::span<const SettingRow<Request>> setting_rows();

/// A value as set_row() takes it.
std::string setting_text(double value);
std::string setting_text(std::uint64_t value);
std::string setting_text(const std::vector<int>& value);
std::string setting_text(const Vec3& value);

/// The value of a row as set_row() takes it; empty: nothing, false, or a repeated one.
template <class Request>
std::string text_of_row(const SettingRow<Request>& row, const Request& request) {
  const auto text_of = [&](const auto& value) -> std::string {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, std::string>)
      return value;
    else if constexpr (std::is_same_v<Value, bool>)
      return value ? "true" : "";
    else if constexpr (std::is_same_v<Value, std::vector<std::string>>)
      return "";
    else if constexpr (std::is_same_v<Value, int>)
      return value < 0 ? row.words[static_cast<std::size_t>(-1 - value)]
                       : setting_text(static_cast<double>(value));
    else
      return setting_text(value);
  };
  return std::visit(
      [&](auto field) {
        if constexpr (requires { (request.*field).has_value(); })
          return request.*field ? text_of(*(request.*field)) : std::string();
        else
          return text_of(request.*field);
      },
      row.field);
}

template <class Request>
SettingFacts facts_of(const SettingRow<Request>& row) {
  SettingFacts facts{row.name,
                     row.form,
                     std::string(row.help),
                     text_of_row(row, Request()),
                     row.kind,
                     std::holds_alternative<std::vector<std::string> Request::*>(row.field),
                     row.required};
  if (!facts.value.empty()) facts.help += " (" + facts.value + ")";
  return facts;
}

/// Reads texts of settings, as every front end gives them.
class SettingReader {
 public:
  /// @param setting as messages write it
  SettingReader(std::string setting, std::string text)
      : setting_(std::move(setting)), text_(std::move(text)) {}
  /// @throws UsageError each
  void to(std::string& value, const std::vector<std::string>& words) const;
  void to(int& value, const std::vector<std::string>& words, double least, double greatest) const;
  void to(std::vector<int>& values, double least, double greatest) const;
  void to(std::optional<Vec3>& value, const std::vector<std::string>& words) const;
  void to(std::uint64_t& value) const;
  void to(double& value, double least, double greatest) const;
  void to(bool& value) const;

 private:
  std::string setting_, text_;
};

/// Gives a request the value of a row. @throws UsageError for a wrong text
template <class Request>
void set_row(const SettingRow<Request>& row, const SettingNames& names, const std::string& text,
             Request& request) {
  const SettingReader reader(names(row.name), text);
  std::visit(
      [&](auto field) {
        auto& value = request.*field;
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, std::string> ||
                      std::is_same_v<Value, std::optional<Vec3>>)
          reader.to(value, row.words);
        else if constexpr (std::is_same_v<Value, std::vector<std::string>>)
          value.push_back(text);
        else if constexpr (std::is_same_v<Value, bool>)
          reader.to(value);
        else if constexpr (std::is_same_v<Value, std::optional<std::uint64_t>>)
          reader.to(value.emplace());
        else if constexpr (std::is_same_v<Value, int>)
          reader.to(value, row.words, row.least, row.greatest);
        else if constexpr (std::is_same_v<Value, std::optional<int>>)
          reader.to(value.emplace(), row.words, row.least, row.greatest);
        else if constexpr (std::is_same_v<Value, std::optional<double>>)
          reader.to(value.emplace(), row.least, row.greatest);
        else
          reader.to(value, row.least, row.greatest);
      },
      row.field);
}

/// Gives a request the value of the row of this name. @return whether there is such a row
template <class Request>
bool set_setting(Request& request, const SettingNames& names, const std::string& name,
                 const std::string& text) {
  for (const SettingRow<Request>& row : setting_rows<Request>()) {
    if (row.name != name) continue;
    set_row(row, names, text, request);
    return true;
  }
  return false;
}

}  // namespace plenoflame
