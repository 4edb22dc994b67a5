#pragma once
#include <map>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/base/units.h"
#include "plenoflame/volumes/flame_file.h"

namespace plenoflame::desktop {

/// One parameter of a generated flame.
struct GeneratorField {
  std::string name;   ///< "peak volume fraction"
  std::string about;  ///< what it is, for a tooltip
  Dimension dimension = Dimension::none;
  std::string value;  ///< with unit
};

/// "layered", "candle", "diffusion", "cylinder", "turbulent": as `plenoflame flame` names them.
std::vector<std::string> generator_names();

/// Its parameters with their defaults. @throws InputError: unknown name
std::vector<GeneratorField> generator_fields(const std::string& name);

/// @param values by the fields' names, as text with units; what is missing has its default
/// @throws InputError naming the field that is wrong
FlameFields generate_flame(const std::string& name,
                           const std::map<std::string, std::string>& values,
                           const Execution& execution);

/// Writes both grids as `plenoflame flame` does. @throws FileError, InputError
void write_flame(const std::string& path, const FlameFields& fields,
                 const std::stop_token& stop = {});

}  // namespace plenoflame::desktop
