#pragma once
#include <vector>

namespace plenoflame {

/// The factors on its absorption that a medium keeps, one per channel: none when all are 1.
/// @throws InputError for another number of them, or one that is not a number of at least 0
std::vector<double> grey_or_checked(std::vector<double> factors, std::size_t channels);

}  // namespace plenoflame
