// A grid in little address space. Sanitizers take terabytes of it, so their builds have no such
// test.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#include <openvdb/openvdb.h>
#include <sys/resource.h>

#include "plenoflame/base/error.h"
#include "plenoflame/volumes/grid_file.h"
#include "volumes/support.h"

namespace plenoflame::test::grid_memory_test {
namespace {

// 635 million voxels are within the limit, but not within a limit of address space.
TEST(GridFile, AGridThatMemoryCannotHoldIsRefused) {
  const TemporaryFolder folder;
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(0);
  grid->setName("absorption");
  for (int i = 0; i < 303; ++i)
    grid->tree().addTile(2, {128 * (i % 16), 128 * (i / 16), 0}, 5.0f, true);
  const std::string path = folder.file("a.vdb");
  openvdb::io::File(path).write({grid});
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  rlimit tight = before;
  tight.rlim_cur = rlim_t{6} << 30;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &tight), 0);
  const std::string message = message_of<InputError>([&] { read_voxel_field(path, "absorption"); });
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  EXPECT_TRUE(contains(message, "its 635 million voxels would take some 7.6 GB of memory, and"))
      << message;
}

}  // namespace
}  // namespace plenoflame::test::grid_memory_test
#endif
