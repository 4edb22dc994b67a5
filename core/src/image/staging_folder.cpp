#include "plenoflame/image/staging_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kTemporaryPrefix = ".plenoflame.", kTemporarySuffix = ".tmp";

std::string temporary_name(int attempt) {
  return std::string(kTemporaryPrefix) + std::to_string(getpid()) + "-" + std::to_string(attempt) +
         std::string(kTemporarySuffix);
}

/// Tells whether temporary_name() makes such names.
bool is_temporary(std::string_view name) {
  if (!name.starts_with(kTemporaryPrefix) || !name.ends_with(kTemporarySuffix)) return false;
  name.remove_prefix(kTemporaryPrefix.size());
  return name.find_first_not_of("0123456789-") + kTemporarySuffix.size() == name.size();
}

/// @return its descriptor, negative when it cannot be opened; a link is not followed
int open_folder(const char* path) {
  return open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

/// Tells whether the open folder still has this name.
bool is_at(int descriptor, const char* path) {
  struct stat open_one {
  }, named{};
  return fstat(descriptor, &open_one) == 0 && lstat(path, &named) == 0 &&
         open_one.st_dev == named.st_dev && open_one.st_ino == named.st_ino;
}

/// A file on its way to its place. Undone by the destructor, unless it is told to stay.
///
/// Through a symbolic link, which may lead to another file system, it is copied.
class Move {
 public:
  Move(fs::path from, fs::path to) : from_(std::move(from)), to_(std::move(to)) {
    std::error_code none;
    check_writable(to_.string());
    linked_ = fs::is_symlink(to_, none) && fs::is_regular_file(from_, none);
    target_ = to_;
  }
  ~Move() {
    std::error_code none;
    if (moved_ && kept_.empty() && !replaces_) fs::remove_all(target_, none);
    if (moved_ && !kept_.empty()) fs::rename(kept_, target_, none);
    if (!kept_.empty()) fs::remove(kept_, none);
  }
  Move(const Move&) = delete;
  Move& operator=(const Move&) = delete;

  /// @param number differs from that of the others
  void prepare(std::size_t number) {
    if (linked_) copy();
    std::error_code none;
    const fs::file_status old = fs::status(target_, none);  // who may read it shall not change
    replaces_ = fs::exists(old);
    if (replaces_ && !linked_) fs::permissions(from_, old.permissions(), none);
    // A second name for what is replaced; some file systems have none.
    const fs::path kept =
        (linked_ ? target_ : from_).parent_path() /
        (".plenoflame." + std::to_string(getpid()) + "-" + std::to_string(number) + ".kept");
    std::error_code error;
    if (replaces_) fs::create_hard_link(target_, kept, error);
    if (replaces_ && !error) kept_ = kept;
  }
  void go() {
    std::error_code error;
    if (copy_)
      copy_->commit();
    else
      fs::rename(from_, target_, error);
    if (error) throw FileError("cannot write '" + to_.string() + "': " + error.message());
    moved_ = true;
  }
  void stay() { moved_ = false; }

 private:
  void copy() {
    copy_ = std::make_unique<AtomicFile>(to_.string());
    target_ = copy_->target();
    std::ifstream in(from_, std::ios::binary);
    std::vector<char> block(1 << 20);
    while (in.read(block.data(), static_cast<std::streamsize>(block.size())), in.gcount() > 0)
      copy_->write({block.data(), static_cast<std::size_t>(in.gcount())});
    if (!in.eof()) throw FileError("cannot read '" + from_.string() + "'");
    if (std::fflush(copy_->stream()) != 0) copy_->fail(errno);
  }

  fs::path from_, to_;
  fs::path target_;  ///< with links followed
  fs::path kept_;    ///< what is replaced; empty: nothing is, or it cannot be kept
  std::unique_ptr<AtomicFile> copy_;
  bool linked_ = false, replaces_ = false, moved_ = false;
};

}  // namespace

StagingFolder::StagingFolder(const std::string& folder) : folder_(folder) {
  remove_abandoned(folder);
  int error = EEXIST;
  for (int attempt = 0; error == EEXIST && attempt < 1000; ++attempt) {
    path_ = (fs::path(folder) / temporary_name(attempt)).string();
    error = mkdir(path_.c_str(), 0777) == 0 ? 0 : errno;
    // Another process may take the new folder for an abandoned one before it is locked.
    if (error == 0 && !claim()) error = EEXIST;
  }
  if (error != 0)
    throw FileError("cannot write into the folder '" + folder +
                    "': " + std::generic_category().message(error));
}

StagingFolder::~StagingFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (lock_ >= 0) close(lock_);
}

bool StagingFolder::claim() {
  lock_ = open_folder(path_.c_str());
  if (lock_ < 0) return errno != ENOENT;
  const bool taken = flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (!taken && is_at(lock_, path_.c_str())) return true;
  close(lock_);
  lock_ = -1;
  return false;
}

void StagingFolder::remove_abandoned(const std::string& folder) {
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (is_temporary(entry->path().filename().string())) found.push_back(entry->path());
  }
  for (const fs::path& path : found) {
    const int lock = open_folder(path.c_str());
    // A living process holds the lock; on a file system without locks nothing is removed.
    if (lock >= 0 && flock(lock, LOCK_EX | LOCK_NB) == 0 && is_at(lock, path.c_str()))
      fs::remove_all(path, error);
    if (lock >= 0) close(lock);
  }
}

void StagingFolder::commit() {
  commit({this});
}

void StagingFolder::commit(const std::vector<const StagingFolder*>& folders) {
  // Steps that may fail come first. One that fails nevertheless takes back what was moved before
  // it.
  std::vector<std::unique_ptr<Move>> moves;
  for (const StagingFolder* folder : folders) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder->path_, error))
      files.push_back(entry.path());
    if (error) throw FileError("cannot read '" + folder->path_ + "': " + error.message());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files)
      moves.push_back(std::make_unique<Move>(file, fs::path(folder->folder_) / file.filename()));
  }
  for (std::size_t i = 0; i < moves.size(); ++i) moves[i]->prepare(i);
  for (const auto& move : moves) move->go();
  for (const auto& move : moves) move->stay();
}

}  // namespace plenoflame
