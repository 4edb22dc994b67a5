#pragma once
#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/base/units.h"
#include "plenoflame/image/image.h"
#include "plenoflame/math/readable.h"
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// Reads an option's value with its unit. @param option as the user writes it, e.g. "--saturation"
/// @throws UsageError "OPTION: ..."
double quantity_option(std::string_view option, const std::string& text, Dimension dimension);

/// Reads a time that a run may take [s]: with its unit, where "10m" means minutes, or as batch
/// systems have it: D-HH:MM:SS, HH:MM:SS, MM:SS, D-HH, D-HH:MM. @throws UsageError "OPTION: ..."
double duration_option(std::string_view option, const std::string& text);

/// Reads "X,Y,W,H": whole numbers, X and Y not negative, W and H at least 1. @throws UsageError
PixelWindow window_option(std::string_view option, const std::string& text);

/// A whole number in [least, greatest], written plainly or as 1e6. For int and std::uint64_t.
/// @throws UsageError
template <class Number>
Number whole_number_option(std::string_view option, const std::string& text, Number least,
                           Number greatest = std::numeric_limits<Number>::max());

/// Two whole numbers with a separator between: "3,-4". @param form expected form, e.g. "X,Y"
/// @throws UsageError
std::array<int, 2> pair_option(std::string_view option, const std::string& text,
                               std::string_view form, char separator = ',');

/// A point of the world [m]: three lengths, "1 m, 0 m, -29 mm". @throws UsageError
std::array<double, 3> point_option(std::string_view option, const std::string& text);

/// A box by two of its corners, "1 m, 0 m, 0 mm : 2 m, 1 m, 5 mm" [m].
/// @throws UsageError for anything else, and for a box without volume
Box box_option(std::string_view option, const std::string& text);

/// The fault of an output's name, which must have one of these endings; empty: none.
std::string wrong_ending(const std::string& output, const std::vector<std::string>& endings);

/// @throws UsageError for an output with a wrong ending
void check_ending(std::string_view option, const std::string& output,
                  const std::vector<std::string>& endings);

/// True if both are one file or folder, by whatever names (links, "./"), even if it does not exist.
bool is_same_file(const std::string& a, const std::string& b);

/// Refuses to write over a file that is read. @throws UsageError when both are the same file
void check_not_overwritten(std::string_view option, const std::string& output,
                           const std::string& input);

/// A number in [least, greatest]. @throws UsageError
double number_option(std::string_view option, const std::string& text, double least,
                     double greatest);

/// One of these words; an empty one stands for none. @throws UsageError naming the nearest
void check_choice(std::string_view option, const std::string& text,
                  const std::vector<std::string>& words);

/// The name in `candidates` that `name` probably means: least edit distance, at most a third of its
/// length. Empty: no name is near.
std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace plenoflame
