#include "run.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "commands/commands.h"
#include "help_formatter.h"
#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"

namespace plenoflame::cli {
namespace {

int fail(int status, std::string message) {
  // One line, whatever a library put into its message.
  while (!message.empty() && (message.back() == '\n' || message.back() == ' ')) message.pop_back();
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::cout.flush();
  std::cerr << "plenoflame: error: " << message << '\n';
  return status;
}

/// "plenoflame develop --help" for the command that was being parsed.
std::string help_hint(const CLI::App& app) {
  std::string command = "plenoflame";
  for (const CLI::App* chosen : app.get_subcommands()) command += ' ' + chosen->get_name();
  return " (see " + command + " --help)";
}

/// Message about a first argument that is no command; empty: it is one, or an option.
std::string unknown_command(const CLI::App& app, int argc, const char* const* argv) {
  if (argc < 2 || argv[1][0] == '-' || argv[1][0] == '\0') return "";
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == argv[1]) return "";
    names.push_back(command->get_name());
  }
  const std::string nearest = nearest_name(argv[1], names);
  return "unknown command '" + std::string(argv[1]) + "'" +
         (nearest.empty() ? "" : "; did you mean '" + nearest + "'?") + " (see plenoflame --help)";
}

int parse_and_run(int argc, const char* const* argv) {
  CLI::App app{"Simulates a light-field (plenoptic) camera photographing a flame."};
  app.name("plenoflame");
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_version_flag("--version", "plenoflame " + std::string(version()),
                       "Print the version and exit");
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.require_subcommand(1);
  Action action;
  register_commands({app, action});
  if (const std::string wrong = unknown_command(app, argc, argv); !wrong.empty())
    return fail(kBadUse, wrong);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help, --version
    app.exit(request, std::cout, std::cerr);
    return kSuccess;
  } catch (const CLI::RequiredError& error) {
    if (!app.get_subcommands().empty()) return fail(kBadUse, error.what() + help_hint(app));
    const std::vector<std::string> unknown = app.remaining();
    return fail(kBadUse, (unknown.empty() ? "a command is required"
                                          : "unknown option '" + unknown.front() + "'") +
                             help_hint(app));
  } catch (const CLI::ParseError& error) {
    return fail(kBadUse, error.what() + help_hint(app));
  }
  return action ? action() : kSuccess;
}

}  // namespace

int run(int argc, const char* const* argv) {
  try {
    const int status = parse_and_run(argc, argv);
    if (!std::cout.flush()) return fail(kFailure, "standard output cannot be written (disk full?)");
    return status;
  } catch (const UsageError& error) {
    return fail(kBadUse, error.what());
  } catch (const std::bad_alloc&) {
    return fail(kFailure, "not enough memory");
  } catch (const std::exception& error) {
    return fail(kFailure, error.what());
  } catch (...) {
    return fail(kFailure, "unknown failure");
  }
}

}  // namespace plenoflame::cli
