#pragma once
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/base/units.h"
#include "plenoflame/volumes/flame_file.h"

/// The one table of flames that can be generated. The command, the desktop application, VTK and
/// Python follow it: a new generator or parameter needs an entry here only. The file
/// flame_library.h has the formulas of the parameters.
namespace plenoflame {

enum class FlameParameterType {
  quantity,      ///< a number with the unit of the dimension
  whole_number,  ///< 0 to 2^64 - 1
  file,          ///< a TOML file of layers
  lines,         ///< emission lines with their peaks: "ch, na_d=2 kW/m^3"
};

struct FlameParameter {
  std::string name;   ///< "peak_volume_fraction"
  std::string about;  ///< what it is, in one phrase
  FlameParameterType type = FlameParameterType::quantity;
  Dimension dimension = Dimension::none;
  std::string value;  ///< the default with its unit; empty: none
};

/// Values by the names of parameters, as text with units; what is missing has its default.
using FlameValues = std::map<std::string, std::string>;

struct FlameGenerator {
  std::string_view name;  ///< "candle"
  std::string_view what;  ///< one line about it
  std::vector<FlameParameter> (*parameters)();
  FlameFields (*make)(const FlameValues& values, const Execution& execution);
};

std::span<const FlameGenerator> flame_generators();

/// @throws InputError: there is none of this name (lists those there are)
const FlameGenerator& flame_generator(std::string_view name);

/// Refuses a value that make() would refuse, with a message that does not name the parameter.
/// @throws InputError: no such parameter of this flame, a missing or wrong unit, out of range
void check_flame_value(const FlameGenerator& generator, const std::string& parameter,
                       const std::string& value);

/// @throws InputError naming the parameter that is wrong; FileError for a file of layers
FlameFields generate_flame(std::string_view name, const FlameValues& values,
                           const Execution& execution);

/// The metadata of a generated flame's file, which say how it was made: its name, seeds and the
/// values that were given.
/// @throws InputError: there is none of this name
std::map<std::string, std::string> flame_metadata(std::string_view name, const FlameValues& values);

}  // namespace plenoflame
