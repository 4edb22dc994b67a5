// Files that this process has open: by them a test sees how far something is written that has no
// name before it is complete.
#pragma once
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>

namespace plenoflame::test {

/// Bytes of the largest file of a folder that this process has open, 0 while there is none.
inline off_t open_in(const std::string& folder) {
  off_t size = 0;
  std::error_code gone;
  for (std::filesystem::directory_iterator entry("/proc/self/fd", gone), end; !gone && entry != end;
       entry.increment(gone)) {
    std::error_code closed;
    struct stat file {};
    if (std::filesystem::read_symlink(entry->path(), closed).string().starts_with(folder + "/") &&
        stat(entry->path().c_str(), &file) == 0 && S_ISREG(file.st_mode))
      size = std::max(size, file.st_size);
  }
  return size;
}

}  // namespace plenoflame::test
