#pragma once
#include <string>

#include "plenoflame/image/image.h"

namespace plenoflame::cli {

/// Temperatures [K] in false colours, from dark red over yellow to white. Pixels without
/// temperature (0) are black. A bar at the right shows the colours from `low` to `high` with round
/// temperatures. The picture is at least 96 pixels high, for the numbers. @throws FileError
void write_temperature_picture(const std::string& path, const Image& temperature, double low,
                               double high);

}  // namespace plenoflame::cli
