#pragma once
#include "plenoflame/base/execution.h"

namespace plenoflame {

/// The surroundings of a part of a longer work, so that what is reported never falls from one part
/// to the next: the part's progress from 0 to 1 is reported as `from` to `to` of the whole, and the
/// time that is left as that of the part and, in proportion, of all that follows it.
/// @param from, to 0 <= from < to <= 1
Execution share_of(const Execution& whole, double from, double to);

}  // namespace plenoflame
