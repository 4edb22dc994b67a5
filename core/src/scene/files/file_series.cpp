#include "scene/files/file_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <set>
#include <system_error>

#include "plenoflame/base/error.h"
#include "scene/schema/nearest.h"

namespace plenoflame {
namespace {

constexpr int kMostMissing = 1000000;  ///< so that one stray number does not fill the memory

/// The number that a name has where the pattern has its #; -1: it is none of the series.
int number_in(const std::string& name, const std::string& before, const std::string& after,
              std::size_t digits) {
  if (name.size() < before.size() + after.size() + digits || !name.starts_with(before) ||
      !name.ends_with(after))
    return -1;
  const std::string_view text(name.data() + before.size(),
                              name.size() - before.size() - after.size());
  if (text.size() > digits && text.front() == '0') return -1;
  int number = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool good = error == std::errc() && end == text.data() + text.size() &&
                    text.front() >= '0' && text.front() <= '9';
  return good ? number : -1;
}

}  // namespace

int FileSeries::digits_of(const std::string& pattern) {
  int longest = 0, run = 0;
  for (const char c : pattern) {
    run = c == '#' ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

FileSeries::FileSeries(std::string pattern, const std::string& folder, int first)
    : pattern_(std::move(pattern)) {
  const auto begin = pattern_.find('#');
  const auto end = pattern_.find_first_not_of('#', begin);
  const auto slash = pattern_.rfind('/');
  if (begin == std::string::npos || (slash != std::string::npos && begin < slash) ||
      (end != std::string::npos && pattern_.find('#', end) != std::string::npos))
    throw InputError(quote_for_message(pattern_) +
                     " is not a series of files; write # for each digit of their numbers in the "
                     "name of the file, such as \"run_####.vdb\"");
  before_ = pattern_.substr(0, begin);
  after_ = end == std::string::npos ? "" : pattern_.substr(end);
  digits_ = (end == std::string::npos ? pattern_.size() : end) - begin;
  const std::filesystem::path whole = std::filesystem::path(folder) / pattern_;
  const std::filesystem::path parent = whole.has_parent_path() ? whole.parent_path() : ".";
  std::error_code error;
  std::filesystem::directory_iterator files(parent, error);
  if (error)
    throw FileError("cannot read the folder '" + parent.string() + "' of the series '" + pattern_ +
                    "': " + error.message());
  const std::string name_before = before_.substr(slash == std::string::npos ? 0 : slash + 1);
  std::set<int> numbers;
  for (const auto& file : files) {
    const int number = number_in(file.path().filename().string(), name_before, after_, digits_);
    if (number >= std::max(first, 0)) numbers.insert(number);
  }
  if (numbers.empty())
    throw InputError("there is no file " + quote_for_message(whole.string()) +
                     (first > 0 ? fmt::format(" with a number from {}", first)
                                : std::string(" with digits in place of #")));
  first_ = first < 0 ? *numbers.begin() : first;
  last_ = *numbers.rbegin();
  if (static_cast<double>(last_) - first_ - static_cast<double>(numbers.size()) > kMostMissing)
    throw InputError(
        fmt::format("the series {} has {} files with numbers up to {}; nearly all of "
                    "it is missing",
                    quote_for_message(pattern_), numbers.size(), last_));
  int next = first_;
  for (const int number : numbers) {
    for (; next < number; ++next) missing_.push_back(next);
    next = number + 1;
  }
}

bool FileSeries::is_missing(int number) const {
  return std::binary_search(missing_.begin(), missing_.end(), number);
}

std::string FileSeries::name(int number) const {
  return fmt::format("{}{:0{}}{}", before_, number, digits_, after_);
}

}  // namespace plenoflame
