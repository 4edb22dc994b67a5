#pragma once
#include <string>
#include <vector>

#include "model/document.h"

namespace plenoflame::desktop {

/// Keeps a mark of the running program and a copy of the present scene in its own folder. Both are
/// removed when the program ends normally. Copies of programs that still run are left alone.
class Recovery {
 public:
  /// @param folder is made when it does not exist
  explicit Recovery(std::string folder);
  /// Takes copy and mark away.
  ~Recovery();
  Recovery(const Recovery&) = delete;
  Recovery& operator=(const Recovery&) = delete;

  /// Writes the copy, or removes it when the document has nothing unsaved. @throws FileError
  void keep(const Document& document);
  const std::string& path() const { return path_; }

  /// Copies that programs left behind.
  std::vector<RecoveredScene> left_behind() const;
  /// True if a program that used the folder is gone without having ended as it should; says so
  /// once.
  bool ended_badly();
  static void discard(const RecoveredScene& scene);

 private:
  std::string folder_, path_, mark_;
};

}  // namespace plenoflame::desktop
