#include "plenoflame/image/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_for(const std::string& path, int error) {
  const std::string folder = fs::path(path).parent_path().string();
  const std::string where = folder.empty() ? "the current folder" : "folder '" + folder + "'";
  std::error_code ignored;
  switch (error) {
    case ENOENT:
      // A folder that exists and takes no files, such as /proc, says the same.
      if (folder.empty() || fs::is_directory(folder, ignored))
        throw FileError("cannot write '" + path + "': " + where + " takes no files");
      throw FileError("cannot write '" + path + "': " + where + " does not exist; create it first");
    case ENOTDIR:
      throw FileError("cannot write '" + path + "': " + where + " is not a folder");
    case EACCES:
    case EPERM:
      throw FileError("cannot write '" + path + "': no permission to write in " + where);
    case EROFS:
      throw FileError("cannot write '" + path + "': " + where + " is on a read-only file system");
    case ENOSPC:
    case EDQUOT:
      throw FileError("cannot write '" + path + "': the disk is full; nothing was changed");
    case EFBIG:
      throw FileError("cannot write '" + path + "': it exceeds the largest file size allowed here");
    case ENAMETOOLONG:
      throw FileError("cannot write '" + path + "': the name is too long");
    default:
      throw FileError("cannot write '" + path + "': " +
                      (error != 0 ? std::generic_category().message(error) : "unknown failure"));
  }
}

/// Where the bytes go: `path` itself, or what it links to.
std::string follow_links(const std::string& path) {
  std::error_code error;
  fs::path target = path;
  for (int links = 0; links < 40 && fs::is_symlink(target, error); ++links) {
    const fs::path next = fs::read_symlink(target, error);
    if (error) return path;
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target.string();
}

}  // namespace

AtomicFile::AtomicFile(const std::string& path) : path_(path), target_(follow_links(path)) {
  if (path.empty()) throw FileError("cannot write a file without a name");
  struct stat existing {};
  const bool replaces = stat(target_.c_str(), &existing) == 0;
  if (replaces && S_ISDIR(existing.st_mode))
    throw FileError("cannot write '" + path_ + "': it is a folder; give a file name");
  // Renaming over a device would replace the device.
  if (replaces && !S_ISREG(existing.st_mode))
    throw FileError("cannot write '" + path_ + "': it is not a regular file");
  if (replaces && faccessat(AT_FDCWD, target_.c_str(), W_OK, AT_EACCESS) != 0)
    throw FileError("cannot write '" + path_ + "': the file is write-protected");

  const fs::path target(target_);
  if (target.filename().empty())
    throw FileError("cannot write '" + path_ + "': it is a folder; give a file name");
  // Room for the suffix within the 255 bytes that a name may have.
  std::string stem = ".";
  stem += target.filename().string().substr(0, 200);
  int descriptor = -1;
  for (int attempt = 0; descriptor < 0 && attempt < 1000; ++attempt) {
    temporary_ = (target.parent_path() /
                  (stem + "." + std::to_string(getpid()) + "-" + std::to_string(attempt) + ".tmp"))
                     .string();
    descriptor = open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno != EEXIST) break;
  }
  if (descriptor < 0) fail_for(path_, errno);
  if (replaces) static_cast<void>(fchmod(descriptor, existing.st_mode & 07777));
  stream_ = fdopen(descriptor, "w+b");
  if (stream_ == nullptr) {
    const int error = errno;
    close(descriptor);
    unlink(temporary_.c_str());
    fail_for(path_, error);
  }
}

AtomicFile::~AtomicFile() {
  discard();
}

void AtomicFile::discard() noexcept {
  if (stream_ != nullptr) std::fclose(stream_);
  stream_ = nullptr;
  if (!temporary_.empty()) unlink(temporary_.c_str());
  temporary_.clear();
}

void AtomicFile::fail(int error) const {
  fail_for(path_, error);
}

void AtomicFile::write(std::string_view bytes) {
  if (bytes.empty()) return;  // of nothing there may be no address, which fwrite() must have
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size()) fail(errno);
}

void AtomicFile::commit() {
  int error = 0;
  errno = 0;
  if (std::ferror(stream_) != 0 || std::fflush(stream_) != 0) error = errno != 0 ? errno : EIO;
  if (std::fclose(stream_) != 0 && error == 0) error = errno;
  stream_ = nullptr;
  if (error == 0 && std::rename(temporary_.c_str(), target_.c_str()) != 0) error = errno;
  if (error != 0) {
    discard();
    fail(error);
  }
  temporary_.clear();
}

void write_file(const std::string& path, std::string_view contents) {
  AtomicFile file(path);
  file.write(contents);
  file.commit();
}

void check_writable(const std::string& path) {
  const AtomicFile probe(path);
}

std::string read_file(const std::string& path) {
  const auto fail = [&path](int error) {
    throw FileError("cannot read '" + path + "': " + std::generic_category().message(error));
  };
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Closer> file(std::fopen(path.c_str(), "rb"));
  if (!file) fail(errno);
  std::string contents;
  std::array<char, 65536> block{};
  for (;;) {
    const std::size_t count = std::fread(block.data(), 1, block.size(), file.get());
    contents.append(block.data(), count);
    if (count < block.size()) break;
  }
  if (std::ferror(file.get()) != 0) fail(errno);
  return contents;
}

}  // namespace plenoflame
