#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace plenoflame {

/// Figures that a command prints: as aligned lines for people, or as JSON (SI units, full
/// precision). One call per figure feeds both, so that neither lacks what the other has.
class Report {
 public:
  /// @param label for people   @param text its value   @param key of the JSON object
  /// @param value for JSON; NaN and infinite become null
  void add(const std::string& label, const std::string& text, const std::string& key,
           nlohmann::json value);
  /// A line for people only.
  void add_text(const std::string& label, const std::string& text);
  /// A value for JSON only.
  void add_json(const std::string& key, nlohmann::json value);
  /// Adds all of another one.
  void add_all(const Report& other);
  /// Labels and values, as they would be printed.
  const std::vector<std::pair<std::string, std::string>>& lines() const { return lines_; }
  /// The JSON object as text, ending with a line break.
  std::string json_text() const;
  /// Prints to standard output: on a terminal with lines that are broken between words.
  void print(bool as_json) const;

 private:
  std::vector<std::pair<std::string, std::string>> lines_;
  nlohmann::ordered_json json_ = nlohmann::ordered_json::object();
};

}  // namespace plenoflame
