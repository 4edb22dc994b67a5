#pragma once
#include <string>

#include "plenoflame/image/image.h"

namespace plenoflame::cli {

/// Temperatures [K] in false colours, from dark red over yellow to white, black where there is none
/// (0); at the right a bar of the colours from `low` to `high` with round temperatures beside it.
/// The picture is at least 96 pixels high, for the numbers. @throws FileError
void write_temperature_picture(const std::string& path, const Image& temperature, double low,
                               double high);

}  // namespace plenoflame::cli
