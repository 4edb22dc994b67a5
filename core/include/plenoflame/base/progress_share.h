#pragma once
#include "plenoflame/base/execution.h"

namespace plenoflame {

/// The Execution of a part of a longer work, which keeps the reported progress from falling between
/// parts. The part's progress from 0 to 1 is reported as `from` to `to` of the whole. The remaining
/// time is that of the part and, in proportion, of the parts after it.
/// @param from, to 0 <= from < to <= 1
Execution share_of(const Execution& whole, double from, double to);

}  // namespace plenoflame
