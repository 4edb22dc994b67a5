#pragma once
#include <cstdio>
#include <string>
#include <string_view>

namespace plenoflame {

/// A file that appears under its name only when it is complete. It is written under a temporary
/// name in the same folder and renamed by commit(). Without commit() the destructor removes it, and
/// an earlier file of the name is untouched. A symbolic link is followed; a replaced file's
/// permissions are kept.
class AtomicFile {
 public:
  /// Creates the temporary file.
  /// @throws FileError naming path and cause: folder missing, no permission, name is a folder or a
  ///         device, write-protected, disk full
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Path of the file, symbolic links followed.
  const std::string& target() const { return target_; }
  /// Appends. @throws FileError
  void write(std::string_view bytes);
  /// The buffered stream, for libraries that want one; its errors are found by commit(), too.
  std::FILE* stream() { return stream_; }
  /// Throws the FileError that describes errno value `error` for this file.
  [[noreturn]] void fail(int error) const;
  /// Flushes, closes and renames. @throws FileError, with the temporary file removed
  void commit();

 private:
  void discard() noexcept;

  std::string path_;    ///< as the caller wrote it, for messages
  std::string target_;  ///< with symbolic links followed
  std::string temporary_;
  std::FILE* stream_ = nullptr;
};

/// Writes a whole file by way of AtomicFile. @throws FileError
void write_file(const std::string& path, std::string_view contents);

/// Finds out whether a file could be written under this name, before work is spent on its contents.
/// Leaves nothing behind. @throws FileError as AtomicFile's constructor
void check_writable(const std::string& path);

/// Reads a whole file. @throws FileError naming path and cause
std::string read_file(const std::string& path);

}  // namespace plenoflame
