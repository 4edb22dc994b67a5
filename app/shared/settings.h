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

#include "plenoflame/base/setting_names.h"
#include "plenoflame/base/units.h"
#include "plenoflame/math/vector.h"

/// Settings of requests, described once: the command's options with their help, the arguments of
/// Python and the texts of the desktop come from these rows.
namespace plenoflame {

/// Names as the command writes them, and as texts in a window do.
inline constexpr SettingNames kOptionNames{"--", '-', false}, kWordNames{"", ' ', false};

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

class SettingReader;

/// A value that is one of the row's words, by the word's number. setting_choice() makes it of an
/// enumeration with the words in its order.
template <class Request>
struct SettingChoice {
  int (*get)(const Request&);
  void (*set)(Request&, int);
};
template <auto Member, class Request>
constexpr SettingChoice<Request> setting_choice() {
  using Value = std::remove_cvref_t<decltype(std::declval<Request>().*Member)>;
  return {[](const Request& request) { return static_cast<int>(request.*Member); },
          [](Request& request, int word) { request.*Member = static_cast<Value>(word); }};
}

/// A value that is more than one member.
template <class Request>
struct SettingText {
  std::string (*get)(const Request&);
  void (*set)(Request&, const SettingReader&);
};

/// The words that a setting takes.
struct SettingWords {
  std::vector<std::string> list;
};
template <class... Words>
SettingWords any_of(Words... words) {
  return {{words...}};
}

/// The numbers that a setting takes.
struct SettingRange {
  double least = 0, greatest = 2e9;
};
constexpr SettingRange between(double least, double greatest) {
  return {least, greatest};
}

/// A setting without a default.
struct SettingRequired {};
inline constexpr SettingRequired kRequired;

/// A setting of a request, and where its value is kept.
template <class Request>
struct SettingRow {
  using Field =
      std::variant<std::string Request::*, int Request::*, std::optional<int> Request::*,
                   std::optional<std::uint64_t> Request::*, double Request::*,
                   std::optional<double> Request::*, bool Request::*,
                   std::vector<std::string> Request::*, std::vector<int> Request::*,
                   std::optional<Vec3> Request::*, std::vector<double> Request::*,
                   std::vector<Vec3> Request::*, SettingChoice<Request>, SettingText<Request>>;
  /// Given several times, it has several values.
  bool is_repeated() const {
    return std::holds_alternative<std::vector<std::string> Request::*>(field) ||
           std::holds_alternative<std::vector<Vec3> Request::*>(field);
  }
  /// The kind that a field has by itself.
  struct KindOf {
    template <class Value>
    SettingKind operator()(Value Request::*) const {
      if (std::is_same_v<Value, bool>) return SettingKind::flag;
      if (std::is_same_v<Value, int> || std::is_same_v<Value, std::optional<int>> ||
          std::is_same_v<Value, std::optional<std::uint64_t>>)
        return SettingKind::whole;
      if (std::is_same_v<Value, double> || std::is_same_v<Value, std::optional<double>> ||
          std::is_same_v<Value, std::vector<double>>)
        return SettingKind::number;
      return SettingKind::text;
    }
    SettingKind operator()(const SettingChoice<Request>&) const { return SettingKind::word; }
    SettingKind operator()(const SettingText<Request>&) const { return SettingKind::text; }
  };
  /// @param traits any of a kind, any_of(), between() and kRequired. Without a kind, it is that of
  /// the field, or a word if there are words
  template <class... Traits>
  SettingRow(std::string_view own_name, std::string_view value_form, std::string_view text,
             Field member, Traits... traits)
      : name(own_name),
        form(value_form),
        help(text),
        field(member),
        kind(std::visit(KindOf{}, member)) {
    (take(traits), ...);
  }
  void take(SettingKind given) { kind = given; }
  void take(const SettingWords& given) {
    words = given.list;
    kind = kind == SettingKind::whole ? SettingKind::text : SettingKind::word;
  }
  void take(SettingRange given) { range = given; }
  void take(SettingRequired) { required = true; }

  std::string_view name, form, help;
  Field field;
  SettingKind kind;
  /// The words that it takes; empty: any text. For a number they stand for -1, -2, ..., for a place
  /// for nothing.
  std::vector<std::string> words = {};
  SettingRange range;  ///< of a number
  bool required = false;
};

/// The rows of a request. Specialised beside each request.
template <class Request>
std::span<const SettingRow<Request>> setting_rows();

/// A value as set_row() takes it.
std::string setting_text(double value);
std::string setting_text(std::uint64_t value);
std::string setting_text(const std::vector<int>& value);
std::string setting_text(const std::vector<double>& value);
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
    else if constexpr (std::is_same_v<Value, std::vector<std::string>> ||
                       std::is_same_v<Value, std::vector<Vec3>>)
      return "";
    else if constexpr (std::is_same_v<Value, int>)
      return value < 0 ? row.words[static_cast<std::size_t>(-1 - value)]
                       : setting_text(static_cast<double>(value));
    else
      return setting_text(value);
  };
  return std::visit(
      [&](auto field) {
        if constexpr (std::is_same_v<decltype(field), SettingChoice<Request>>)
          return row.words[static_cast<std::size_t>(field.get(request))];
        else if constexpr (std::is_same_v<decltype(field), SettingText<Request>>)
          return field.get(request);
        else if constexpr (requires { (request.*field).has_value(); })
          return request.*field ? text_of(*(request.*field)) : std::string();
        else
          return text_of(request.*field);
      },
      row.field);
}

template <class Request>
SettingFacts facts_of(const SettingRow<Request>& row) {
  SettingFacts facts{
      row.name, row.form,          std::string(row.help), text_of_row(row, Request()),
      row.kind, row.is_repeated(), row.required};
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
  void to(std::vector<double>& values, double least, double greatest) const;
  /// The number of one of the words.
  int choice(const std::vector<std::string>& words) const;
  /// Words with commas between.
  std::vector<std::string> list() const;
  /// A place or a direction.
  Vec3 lengths() const;
  double quantity(Dimension dimension) const;

  const std::string& setting() const { return setting_; }
  const std::string& text() const { return text_; }

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
        if constexpr (std::is_same_v<decltype(field), SettingChoice<Request>>) {
          field.set(request, reader.choice(row.words));
        } else if constexpr (std::is_same_v<decltype(field), SettingText<Request>>) {
          field.set(request, reader);
        } else {
          auto& value = request.*field;
          using Value = std::decay_t<decltype(value)>;
          if constexpr (std::is_same_v<Value, std::string> ||
                        std::is_same_v<Value, std::optional<Vec3>>)
            reader.to(value, row.words);
          else if constexpr (std::is_same_v<Value, std::vector<std::string>>)
            value.push_back(text);
          else if constexpr (std::is_same_v<Value, std::vector<Vec3>>)
            value.push_back(reader.lengths());
          else if constexpr (std::is_same_v<Value, bool>)
            reader.to(value);
          else if constexpr (std::is_same_v<Value, std::optional<std::uint64_t>>)
            reader.to(value.emplace());
          else if constexpr (std::is_same_v<Value, int>)
            reader.to(value, row.words, row.range.least, row.range.greatest);
          else if constexpr (std::is_same_v<Value, std::optional<int>>)
            reader.to(value.emplace(), row.words, row.range.least, row.range.greatest);
          else if constexpr (std::is_same_v<Value, std::optional<double>>)
            reader.to(value.emplace(), row.range.least, row.range.greatest);
          else
            reader.to(value, row.range.least, row.range.greatest);
        }
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
