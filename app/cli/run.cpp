#include "run.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "build_information.h"
#include "commands/commands.h"
#include "commands/settings_file.h"
#include "help_formatter.h"
#include "messages.h"
#include "options.h"
#include "outputs.h"
#include "plenoflame/base/error.h"
#include "ranks.h"
#include "settings.h"

namespace plenoflame::cli {
namespace {

int fail(int status, std::string message) {
  // One line, whatever a library put into its message.
  while (!message.empty() && (message.back() == '\n' || message.back() == ' ')) message.pop_back();
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::cout.flush();
  say("error: " + message);
  return status;
}

/// The command that was being parsed: the innermost one.
const CLI::App& chosen_command(const CLI::App& app) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  return chosen.empty() ? app : chosen_command(*chosen.front());
}

/// "plenoflame develop --help" for it.
std::string help_hint(const CLI::App& app) {
  std::string command = "plenoflame";
  for (const CLI::App* at = &app; !at->get_subcommands().empty();) {
    at = at->get_subcommands().front();
    command += ' ' + at->get_name();
  }
  return " (see " + command + " --help)";
}

/// About arguments that the command does not take; empty: there are none.
std::string unexpected_arguments(const CLI::App& app) {
  const CLI::App& command = chosen_command(app);
  const std::vector<std::string> arguments = command.remaining();
  std::vector<std::string> options;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
  for (const std::string& argument : arguments) {
    if (argument.size() < 2 || argument[0] != '-') continue;
    const std::string name = argument.substr(0, argument.find('='));
    const std::string nearest = nearest_name(name, options);
    return "unknown option '" + name + "'" +
           (nearest.empty() ? "" : "; did you mean '" + nearest + "'?");
  }
  std::string list;
  for (const std::string& argument : arguments)
    list.append(list.empty() ? "'" : ", '").append(argument).append("'");
  if (list.empty()) return "";
  return (arguments.size() == 1 ? "unexpected argument " : "unexpected arguments ") + list +
         "; put a value with blanks in quotes";
}

/// About an option that is given more often than it takes values; empty: there is none.
std::string option_given_twice(const CLI::App& app) {
  for (const CLI::Option* option : chosen_command(app).get_options()) {
    const std::size_t given = option->results().size();
    if (given < 2 || given <= static_cast<std::size_t>(option->get_items_expected_max())) continue;
    const std::string name =
        option->get_lnames().empty() ? option->get_name() : "--" + option->get_lnames().front();
    return name + " is given " + (given == 2 ? "twice" : std::to_string(given) + " times") + ": '" +
           option->results()[0] + "' and '" + option->results()[1] + "'; give it once";
  }
  return "";
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

int act(const Action& action, std::optional<InterruptHandler>& interrupt) {
  if (interrupt && interrupt->interrupted()) throw Cancelled();
  if (action.stoppable) return action.stoppable(interrupt ? interrupt->token() : std::stop_token());
  interrupt.reset();
  return action.plain ? action.plain() : kSuccess;
}

/// The status where there is nothing to run.
std::optional<int> parse(CLI::App& app, Action& action, int argc, const char* const* argv,
                         JobCommunicator* ranks) {
  app.name("plenoflame");
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_version_flag("--version", build_information(),
                       "Print version, commit, parts and instruction set, and exit");
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.require_subcommand(1);
  register_commands({app, action, ranks});
  if (const std::string wrong = unknown_command(app, argc, argv); !wrong.empty())
    return fail(kBadUse, wrong);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help, --version
    app.exit(request, std::cout, std::cerr);
    return kSuccess;
  } catch (const CLI::RequiredError& error) {
    // A misspelt option comes first: it may be the one that is missing.
    const std::string unexpected = unexpected_arguments(app);
    if (!unexpected.empty()) return fail(kBadUse, unexpected + help_hint(app));
    if (!app.get_subcommands().empty()) return fail(kBadUse, error.what() + help_hint(app));
    return fail(kBadUse, "a command is required" + help_hint(app));
  } catch (const CLI::ExtrasError& error) {
    const std::string unexpected = unexpected_arguments(app);
    return fail(kBadUse, (unexpected.empty() ? error.what() : unexpected) + help_hint(app));
  } catch (const CLI::ArgumentMismatch& error) {
    const std::string twice = option_given_twice(app);
    return fail(kBadUse, (twice.empty() ? error.what() : twice) + help_hint(app));
  } catch (const CLI::ParseError& error) {
    return fail(kBadUse, error.what() + help_hint(app));
  }
  check_outputs(app);
  return std::nullopt;
}

int parse_and_run(int argc, const char* const* argv, std::optional<InterruptHandler>& interrupt,
                  JobCommunicator* ranks) {
  CLI::App app{"Simulates a light-field (plenoptic) camera photographing a flame."};
  Action action;
  try {
    try {
      if (const std::optional<int> ended = parse(app, action, argc, argv, ranks)) return *ended;
    } catch (const std::bad_alloc&) {
      return fail(kFailure, "the limit on memory (ulimit -v) is too low to start");
    }
    return act(action, interrupt);
  } catch (const UsageError& error) {
    throw_at_key(action.file, kOptionNames.message(error));
    throw;
  }
}

}  // namespace

int run(int argc, const char* const* argv) {
  std::optional<InterruptHandler> interrupt;
  try {
    interrupt.emplace();
  } catch (const std::exception&) {
    // Without a thread to wait for signals they have their usual effect.
  }
  const int status = run(argc, argv, interrupt);
  if (interrupt) interrupt->ignore_from_now();
  return status;
}

namespace {

/// @param ranks that help; nullptr: none
int run_alone(int argc, const char* const* argv, std::optional<InterruptHandler>& interrupt,
              JobCommunicator* ranks) {
  try {
    const int status = parse_and_run(argc, argv, interrupt, ranks);
    if (!std::cout.flush()) return fail(kFailure, "standard output cannot be written (disk full?)");
    return status;
  } catch (const Cancelled&) {
    std::cout.flush();
    std::cerr << "plenoflame: stopped; nothing was written\n";
    return kFailure;
  } catch (const UsageError& error) {
    return fail(kBadUse, kOptionNames.message(error));
  } catch (const Error& error) {
    return fail(kFailure, kOptionNames.message(error));
  } catch (const std::bad_alloc&) {
    return fail(kFailure, "not enough memory");
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::resource_unavailable_try_again)
      return fail(
          kFailure,
          "no thread can be started: the limit on processes or on memory (ulimit -u, -v) is "
          "reached");
    return fail(kFailure, error.what());
  } catch (const std::exception& error) {
    return fail(kFailure, error.what());
  } catch (...) {
    return fail(kFailure, "unknown failure");
  }
}

}  // namespace

int run(int argc, const char* const* argv, std::optional<InterruptHandler>& interrupt) {
  std::unique_ptr<JobCommunicator> ranks;
  try {
    ranks = join_ranks();
  } catch (const std::exception& error) {
    return is_further_rank() ? kBadUse : fail(kBadUse, error.what());
  }
  if (!ranks) return run_alone(argc, argv, interrupt, nullptr);
  if (ranks->rank() > 0) {
    serve_ranks(*ranks, interrupt ? interrupt->token() : std::stop_token());
    ranks->finish();
    return kSuccess;
  }
  const int status = run_alone(argc, argv, interrupt, ranks.get());
  if (dismiss_ranks(*ranks))
    ranks->finish();
  else
    say("a rank does not answer: its process or its machine has stopped");
  return status;
}

}  // namespace plenoflame::cli
