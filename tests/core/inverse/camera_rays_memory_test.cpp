// Rays in little address space. Sanitizers take terabytes of it, so their builds have no such test.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

#include "core/inverse/thread_ranks.h"
#include "plenoflame/base/error.h"

namespace plenoflame::test::camera_rays_memory_test {
namespace {

/// Address space that is left beyond what the process has, while it lives.
class Limit {
 public:
  Limit(double pages, rlim_t bytes) {
    getrlimit(RLIMIT_AS, &before_);
    rlimit tight = before_;
    tight.rlim_cur =
        static_cast<rlim_t>(pages) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + bytes;
    setrlimit(RLIMIT_AS, &tight);
  }
  ~Limit() { setrlimit(RLIMIT_AS, &before_); }
  Limit(const Limit&) = delete;
  Limit& operator=(const Limit&) = delete;

 private:
  rlimit before_{};
};

// Rays that do not fit are drawn again, or refused with their number where they are to be kept. The
// bound by pixels, which is twenty times what they take here, decides nothing by itself.
TEST(CameraRays, RaysThatDoNotFitAreNotKept) {
  double pages = 0;
  Cameras cameras = make_cameras(1, 64);
  const std::vector<CameraView> views = cameras.views();
  const Box box = cameras.unknowns->bounds();
  Execution one;
  one.threads = 1;
  const auto rays =
      static_cast<double>(counted_camera_rays(views, box, cameras.settings, one).ray_count());
  const auto kept = [&](OperatorForm form, double room) {
    std::ifstream("/proc/self/statm") >> pages;
    const Limit limit(pages, static_cast<rlim_t>(room));
    return kept_or_drawn(form, views, box, cameras.settings, one).keep;
  };
  const double bytes = (sizeof(CameraRay) * 2 + 8) * rays;
  EXPECT_FALSE(kept(OperatorForm::automatic, bytes));
  EXPECT_TRUE(kept(OperatorForm::automatic, 4 * bytes));
  EXPECT_TRUE(kept(OperatorForm::rays, 2 * bytes));
  EXPECT_THROW(kept(OperatorForm::rays, 0.7 * bytes), InputError);
  EXPECT_THROW(kept(OperatorForm::matrix, 0.7 * bytes), InputError);
  EXPECT_FALSE(kept(OperatorForm::drawn, 0.7 * bytes));
  std::ifstream("/proc/self/statm") >> pages;
  {
    const Limit limit(pages, static_cast<rlim_t>(bytes));
    const CameraRays drawn =
        rays_of_form(OperatorForm::automatic, views, box, cameras.settings, one);
    EXPECT_TRUE(drawn.source != nullptr);
    EXPECT_EQ(static_cast<double>(drawn.ray_count()), rays);
  }
  EXPECT_TRUE(rays_of_form(OperatorForm::automatic, views, box, cameras.settings, one).source ==
              nullptr);
}

}  // namespace
}  // namespace plenoflame::test::camera_rays_memory_test
#endif
