#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace plenoflame::cli {

/// Help texts of at most 96 columns: names on the left, wrapped descriptions on the right.
/// An option's value is what option_text() says ("FILE"), not its type.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_subcommand(const CLI::App* command) const override;
};

}  // namespace plenoflame::cli
