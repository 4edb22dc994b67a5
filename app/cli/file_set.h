#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "plenoflame/image/staging_folder.h"

namespace plenoflame::cli {

/// Files of one command that appear all together, in any folders. A failed write, a stop or an
/// exception leaves everything as it was before.
class FileSet {
 public:
  /// Writes the file that is to be `path`. @param write gets the name to write it under for now
  /// @throws FileError with the name that it is to have, and what `write` throws besides
  void write(const std::string& path, const std::function<void(const std::string& name)>& write);
  /// Puts all of them into their places. @throws FileError; then none is
  void commit();

 private:
  std::map<std::string, std::unique_ptr<StagingFolder>> folders_;
};

/// A folder of results: made when it is missing, and filled all at once.
class ResultFolder {
 public:
  /// @param folder its parent exists @throws FileError
  explicit ResultFolder(const std::string& folder);
  /// Without commit() the folder is as before: gone, if it was not there.
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  /// Writes files. @param write gets the name of the folder to write them to for now
  /// @throws FileError with the names that they are to have, and what `write` throws besides
  void write(const std::function<void(const std::string& folder)>& write);
  /// Puts them into the folder. @throws FileError; then it is as it was before
  void commit();

 private:
  std::string folder_;
  bool made_ = false;
  std::unique_ptr<StagingFolder> staging_;
};

}  // namespace plenoflame::cli
