#include "plenoflame/image/staging_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "plenoflame/base/error.h"
#include "support/temporary_folder.h"

namespace plenoflame {
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

TEST(StagingFolder, FolderThatIsNotThereIsNamed) {
  try {
    const StagingFolder staging("/no/such/folder");
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("'/no/such/folder'"), std::string::npos);
  }
}

}  // namespace
}  // namespace plenoflame
