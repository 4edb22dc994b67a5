#pragma once
#include <string>

#include "report.h"

namespace plenoflame::cli {

// What `plenoflame info` says about each kind of file.

/// Light field: camera window, channels with their flux and error, how it was made.
void describe_light_field(const std::string& path, Report& report);
/// Polylines or points of VTK (XML PolyData): numbers and arrays, from the file's head.
void describe_poly_data(const std::string& path, Report& report);
/// Picture: size, bits and texts.
void describe_png(const std::string& path, Report& report);

}  // namespace plenoflame::cli
