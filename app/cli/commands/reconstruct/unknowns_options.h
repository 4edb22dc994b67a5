#pragma once
#include <string>

#include "unknowns_request.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

void add_unknowns_options(CLI::App& command, UnknownsRequest& arguments);
/// --bin and --cells, as rows_option() takes them.
void add_rows_options(CLI::App& command, std::string& bin, std::string& cells);

}  // namespace plenoflame::cli
