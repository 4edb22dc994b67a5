#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "model/flame_look.h"
#include "plenoflame/scene/scene_file.h"

namespace plenoflame::desktop {

/// States of a scene and of how its flame is drawn, the newest last. Whole scenes are kept: they
/// are small, and nothing can be undone wrongly.
class UndoHistory {
 public:
  static constexpr std::size_t kMost = 500;  ///< older states are forgotten

  UndoHistory() : states_(1) {}

  /// Restarts from this state, which counts as saved; the look stays.
  void reset(SceneDocument state);

  /// @param what was done, for the menu  @param merge edits in a row with the same word, not empty,
  ///        become one step (a slider being dragged)
  void push(SceneDocument state, const std::string& what, const std::string& merge = {});

  /// The same for the look. It is no part of the file: a scene that is saved stays so.
  void push_look(const FlameLook& look, const std::string& what, const std::string& merge = {});
  /// Gives every state this look; nothing becomes a step.
  void begin_look(const FlameLook& look);

  bool can_undo() const { return at_ > 0; }
  bool can_redo() const { return at_ + 1 < states_.size(); }
  void undo();
  void redo();
  /// Names of the edit that undo() takes back and of the one that redo() does again; empty when
  /// there is nothing.
  std::string undo_text() const { return can_undo() ? states_[at_].what : std::string(); }
  std::string redo_text() const { return can_redo() ? states_[at_ + 1].what : std::string(); }

  const SceneDocument& state() const { return states_[at_].state; }
  const FlameLook& look() const { return states_[at_].look; }

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
    std::size_t number = 1;  ///< of the scene's text: the same when only the look differs
    FlameLook look;
  };
  void append(Entry entry);

  std::vector<Entry> states_;
  std::size_t at_ = 0, saved_ = 1, last_number_ = 1;
};

}  // namespace plenoflame::desktop
