#pragma once
#include <string_view>

#include "plenoflame/base/units.h"

namespace plenoflame {

/// As messages and the reference of the scene call it.
std::string_view dimension_name(Dimension dimension);

}  // namespace plenoflame
