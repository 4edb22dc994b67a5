#pragma once
#include <string>
#include <vector>

namespace plenoflame {

/// Files that appear in a folder all together. They are written into a temporary folder within it,
/// and commit() moves them out. Without commit() the destructor removes the temporary folder, and
/// the folder is as it was before. A killed process leaves its temporary folder; the next process
/// that writes into the same folder removes it.
class StagingFolder {
 public:
  /// @param folder exists
  /// @throws FileError naming it and the cause: missing, no permission, disk full
  explicit StagingFolder(const std::string& folder);
  ~StagingFolder();
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;

  /// The folder for writing the files.
  const std::string& path() const { return path_; }
  /// Moves them into the folder, over those of the same names; through symbolic links, too.
  /// @throws FileError as AtomicFile; then the folder is as it was before
  void commit();
  /// The same for several folders: all of their files appear, or none.
  static void commit(const std::vector<const StagingFolder*>& folders);
  /// Removes the temporary folders that killed processes left within a folder. Folders in use are
  /// kept: their process holds a lock, which ends with it. Folders that cannot be removed stay.
  static void remove_abandoned(const std::string& folder);

 private:
  /// Locks the new folder. @return whether it is still there
  bool claim();

  std::string folder_, path_;
  int lock_ = -1;  ///< the open folder at path_
};

}  // namespace plenoflame
