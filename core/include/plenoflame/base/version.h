#pragma once
#include <string_view>

namespace plenoflame {

/// Version of the library, "MAJOR.MINOR.PATCH".
std::string_view version();

}  // namespace plenoflame
