#pragma once
#include "plenoflame/scene/render_spec.h"

namespace plenoflame::cli {

/// The word of `--estimator`.
inline const char* name_of(Estimator estimator) {
  return estimator == Estimator::forward ? "forward" : "backward";
}

}  // namespace plenoflame::cli
