#include "choice.h"

#include <algorithm>
#include <utility>

#include "options.h"

namespace plenoflame::cli {

CLI::Validator one_of(std::vector<std::string> words) {
  const auto check = [words = std::move(words)](const std::string& text) -> std::string {
    if (std::find(words.begin(), words.end(), text) != words.end()) return "";
    std::string list;
    for (const std::string& word : words) list.append(list.empty() ? "" : ", ").append(word);
    const std::string nearest = nearest_name(text, words);
    return "'" + text + "' is not one of " + list +
           (nearest.empty() ? "" : "; did you mean '" + nearest + "'?");
  };
  return CLI::Validator(check, "");
}

}  // namespace plenoflame::cli
