#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/report.h"

namespace plenoflame::cli {

// Reports of `plenoflame info`, one for each kind of file.

/// Light field: camera window, channels with their flux and error, how it was made.
void describe_light_field(const std::string& path, Report& report);
/// Polylines or points of VTK (XML PolyData): numbers and arrays, from the file's head.
void describe_poly_data(const std::string& path, Report& report);
/// Scene: camera, flames, channels; warnings go to standard error. @throws InputError at the place
/// in the file of what is wrong
void describe_scene(const std::string& path, const std::vector<std::string>& set, Report& report);
/// The scene with every key that has a value, presets resolved. @param set of --set
std::string complete_scene(const std::string& path, const std::vector<std::string>& set);
/// Flame (only with PLENOFLAME_HAS_VOLUMES): every grid of a .vdb, and what a scene would make of
/// it.
void describe_vdb(const std::string& path, Report& report);
/// Picture: size, bits and texts.
void describe_png(const std::string& path, Report& report);

}  // namespace plenoflame::cli
