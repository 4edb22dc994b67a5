#pragma once
#include <string>
#include <vector>

#include "inverse_settings.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

struct FileOption;

/// Arguments of the command line of `operator`.
struct OperatorArguments : OperatorRequest {
  std::string scene, output, pixels, places, part;
  std::vector<std::string> set, cameras;
  int threads = 0;
  bool json = false, quiet = false;
};

void add_operator_options(CLI::App& command, OperatorArguments& arguments,
                          std::vector<FileOption>& file);

}  // namespace plenoflame::cli
