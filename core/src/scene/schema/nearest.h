#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace plenoflame {

/// The candidate with the smallest edit distance from `word`: insertions, deletions, changes and
/// swaps of neighbours. Empty if more than a third of its letters differ.
std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

/// "; did you mean \"index\"?", or "; known are a, b, c" when nothing is similar, or nothing.
std::string suggestion(std::string_view word, const std::vector<std::string>& candidates);

/// Text for a one-line message: cut to 60 characters, control characters replaced.
std::string quote_for_message(std::string_view text);

}  // namespace plenoflame
