#pragma once
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "plenoflame/base/error.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

class JobCommunicator;

/// The chosen command's work, done once the command line was accepted. @return the exit status
using PlainAction = std::function<int()>;
/// An action that checks the token, which a signal (Ctrl-C, SIGTERM, SIGHUP) requests to stop. It
/// saves its partial result, or throws Cancelled without one.
using StoppableAction = std::function<int(const std::stop_token& stop)>;

/// A setting that a file gave in place of the command line.
struct FileOption {
  SourcePosition position;
  std::string key;
  std::vector<std::string> names;  ///< as messages begin with it: "--basis", "basis"
};

struct Action {
  PlainAction plain;          ///< signals have their usual effect
  StoppableAction stoppable;  ///< one of the two is set
  std::vector<FileOption> file = {};
};

/// A command registers itself with this. Parsing sets `action`; it runs after parsing, so that
/// nothing is read or written when a later option is wrong.
struct Registry {
  CLI::App& app;
  Action& action;
  JobCommunicator* ranks = nullptr;  ///< other processes that help (ranks.h); nullptr: none
};

/// Adds a subcommand whose help ends with an example. A command is one file commands/NAME.cpp:
///
///     void register_example(const Registry& registry) {
///       auto settings = std::make_shared<Settings>();
///       CLI::App& command = add_command(registry, "example", "What it does", "plenoflame example
///       x"); command.add_option("FILE", settings->file, "What it is")->required();
///       on_chosen(command, registry, [settings] { return run(*settings); });
///     }
///
/// declared and called in commands.cpp and commands.h, listed in CMakeLists.txt.
/// @param example one or more lines that can be pasted into a shell
CLI::App& add_command(const Registry& registry, const std::string& name,
                      const std::string& description, const std::string& example);

/// Runs `action` if `command` is the one that was given.
void on_chosen(CLI::App& command, const Registry& registry, PlainAction action);
void on_chosen(CLI::App& command, const Registry& registry, StoppableAction action);

/// A command or subcommand that this build lacks. --help lists it, and its use tells what it needs
/// and how to get that.
/// @param part "OpenVDB" or "VTK"
CLI::App& add_missing(CLI::App& parent, const std::string& name, const std::string& part,
                      const std::string& description);

}  // namespace plenoflame::cli
