#include "model/undo_history.h"

#include <utility>

namespace plenoflame::desktop {

void UndoHistory::reset(SceneDocument state) {
  states_.clear();
  states_.push_back({std::move(state), {}, {}, ++last_number_});
  at_ = 0;
  saved_ = last_number_;
}

void UndoHistory::push(SceneDocument state, const std::string& what, const std::string& merge) {
  const bool continues = !merge.empty() && at_ > 0 && !can_redo() && states_[at_].merge == merge &&
                         states_[at_].number != saved_;
  states_.resize(at_ + 1);
  if (continues) {
    states_[at_].state = std::move(state);
    states_[at_].number = ++last_number_;
    return;
  }
  states_.push_back({std::move(state), what, merge, ++last_number_});
  ++at_;
  if (states_.size() > kMost) {
    states_.erase(states_.begin());
    --at_;
  }
}

void UndoHistory::undo() {
  if (can_undo()) --at_;
}

void UndoHistory::redo() {
  if (can_redo()) ++at_;
}

}  // namespace plenoflame::desktop
