#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "plenoflame/sampling/noise.h"
#include "plenoflame/sampling/sobol.h"
#include "plenoflame/scene/sweep.h"
#include "scene/files/parse_toml.h"
#include "scene/schema/nearest.h"

namespace plenoflame {
namespace {

constexpr std::array<const char*, 6> kLaws = {"uniform", "log_uniform", "normal",
                                              "integer", "choice",      "value"};
constexpr int kMostDraws = 100000;  ///< until a normal number lies within its limits

/// FNV-1a, 64 bits (Fowler, Noll, Vo 1991): the same text on every machine.
std::uint64_t key_hash(const std::string& key) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : key) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

SourcePosition position_of(const toml::node& node, const std::string& name) {
  const toml::source_position& begin = node.source().begin;
  return {name, static_cast<int>(begin.line), static_cast<int>(begin.column)};
}

std::string quantity_text(double value, const std::string& unit) {
  return unit.empty() ? fmt::format("{}", value) : fmt::format("{} {}", value, unit);
}

}  // namespace

struct SweepRules::Reader {
  const std::string& name;

  [[noreturn]] void fail(const toml::node& node, const std::string& message) const {
    throw InputError(position_of(node, name), message);
  }

  /// A number, alone or as text with its unit.
  std::pair<double, std::string> number(const toml::node& node) const {
    if (const auto plain = node.value<double>(); plain && !node.is_boolean()) {
      if (!std::isfinite(*plain)) fail(node, "the number must be finite");
      return {*plain, ""};
    }
    const auto text = node.value<std::string>();
    if (!text) fail(node, "this must be a number, or text with a unit such as \"2 mm\"");
    double value = 0;
    const char* const end = text->data() + text->size();
    const auto [stop, error] = std::from_chars(text->data(), end, value);
    if (error != std::errc() || !std::isfinite(value))
      fail(node, quote_for_message(*text) + " does not begin with a number");
    std::string unit(stop, end);
    unit.erase(0, unit.find_first_not_of(' '));
    return {value, unit};
  }

  const toml::array& pair(const toml::node& node, const char* what) const {
    const toml::array* const both = node.as_array();
    if (!both || both->size() != 2)
      fail(node,
           fmt::format("{} takes two values: {} = [{}]", what, what,
                       std::string_view(what) == "normal" ? "MEAN, DEVIATION" : "LEAST, GREATEST"));
    return *both;
  }

  /// The numbers of one end of a range: one, or those of an array.
  std::vector<const toml::node*> numbers(const toml::node& node) const {
    const toml::array* const several = node.as_array();
    if (!several) return {&node};
    std::vector<const toml::node*> all;
    for (const toml::node& each : *several) all.push_back(&each);
    return all;
  }

  std::vector<Axis> axes(const toml::node& node, const char* what) const {
    const toml::array& both = pair(node, what);
    const auto first = numbers(both[0]), second = numbers(both[1]);
    if (first.size() != second.size() || first.empty())
      fail(node, fmt::format("{} has {} and {} numbers, but both counts must be equal", what,
                             first.size(), second.size()));
    std::vector<Axis> all;
    for (std::size_t i = 0; i < first.size(); ++i) {
      const auto [a, unit] = number(*first[i]);
      const auto [b, other] = number(*second[i]);
      if (unit != other)
        fail(*second[i], fmt::format("both values must have the same unit, not {} and {}",
                                     unit.empty() ? "none" : quote_for_message(unit),
                                     other.empty() ? "none" : quote_for_message(other)));
      all.push_back({a, b, 0, 0, unit});
    }
    return all;
  }

  void read_law(const toml::table& table, const char* law, Rule& rule) const {
    const toml::node& node = *table.get(law);
    const std::string_view word = law;
    if (word == "choice" || word == "value") {
      if (word == "value") {
        rule.choices = {text_of(node)};
        return;
      }
      const toml::array* const items = node.as_array();
      if (!items || items->empty()) fail(node, "choice takes a list: choice = [A, B, C]");
      for (const toml::node& item : *items) rule.choices.push_back(text_of(item));
      return;
    }
    rule.law = word == "uniform"       ? Law::uniform
               : word == "log_uniform" ? Law::log_uniform
               : word == "normal"      ? Law::normal
                                       : Law::integer;
    rule.axes = axes(node, law);
    for (Axis& axis : rule.axes) {
      if (rule.law == Law::normal) {
        if (!(axis.second >= 0)) fail(node, "the deviation must not be negative");
        continue;
      }
      if (!(axis.first <= axis.second))
        fail(node, fmt::format("{} is above {}: the least comes first", axis.first, axis.second));
      if (rule.law == Law::log_uniform && !(axis.first > 0))
        fail(node, "log_uniform needs a least value above 0");
      if (rule.law == Law::integer &&
          (std::floor(axis.first) != axis.first || std::floor(axis.second) != axis.second ||
           std::abs(axis.first) > 1e15 || std::abs(axis.second) > 1e15))
        fail(node, "integer takes whole numbers");
    }
  }

  void read_limits(const toml::table& table, Rule& rule) const {
    const toml::node* const node = table.get("limits");
    if (!node) return;
    if (rule.law != Law::normal) fail(*node, "limits apply only to the rule normal");
    const std::vector<Axis> limits = axes(*node, "limits");
    if (limits.size() != rule.axes.size())
      fail(*node, "limits must have as many numbers as the mean");
    rule.limited = true;
    for (std::size_t i = 0; i < limits.size(); ++i) {
      Axis& axis = rule.axes[i];
      if (limits[i].unit != axis.unit) fail(*node, "limits must have the unit of the mean");
      axis.least = limits[i].first;
      axis.greatest = limits[i].second;
      // Within four deviations a number is found soon.
      if (!(axis.least <= axis.greatest) || axis.greatest < axis.first - 4 * axis.second ||
          axis.least > axis.first + 4 * axis.second)
        fail(*node, "the limits exclude all values within four deviations of the mean");
    }
  }

  std::string text_of(const toml::node& node) const {
    if (const auto* const text = node.as_string()) return text->get();
    if (const auto* const yes = node.as_boolean()) return yes->get() ? "true" : "false";
    if (const auto* const whole = node.as_integer()) return fmt::format("{}", whole->get());
    if (const auto* const real = node.as_floating_point()) return fmt::format("{}", real->get());
    const toml::array* const several = node.as_array();
    if (!several) fail(node, "this must be a value: text, a number, true or false, or an array");
    std::string text;
    for (const toml::node& each : *several) text += (text.empty() ? "" : ", ") + text_of(each);
    return text;
  }

  Rule rule(const toml::table& table) const {
    Rule rule;
    const toml::node* const key = table.get("key");
    if (!key || !key->is_string() || key->as_string()->get().empty())
      fail(key ? *key : static_cast<const toml::node&>(table),
           "a [[random]] table needs the key of the scene that it sets: key = \"...\"");
    rule.key = key->as_string()->get();
    rule.position = position_of(*key, name);
    const char* law = nullptr;
    for (const auto& [entry, node] : table) {
      const std::string word(entry.str());
      if (word == "key" || word == "limits") continue;
      const auto known = std::find(kLaws.begin(), kLaws.end(), word);
      if (known == kLaws.end())
        fail(node, fmt::format("there is no rule {}; there are uniform, log_uniform, normal, "
                               "integer, choice and value",
                               quote_for_message(word)));
      if (law)
        fail(node, fmt::format("{} has {} and {}; leave one of them out",
                               quote_for_message(rule.key), law, word));
      law = *known;
    }
    if (!law)
      fail(table, fmt::format("{} has no rule: uniform, log_uniform, normal, integer, choice or "
                              "value",
                              quote_for_message(rule.key)));
    read_law(table, law, rule);
    read_limits(table, rule);
    return rule;
  }
};

SweepRules::SweepRules(std::string_view text, const std::string& name) {
  const toml::table parsed = parse_toml(text, name);
  const Reader reader{name};
  for (const auto& [key, node] : parsed) {
    if (key == "runs") {
      const auto count = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
      if (!count || *count < 1 || *count > kMostRuns)
        reader.fail(node, fmt::format("runs must be a whole number from 1 to {}", kMostRuns));
      runs_ = static_cast<int>(*count);
    } else if (key != "random") {
      reader.fail(node, quote_for_message(std::string(key.str())) +
                            " is not known here; the keys are runs and [[random]]");
    }
  }
  const toml::node* const list = parsed.get("random");
  const toml::array* const rules = list ? list->as_array() : nullptr;
  if (!rules || rules->empty())
    throw InputError(list ? position_of(*list, name) : SourcePosition{name},
                     "the file has no [[random]] table, which gives the rule of a key");
  for (const toml::node& node : *rules) {
    if (!node.is_table()) reader.fail(node, "[[random]] must be a table for each key");
    rules_.push_back(reader.rule(*node.as_table()));
    for (std::size_t i = 0; i + 1 < rules_.size(); ++i)
      if (rules_[i].key == rules_.back().key)
        throw InputError(rules_.back().position,
                         quote_for_message(rules_.back().key) + " has a rule already");
  }
}

SweepRun SweepRules::draw(std::uint64_t seed, int run) const {
  SweepRun values;
  for (const Rule& rule : rules_) {
    NoiseStream noise(mix64(seed ^ mix64(key_hash(rule.key))), static_cast<std::uint64_t>(run));
    std::string text;
    if (rule.law == Law::choice) {
      const auto count = static_cast<double>(rule.choices.size());
      text = rule.choices[static_cast<std::size_t>(noise.uniform() * count)];
    }
    for (const Axis& axis : rule.axes) {
      double value = 0;
      switch (rule.law) {
        case Law::log_uniform:
          value = std::clamp(axis.first * std::pow(axis.second / axis.first, noise.uniform()),
                             axis.first, axis.second);
          break;
        case Law::normal:
          for (int tries = 0; tries < kMostDraws; ++tries) {
            value = axis.first + axis.second * noise.gaussian();
            if (!rule.limited || (value >= axis.least && value <= axis.greatest)) break;
          }
          if (rule.limited) value = std::clamp(value, axis.least, axis.greatest);
          break;
        case Law::integer:
          value = axis.first + std::floor(noise.uniform() * (axis.second - axis.first + 1));
          break;
        default:
          value = axis.first + noise.uniform() * (axis.second - axis.first);
      }
      text += (text.empty() ? "" : ", ") + quantity_text(value, axis.unit);
    }
    values.push_back({rule.key, std::move(text), rule.position});
  }
  return values;
}

std::uint64_t seed_of_run(std::uint64_t sweep_seed, int run) {
  return mix64(mix64(sweep_seed) + static_cast<std::uint64_t>(run)) >> 1;
}

std::vector<bool> choose_test_runs(std::uint64_t sweep_seed, int runs, double share) {
  std::vector<std::pair<std::uint64_t, int>> order;
  const std::uint64_t key = mix64(sweep_seed ^ 0x7465737473686172u);
  for (int run = 0; run < runs; ++run)
    order.push_back({mix64(key + static_cast<std::uint64_t>(run)), run});
  std::sort(order.begin(), order.end());
  std::vector<bool> chosen(static_cast<std::size_t>(runs));
  const auto count = static_cast<std::size_t>(std::lround(share * runs));
  for (std::size_t i = 0; i < count; ++i) chosen[static_cast<std::size_t>(order[i].second)] = true;
  return chosen;
}

}  // namespace plenoflame
