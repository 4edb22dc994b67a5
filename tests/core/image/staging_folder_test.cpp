#include "plenoflame/image/staging_folder.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "plenoflame/base/error.h"
#include "support/temporary_folder.h"

namespace plenoflame::staging_folder_test {
namespace {

namespace fs = std::filesystem;
using test::read_bytes;
using test::TemporaryFolder;
using test::write_bytes;

std::vector<std::string> sorted_names(const TemporaryFolder& folder) {
  std::vector<std::string> names = folder.names();
  std::sort(names.begin(), names.end());
  return names;
}

TEST(StagingFolder, FilesAppearTogether) {
  const TemporaryFolder folder;
  write_bytes(folder.file("b"), "old");
  write_bytes(folder.file("mine"), "mine");
  fs::create_symlink(folder.file("mine"), folder.file("c"));
  {
    StagingFolder staging(folder.path());
    for (const char* name : {"a", "b", "c"}) write_bytes(staging.path() + "/" + name, name);
    EXPECT_FALSE(fs::exists(folder.file("a")));
    EXPECT_EQ(read_bytes(folder.file("b")), "old");
    staging.commit();
    EXPECT_EQ(read_bytes(folder.file("a")), "a");
    EXPECT_EQ(read_bytes(folder.file("b")), "b");
  }
  EXPECT_TRUE(fs::is_symlink(folder.file("c")));  // followed, as by AtomicFile
  EXPECT_EQ(read_bytes(folder.file("mine")), "c");
  EXPECT_EQ(sorted_names(folder), (std::vector<std::string>{"a", "b", "c", "mine"}));
}

TEST(StagingFolder, WhoMayReadAFileStays) {
  const TemporaryFolder folder;
  write_bytes(folder.file("b"), "old");
  fs::permissions(folder.file("b"), fs::perms::owner_read | fs::perms::owner_write);
  StagingFolder staging(folder.path());
  write_bytes(staging.path() + "/b", "new");
  staging.commit();
  EXPECT_EQ(read_bytes(folder.file("b")), "new");
  EXPECT_EQ(fs::status(folder.file("b")).permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

TEST(StagingFolder, NothingIsLeftWithoutCommit) {
  const TemporaryFolder folder;
  write_bytes(folder.file("b"), "old");
  {
    const StagingFolder first(folder.path()), second(folder.path());
    EXPECT_NE(first.path(), second.path());
    write_bytes(first.path() + "/a", "a");
    write_bytes(first.path() + "/b", "b");
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"b"});
  EXPECT_EQ(read_bytes(folder.file("b")), "old");
}

TEST(StagingFolder, NothingIsMovedWhereOneFileCannotBeReplaced) {
  const TemporaryFolder folder;
  fs::create_directory(folder.file("b"));  // in the way
  {
    StagingFolder staging(folder.path());
    for (const char* name : {"a", "b", "c"}) write_bytes(staging.path() + "/" + name, name);
    EXPECT_THROW(staging.commit(), FileError);
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"b"});
}

/// A folder of a file system in memory, which is mostly another than that of temporary files;
/// that one where there is none, or it cannot be written to.
fs::path parent_elsewhere() {
  return access("/dev/shm", R_OK | W_OK | X_OK) == 0 ? fs::path("/dev/shm")
                                                     : fs::temp_directory_path();
}

// To another file system, too: a link is followed by a copy, wherever it leads.
TEST(StagingFolder, LinksToOtherFoldersAreFollowed) {
  const TemporaryFolder folder, elsewhere(parent_elsewhere());
  const std::string old = elsewhere.file("old"), fresh = elsewhere.file("fresh");
  write_bytes(old, "old");
  fs::permissions(old, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink(old, folder.file("b"));
  fs::create_symlink(fresh, folder.file("c"));
  const std::string large(3000000, 'x');
  {
    StagingFolder staging(folder.path());
    for (const char* name : {"a", "b", "c"}) write_bytes(staging.path() + "/" + name, name + large);
    staging.commit();
  }
  EXPECT_EQ(read_bytes(folder.file("a")), "a" + large);
  EXPECT_TRUE(fs::is_symlink(folder.file("b")) && fs::is_symlink(folder.file("c")));
  EXPECT_EQ(read_bytes(old), "b" + large);
  EXPECT_EQ(read_bytes(fresh), "c" + large);
  EXPECT_EQ(fs::status(old).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(sorted_names(folder), (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(elsewhere.names().size(), 2U);
}

TEST(StagingFolder, NothingIsMovedWhereALinkedFileHasNoRoom) {
  const TemporaryFolder folder, other;
  write_bytes(folder.file("a"), "old a");
  write_bytes(other.file("z"), "old z");
  fs::create_symlink(other.file("z"), folder.file("z"));
  {
    StagingFolder staging(folder.path());
    for (const char* name : {"a", "b"}) write_bytes(staging.path() + "/" + name, name);
    write_bytes(staging.path() + "/z", std::string(100000, 'x'));
    // As on a disk that is full.
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    struct rlimit before {};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const struct rlimit small { 10000, before.rlim_max };
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    EXPECT_THROW(staging.commit(), FileError);
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
  }
  EXPECT_EQ(sorted_names(folder), (std::vector<std::string>{"a", "z"}));
  EXPECT_EQ(read_bytes(folder.file("a")), "old a");
  EXPECT_EQ(other.names(), std::vector<std::string>{"z"});
  EXPECT_EQ(read_bytes(other.file("z")), "old z");
}

TEST(StagingFolder, WhatWasMovedBeforeAFailureIsTakenBack) {
  const TemporaryFolder folder, other;
  for (const char* name : {"a", "z"}) write_bytes(folder.file(name), std::string("old ") + name);
  write_bytes(other.file("c"), "old c");
  fs::create_symlink(other.file("c"), folder.file("c"));
  fs::create_symlink(other.file("d"), folder.file("d"));
  {
    StagingFolder staging(folder.path());
    for (const char* name : {"a", "b", "c", "d"}) write_bytes(staging.path() + "/" + name, "new");
    fs::create_directory(staging.path() + "/z");  // does not go over a file: found out last
    EXPECT_THROW(staging.commit(), FileError);
  }
  EXPECT_EQ(sorted_names(folder), (std::vector<std::string>{"a", "c", "d", "z"}));
  EXPECT_EQ(read_bytes(folder.file("a")), "old a");
  EXPECT_EQ(read_bytes(folder.file("z")), "old z");
  EXPECT_EQ(other.names(), std::vector<std::string>{"c"});
  EXPECT_EQ(read_bytes(other.file("c")), "old c");
}

/// A process that begins to write a set of files into the folder, and gets no further.
class Writer {
 public:
  explicit Writer(const std::string& folder) {
    int ready[2];
    if (pipe(ready) != 0) throw std::runtime_error("no pipe");
    process_ = fork();
    if (process_ == 0) {
      const StagingFolder staging(folder);
      write_bytes(staging.path() + "/b", "half");
      static_cast<void>(write(ready[1], "r", 1));
      for (;;) pause();
    }
    close(ready[1]);
    char byte = 0;
    if (read(ready[0], &byte, 1) != 1) throw std::runtime_error("no other process");
    close(ready[0]);
  }
  ~Writer() { end(); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void end() {
    if (process_ > 0) kill(process_, SIGKILL);
    if (process_ > 0) waitpid(process_, nullptr, 0);
    process_ = 0;
  }

 private:
  pid_t process_ = 0;
};

// SIGKILL leaves no time to clean up.
TEST(StagingFolder, WhatAKilledProcessLeftIsRemovedByTheNext) {
  const TemporaryFolder folder;
  write_bytes(folder.file("b"), "old");
  fs::create_directory(folder.file(".plenoflame.mine.tmp"));  // not of our making
  Writer killed(folder.path()), alive(folder.path());
  EXPECT_EQ(folder.names().size(), 4U);
  killed.end();
  EXPECT_EQ(folder.names().size(), 4U);
  {
    StagingFolder staging(folder.path());
    write_bytes(staging.path() + "/b", "new");
    staging.commit();
  }
  EXPECT_EQ(folder.names().size(), 3U);  // that of the process which lives stays
  alive.end();
  StagingFolder::remove_abandoned(folder.path());
  EXPECT_EQ(sorted_names(folder), (std::vector<std::string>{".plenoflame.mine.tmp", "b"}));
  EXPECT_EQ(read_bytes(folder.file("b")), "new");
  EXPECT_NO_THROW(StagingFolder::remove_abandoned("/no/such/folder"));
}

TEST(StagingFolder, FolderThatIsNotThereIsNamed) {
  try {
    const StagingFolder staging("/no/such/folder");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("'/no/such/folder'"), std::string::npos);
  }
}

// A file that cannot go to its place in one folder leaves the other as it was.
TEST(StagingFolder, SeveralFoldersAreFilledTogether) {
  const TemporaryFolder one, other;
  write_bytes(one.file("a"), "old");
  fs::create_directory(other.file("b"));
  {
    StagingFolder first(one.path()), second(other.path());
    write_bytes(first.path() + "/a", "new");
    write_bytes(second.path() + "/b", "new");
    EXPECT_THROW(StagingFolder::commit({&first, &second}), FileError);
  }
  EXPECT_EQ(read_bytes(one.file("a")), "old");
  EXPECT_EQ(sorted_names(one), std::vector<std::string>{"a"});
  fs::remove(other.file("b"));
  StagingFolder first(one.path()), second(other.path());
  write_bytes(first.path() + "/a", "new");
  write_bytes(second.path() + "/b", "new");
  StagingFolder::commit({&first, &second});
  EXPECT_EQ(read_bytes(one.file("a")), "new");
  EXPECT_EQ(read_bytes(other.file("b")), "new");
}

}  // namespace
}  // namespace plenoflame::staging_folder_test
