#include "plenoflame/image/staging_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame {

namespace fs = std::filesystem;

StagingFolder::StagingFolder(const std::string& folder) : folder_(folder) {
  int error = EEXIST;
  for (int attempt = 0; error == EEXIST && attempt < 1000; ++attempt) {
    path_ = (fs::path(folder) /
             (".plenoflame." + std::to_string(getpid()) + "-" + std::to_string(attempt) + ".tmp"))
                .string();
    error = mkdir(path_.c_str(), 0777) == 0 ? 0 : errno;
  }
  if (error != 0)
    throw FileError("cannot write into the folder '" + folder +
                    "': " + std::generic_category().message(error));
}

StagingFolder::~StagingFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void StagingFolder::commit() {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_, error))
    files.push_back(entry.path());
  if (error) throw FileError("cannot read '" + path_ + "': " + error.message());
  for (const fs::path& file : files) check_writable((fs::path(folder_) / file.filename()).string());
  for (const fs::path& file : files) {
    fs::path target = fs::path(folder_) / file.filename();
    if (fs::is_symlink(target, error)) target = fs::weakly_canonical(target, error);
    const fs::file_status old = fs::status(target, error);  // who may read it shall not change
    if (fs::exists(old)) fs::permissions(file, old.permissions(), error);
    fs::rename(file, target, error);
    if (error) throw FileError("cannot write '" + target.string() + "': " + error.message());
  }
}

}  // namespace plenoflame
