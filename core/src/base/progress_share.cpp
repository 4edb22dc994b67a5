#include "plenoflame/base/progress_share.h"

namespace plenoflame {

Execution share_of(const Execution& whole, double from, double to) {
  Execution part = whole;
  if (!whole.progress) return part;
  part.progress = [report = whole.progress, from, to](Progress progress) {
    const double done = progress.fraction;
    progress.fraction = from + (to - from) * done;
    // The part takes remaining / (1 - done) seconds in all, what follows in proportion to it.
    if (to < 1 && progress.remaining_seconds >= 0)
      progress.remaining_seconds =
          done < 1 ? progress.remaining_seconds * (1 + (1 - to) / ((to - from) * (1 - done))) : -1;
    report(progress);
  };
  return part;
}

}  // namespace plenoflame
