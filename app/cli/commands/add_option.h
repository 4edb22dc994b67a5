#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace plenoflame::cli {

/// Adds an option. @param form of its value in the help, "FILE.exr"
template <class Value>
CLI::Option* add_option(CLI::App& command, const std::string& names, Value& value,
                        const std::string& form, const std::string& help) {
  return command.add_option(names, value, help)->option_text(form);
}

/// Adds --threads.
inline void add_threads_option(CLI::App& command, int& threads) {
  add_option(command, "--threads", threads, "N", "Worker threads; 0: one per processor (0)")
      ->check(CLI::Range(0, 4096));
}

}  // namespace plenoflame::cli
