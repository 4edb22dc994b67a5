#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "plenoflame/scene/scene_file.h"

namespace plenoflame::desktop {

/// States of a scene, the newest last. Whole scenes are kept: they are small, and nothing can be
/// undone wrongly.
class UndoHistory {
 public:
  static constexpr std::size_t kMost = 500;  ///< older states are forgotten

  /// Begins anew with this state, which counts as saved.
  void reset(SceneDocument state);

  /// @param what was done, for the menu  @param merge edits in a row with the same word, not empty,
  ///        become one step (a slider being dragged)
  void push(SceneDocument state, const std::string& what, const std::string& merge = {});

  bool can_undo() const { return at_ > 0; }
  bool can_redo() const { return at_ + 1 < states_.size(); }
  void undo();
  void redo();
  /// What undo() takes back, and what redo() does again; empty when there is nothing.
  std::string undo_text() const { return can_undo() ? states_[at_].what : std::string(); }
  std::string redo_text() const { return can_redo() ? states_[at_ + 1].what : std::string(); }

  const SceneDocument& state() const { return states_[at_].state; }

  /// Changes every state alike; nothing becomes a step.
  template <class Change>
  void update_all(Change change) {
    for (Entry& entry : states_) change(entry.state.scene);
  }

  void set_saved() { saved_ = states_[at_].number; }
  bool saved() const { return saved_ == states_[at_].number; }
  /// No state counts as saved (a scene that was recovered).
  void forget_saved() { saved_ = 0; }

 private:
  struct Entry {
    SceneDocument state;
    std::string what, merge;
    std::size_t number;  ///< never used twice
  };
  std::vector<Entry> states_{Entry{{}, {}, {}, 1}};
  std::size_t at_ = 0, saved_ = 1, last_number_ = 1;
};

}  // namespace plenoflame::desktop
