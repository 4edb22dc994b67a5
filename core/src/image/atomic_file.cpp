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
#include "plenoflame/image/open_file.h"

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

constexpr int kMostLinks = 40;  ///< as the system follows

/// Tells whether a link is one of the system's for the open files of a process: /proc/PID/fd/N.
bool is_descriptor(const fs::path& link) {
  std::error_code error;
  const fs::path folder = fs::canonical(link.parent_path(), error);
  return !error && folder.filename() == "fd" && folder.string().starts_with("/proc/");
}

/// The file that gets the bytes: `path` itself, or what it links to.
std::string follow_links(const std::string& path) {
  std::error_code error;
  fs::path target = path;
  for (int links = 0; fs::is_symlink(target, error); ++links) {
    if (links == kMostLinks)
      throw FileError("cannot write '" + path + "': its symbolic links lead round in a circle");
    // /dev/stdout and its like: what is open is written to by its descriptor, not by replacing it.
    if (is_descriptor(target))
      throw FileError("cannot write '" + path +
                      "': it stands for a stream that is open already; give the name of a file");
    const fs::path next = fs::read_symlink(target, error);
    if (error) return path;
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target.string();
}

/// The first name beside the target that `make` takes, which returns 0 or an errno value.
/// @return the last errno value
template <class Make>
int make_beside(const fs::path& target, std::string& name, const Make& make) {
  // Room for the suffix within the 255 bytes that a name may have.
  std::string stem = ".";
  stem += target.filename().string().substr(0, 200) + "." + std::to_string(getpid()) + "-";
  int error = EEXIST;
  for (int attempt = 0; error == EEXIST && attempt < 1000; ++attempt) {
    name = (target.parent_path() / (stem + std::to_string(attempt) + ".tmp")).string();
    error = make(name.c_str());
  }
  return error;
}

std::string descriptor_name(int descriptor) {
  return "/proc/self/fd/" + std::to_string(descriptor);
}

/// A file without a name, which is gone with the process, however that ends; -1 where the system
/// makes none.
int open_unnamed(const fs::path& folder) {
  const int descriptor =
      open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  // Its name is made from there.
  if (descriptor < 0 || access(descriptor_name(descriptor).c_str(), F_OK) == 0) return descriptor;
  close(descriptor);
  return -1;
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
  int descriptor = open_unnamed(target.parent_path());
  if (descriptor < 0) {
    const int error = make_beside(target, temporary_, [&](const char* name) {
      descriptor = open(name, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      return descriptor < 0 ? errno : 0;
    });
    if (descriptor < 0) fail_for(path_, error);
  }
  if (replaces) static_cast<void>(fchmod(descriptor, existing.st_mode & 07777));
  stream_ = fdopen(descriptor, "w+b");
  if (stream_ == nullptr) {
    const int error = errno;
    close(descriptor);
    if (!temporary_.empty()) unlink(temporary_.c_str());
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
  if (error == 0 && temporary_.empty()) {
    const std::string unnamed = descriptor_name(fileno(stream_));
    error = make_beside(target_, temporary_, [&](const char* name) {
      return linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name, AT_SYMLINK_FOLLOW) != 0 ? errno : 0;
    });
    if (error != 0) temporary_.clear();
  }
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
  const std::unique_ptr<std::FILE, Closer> file(open_for_reading(path));
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
