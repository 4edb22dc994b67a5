#include "model/undo_history.h"

#include <utility>

namespace plenoflame::desktop {

void UndoHistory::reset(SceneDocument state) {
  const FlameLook look = this->look();
  states_.clear();
  states_.push_back({std::move(state), {}, {}, ++last_number_, look});
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
  append({std::move(state), what, merge, ++last_number_, look()});
}

void UndoHistory::push_look(const FlameLook& look, const std::string& what,
                            const std::string& merge) {
  const bool continues = !merge.empty() && at_ > 0 && !can_redo() && states_[at_].merge == merge;
  states_.resize(at_ + 1);
  if (continues)
    states_[at_].look = look;
  else
    append({state(), what, merge, states_[at_].number, look});
}

void UndoHistory::begin_look(const FlameLook& look) {
  for (Entry& entry : states_) entry.look = look;
}

void UndoHistory::append(Entry entry) {
  states_.push_back(std::move(entry));
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
