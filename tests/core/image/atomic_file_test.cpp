#include "plenoflame/image/atomic_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <memory>

#include "plenoflame/base/error.h"
#include "plenoflame/image/open_file.h"
#include "support/temporary_folder.h"

namespace plenoflame::atomic_file_test {
namespace {

namespace fs = std::filesystem;
using test::read_bytes;
using test::TemporaryFolder;
using test::write_bytes;

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const FileError& error) {
    return error.what();
  }
  return "no FileError";
}

void expect_mentions(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

/// Root may write everywhere; permissions are tested as somebody else.
class Unprivileged {
 public:
  explicit Unprivileged(const TemporaryFolder& folder) {
    if (geteuid() != 0) return;
    EXPECT_EQ(chmod(folder.path().c_str(), 0755), 0);
    EXPECT_EQ(seteuid(65534), 0);
    changed_ = true;
  }
  ~Unprivileged() {
    if (changed_) {
      EXPECT_EQ(seteuid(0), 0);
    }
  }

 private:
  bool changed_ = false;
};

TEST(AtomicFile, AppearsOnlyWhenCommitted) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.txt");
  AtomicFile file(path);
  file.write("first ");
  EXPECT_FALSE(fs::exists(path));
  file.write("second");
  file.commit();
  EXPECT_EQ(read_bytes(path), "first second");
  EXPECT_EQ(folder.names().size(), 1U);
}

// However a process ends, the old file is whole, and half a file is left only where the file system
// makes no files without a name.
TEST(AtomicFile, AKilledProcessLeavesTheOldFileAlone) {
  const TemporaryFolder folder;
  const int probe = open(folder.path().c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (probe >= 0) close(probe);
  write_bytes(folder.file("a.txt"), "old");
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    AtomicFile file(folder.file("a.txt"));
    file.write("half");
    std::fflush(file.stream());
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status));
  if (probe >= 0) {
    EXPECT_EQ(folder.names(), std::vector<std::string>{"a.txt"});
  }
  EXPECT_EQ(read_bytes(folder.file("a.txt")), "old");
}

TEST(AtomicFile, LeavesTheOldFileWhenGivenUp) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.txt");
  write_bytes(path, "old");
  {
    AtomicFile file(path);
    file.write("new");
    EXPECT_EQ(read_bytes(path), "old");
  }
  EXPECT_EQ(read_bytes(path), "old");
  EXPECT_EQ(folder.names().size(), 1U);
}

TEST(AtomicFile, TwoAtOnceDoNotMix) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.txt");
  AtomicFile one(path), two(path);
  one.write("one");
  two.write("two");
  one.commit();
  EXPECT_EQ(read_bytes(path), "one");
  two.commit();
  EXPECT_EQ(read_bytes(path), "two");
}

TEST(AtomicFile, KeepsPermissionsAndFollowsLinks) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.txt"), link = folder.file("link.txt");
  write_bytes(path, "old");
  ASSERT_EQ(chmod(path.c_str(), 0640), 0);
  fs::create_symlink("a.txt", link);
  write_file(link, "new");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(read_bytes(path), "new");
  struct stat status {};
  ASSERT_EQ(stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0640U);

  // A new file has what the process's mask leaves, like any other.
  const mode_t mask = umask(027);
  write_file(folder.file("b.txt"), "b");
  umask(mask);
  ASSERT_EQ(stat(folder.file("b.txt").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0640U);
}

TEST(AtomicFile, NamesTheCause) {
  const TemporaryFolder folder;
  expect_mentions(message_of([&] { write_file(folder.file("none/a.txt"), ""); }),
                  "none' does not exist");
  write_bytes(folder.file("plain"), "");
  expect_mentions(message_of([&] { write_file(folder.file("plain/a.txt"), ""); }),
                  "plain' is not a folder");
  expect_mentions(message_of([&] { write_file(folder.path(), ""); }), "is a folder");
  expect_mentions(message_of([&] { write_file(folder.path() + "/", ""); }), "is a folder");
  expect_mentions(message_of([&] { write_file("/dev/null", ""); }), "not a regular file");
  expect_mentions(message_of([&] { write_file("", ""); }), "without a name");
  expect_mentions(message_of([&] { write_file(folder.file(std::string(300, 'n')), ""); }),
                  "too long");
  EXPECT_EQ(folder.names().size(), 1U);
}

TEST(AtomicFile, LongNamesWork) {
  const TemporaryFolder folder;
  const std::string path = folder.file(std::string(250, 'n'));
  write_file(path, "long");
  EXPECT_EQ(read_bytes(path), "long");
}

TEST(AtomicFile, NamesMissingPermission) {
  const TemporaryFolder folder;
  fs::create_directory(folder.file("locked"));
  write_bytes(folder.file("protected.txt"), "old");
  ASSERT_EQ(chmod(folder.file("protected.txt").c_str(), 0444), 0);
  ASSERT_EQ(chmod(folder.file("locked").c_str(), 0555), 0);
  {
    const Unprivileged guard(folder);
    expect_mentions(message_of([&] { check_writable(folder.file("locked/a.txt")); }),
                    "no permission to write in folder");
    expect_mentions(message_of([&] { write_file(folder.file("protected.txt"), "new"); }),
                    "write-protected");
  }
  ASSERT_EQ(chmod(folder.file("locked").c_str(), 0755), 0);
  EXPECT_EQ(read_bytes(folder.file("protected.txt")), "old");
}

/// A limit on file sizes fails in the same calls as a full disk, and needs no privileges.
TEST(AtomicFile, FindsWritesThatFail) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.bin");
  write_bytes(path, "old");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{1000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  // Small: fails when the buffer is flushed by commit(). Large: fails in write().
  const std::string small = message_of([&] { write_file(path, std::string(2000, 'x')); });
  const std::string large = message_of([&] { write_file(path, std::string(1 << 20, 'x')); });
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, ignored);
  expect_mentions(small, "largest file size");
  expect_mentions(large, "largest file size");
  EXPECT_EQ(read_bytes(path), "old");
  EXPECT_EQ(folder.names().size(), 1U);
}

TEST(AtomicFile, CheckWritableLeavesNothing) {
  const TemporaryFolder folder;
  check_writable(folder.file("a.txt"));
  EXPECT_TRUE(folder.names().empty());
  EXPECT_THROW(check_writable(folder.file("none/a.txt")), FileError);
}

TEST(ReadFile, ReadsBytesAndNamesTheCause) {
  const TemporaryFolder folder;
  std::string bytes;
  for (int i = 0; i < 200000; ++i) bytes += static_cast<char>(i * 7 % 256);
  write_bytes(folder.file("b.bin"), bytes);
  EXPECT_EQ(read_file(folder.file("b.bin")), bytes);
  expect_mentions(message_of([&] { read_file(folder.file("none")); }), "No such file");
  expect_mentions(message_of([&] { read_file(folder.path()); }), "directory");
}

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

TEST(AtomicFile, ACircleOfLinksIsRefused) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("b", folder.file("a"));
  std::filesystem::create_symlink("a", folder.file("b"));
  EXPECT_NE(refusal([&] { write_file(folder.file("a"), "x"); }).find("circle"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("a")));
  EXPECT_TRUE(std::filesystem::is_symlink(folder.file("b")));
}

// An open file, such as a log that is appended to, is not replaced under its own feet.
TEST(AtomicFile, AnOpenStreamIsNotReplaced) {
  const TemporaryFolder folder;
  write_bytes(folder.file("log"), "kept");
  std::FILE* const log = std::fopen(folder.file("log").c_str(), "ab");
  ASSERT_NE(log, nullptr);
  const std::string name = "/dev/fd/" + std::to_string(fileno(log));
  EXPECT_NE(refusal([&] { write_file(name, "x"); }).find("open already"), std::string::npos);
  std::fclose(log);
  EXPECT_EQ(read_bytes(folder.file("log")), "kept");
}

TEST(ReadFile, APipeWithoutWriterIsNotWaitedFor) {
  const TemporaryFolder folder;
  const std::string pipe = folder.file("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(refusal([&] { read_file(pipe); }).find("nobody writes"), std::string::npos);
  // One with a writer is read, whether what is written comes before or after.
  const int writer = open(pipe.c_str(), O_RDWR);
  ASSERT_GE(writer, 0);
  ASSERT_EQ(write(writer, "text", 4), 4);
  std::string text;
  {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> reader(open_for_reading(pipe),
                                                                 std::fclose);
    char bytes[4];
    ASSERT_EQ(std::fread(bytes, 1, 4, reader.get()), 4U);
    text.assign(bytes, 4);
  }
  EXPECT_EQ(text, "text");
  {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> reader(open_for_reading(pipe),
                                                                 std::fclose);
    ASSERT_EQ(write(writer, "more", 4), 4);
    char bytes[4];
    ASSERT_EQ(std::fread(bytes, 1, 4, reader.get()), 4U);
    EXPECT_EQ(std::string(bytes, 4), "more");
  }
  close(writer);
}

}  // namespace
}  // namespace plenoflame::atomic_file_test
