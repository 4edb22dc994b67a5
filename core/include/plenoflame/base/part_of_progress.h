#pragma once
#include "plenoflame/base/execution.h"

namespace plenoflame {

/// The same with progress within a part of the whole. @param execution must outlive it
inline Execution part_of_progress(const Execution& execution, double from, double share) {
  Execution part = execution;
  if (execution.progress)
    part.progress = [&execution, from, share](Progress progress) {
      progress.fraction = from + share * progress.fraction;
      execution.progress(progress);
    };
  return part;
}

}  // namespace plenoflame
