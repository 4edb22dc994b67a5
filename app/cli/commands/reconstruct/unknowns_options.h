#pragma once
#include "unknowns_request.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

void add_unknowns_options(CLI::App& command, UnknownsRequest& arguments);

}  // namespace plenoflame::cli
