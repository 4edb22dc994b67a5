#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace plenoflame::cli {

/// Help texts as wide as the terminal: names on the left, wrapped descriptions on the right.
/// An option's value is what option_text() says ("FILE"), not its type.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_description(const CLI::App* command) const override;
  std::string make_usage(const CLI::App* command, std::string name) const override;
  std::string make_footer(const CLI::App* command) const override;
  std::string make_subcommand(const CLI::App* command) const override;
};

}  // namespace plenoflame::cli
