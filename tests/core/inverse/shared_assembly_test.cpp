// Rays and matrices that several ranks make, against those of one process: the same bits.
#include "plenoflame/inverse/shared_assembly.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <deque>
#include <fstream>
#include <mutex>
#include <thread>

#include "core/inverse/glowing_grid.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/ranks.h"
#include "support/small_scene.h"

namespace plenoflame::test::shared_assembly_test {
namespace {

/// Mailboxes of ranks that are threads of this process.
struct Post {
  explicit Post(int ranks) : boxes(static_cast<std::size_t>(ranks)) {}
  std::mutex mutex;
  std::vector<std::deque<RankMessage>> boxes;
};

class ThreadRank final : public Communicator {
 public:
  ThreadRank(Post& post, int rank) : post_(post), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return static_cast<int>(post_.boxes.size()); }
  void send(int to, std::string bytes) override {
    const std::lock_guard lock(post_.mutex);
    post_.boxes[static_cast<std::size_t>(to)].push_back({rank_, std::move(bytes)});
  }
  std::optional<RankMessage> receive() override {
    const std::lock_guard lock(post_.mutex);
    auto& own = post_.boxes[static_cast<std::size_t>(rank_)];
    if (own.empty()) return std::nullopt;
    RankMessage first = std::move(own.front());
    own.pop_front();
    return first;
  }

 private:
  Post& post_;
  int rank_;
};

constexpr std::array<int, 3> kCount{5, 6, 7};

struct Cameras {
  CompiledScene scene;
  std::unique_ptr<Unknowns> unknowns;
  CameraRaySettings settings;

  /// The first camera sees a window that is no multiple of a tile, the second one all.
  std::vector<CameraView> views() const { return {{&scene, {3, 5, 85, 70}}, {&scene, {}}}; }
};

Cameras make_cameras(int bin, int samples) {
  const AffineTransform map = scaled(1.5e-3, {1 - 3e-3, -4e-3, -4.5e-3});
  const std::size_t size = 5 * 6 * 7;
  const GlowingGrid g{kCount, map, std::vector<double>(size, 1), std::vector<double>(size, 20)};
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  scene.camera.sensor = {90, 80, 0.064e-3};
  scene.flames = {glowing_flame()};
  scene.channels = {{"430nm", ChannelKind::band, 430e-9, 20e-9}};
  Cameras cameras{compile(scene, glowing_loader(g)), nullptr, {}};
  cameras.unknowns = make_voxel_unknowns({kCount, map, VoxelInterpolation::trilinear});
  cameras.settings.samples = samples;
  cameras.settings.bin = bin;
  return cameras;
}

bool same(const CameraRay& a, const CameraRay& b) {
  return a.origin == b.origin && a.direction == b.direction && a.weight == b.weight &&
         a.end == b.end && a.replicate == b.replicate && a.part == b.part;
}

void expect_same(const CameraRays& a, const CameraRays& b) {
  ASSERT_EQ(a.rows.size(), b.rows.size());
  for (std::size_t i = 0; i < a.rows.size(); ++i) {
    EXPECT_EQ(std::tie(a.rows[i].view, a.rows[i].column, a.rows[i].row, a.rows[i].begin),
              std::tie(b.rows[i].view, b.rows[i].column, b.rows[i].row, b.rows[i].begin));
  }
  ASSERT_EQ(a.rays.size(), b.rays.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.rays.size(); ++i) different += !same(a.rays[i], b.rays[i]);
  EXPECT_EQ(different, 0u);
}

TEST(SharedAssembly, BitsOfOneProcess) {
  // Pieces are beside each other and below each other; blocks of pixels lie across tiles.
  for (const auto& [bin, samples] : {std::pair(1, 64), std::pair(3, 4)}) {
    const Cameras cameras = make_cameras(bin, samples);
    const Box box = cameras.unknowns->bounds();
    const CameraRays alone = draw_camera_rays(cameras.views(), box, cameras.settings);
    const std::vector<double> absorption(cameras.unknowns->size(), 20);
    const auto problem = [&](const CameraRays& rays) {
      return EmissionProblem{&rays, cameras.unknowns.get(), RowModel::source, absorption};
    };
    const CsrMatrix<float> matrix = make_emission_matrix(problem(alone), {});
    ASSERT_GT(alone.rays.size(), bin == 1 ? 1u << 18 : 1u);  // pieces of rows
    constexpr int kRanks = 3;
    Post post(kRanks);
    std::vector<std::jthread> others;
    for (int rank = 1; rank < kRanks; ++rank)
      others.emplace_back([&, rank] {
        ThreadRank own(post, rank);
        Execution execution;
        execution.threads = rank;
        EXPECT_TRUE(serve_assembly(cameras.views(), *cameras.unknowns, own, execution));
      });
    ThreadRank first(post, 0);
    SharedAssembly assembly(first);
    const CameraRays rays = assembly.rays(cameras.views(), box, cameras.settings, {});
    expect_same(rays, alone);
    const CsrMatrix<float> shared = assembly.matrix(problem(rays), {});
    EXPECT_TRUE(std::ranges::equal(shared.row_starts(), matrix.row_starts()));
    EXPECT_TRUE(std::ranges::equal(shared.column_indices(), matrix.column_indices()));
    EXPECT_TRUE(std::ranges::equal(shared.values(), matrix.values()));
  }
}
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

// Rays that do not fit are drawn again, by ranks as by one process, or refused with their number
// where they are to be kept. The bound by pixels, which is twenty times what they take here,
// decides nothing by itself.
TEST(SharedAssembly, RaysThatDoNotFitAreNotKept) {
  double pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  if (pages > 1e7) GTEST_SKIP() << "a sanitizer takes terabytes of address space";
  Cameras cameras = make_cameras(1, 64);
  const std::vector<CameraView> views = cameras.views();
  const Box box = cameras.unknowns->bounds();
  Execution one;
  one.threads = 1;
  const auto rays =
      static_cast<double>(counted_camera_rays(views, box, cameras.settings, one).ray_count());
  Post post(1);
  ThreadRank first(post, 0);
  SharedAssembly assembly(first);
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
    const CameraRays shared =
        rays_by(&assembly, OperatorForm::automatic, views, box, cameras.settings, one);
    EXPECT_TRUE(shared.source != nullptr);
    EXPECT_EQ(static_cast<double>(shared.ray_count()), rays);
  }
  EXPECT_TRUE(
      rays_by(&assembly, OperatorForm::automatic, views, box, cameras.settings, one).source ==
      nullptr);
}

TEST(SharedAssembly, OthersDoSomeOfIt) {
  const Cameras cameras = make_cameras(1, 4);
  Post post(2);
  int answers = 0;
  std::jthread other([&] {
    // Counts what it hands on to rank 0.
    class Counting final : public Communicator {
     public:
      Counting(ThreadRank& own, int& count) : own_(own), count_(count) {}
      int rank() const override { return own_.rank(); }
      int size() const override { return own_.size(); }
      void send(int to, std::string bytes) override {
        ++count_;
        own_.send(to, std::move(bytes));
      }
      std::optional<RankMessage> receive() override { return own_.receive(); }

     private:
      ThreadRank& own_;
      int& count_;
    };
    ThreadRank own(post, 1);
    Counting counting(own, answers);
    serve_assembly(cameras.views(), *cameras.unknowns, counting, {});
  });
  ThreadRank first(post, 0);
  {
    SharedAssembly assembly(first);
    for (int i = 0; i < 10; ++i)
      assembly.rays(cameras.views(), cameras.unknowns->bounds(), cameras.settings, {});
  }
  other.join();
  EXPECT_GT(answers, 1);  // more than that it is there
}

TEST(SharedAssembly, AnotherRanksFailureEndsIt) {
  const Cameras cameras = make_cameras(1, 4);
  Post post(2);
  ThreadRank first(post, 0), other(post, 1);
  other.send(0, rank_message::kFailed + std::string("front.toml: cannot be opened"));
  SharedAssembly assembly(first);
  // It is said when rank 0 next looks at its messages.
  const auto all = [&] {
    for (int i = 0; i < 10; ++i)
      assembly.rays(cameras.views(), cameras.unknowns->bounds(), cameras.settings, {});
  };
  try {
    all();
    FAIL() << "nothing is said";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "front.toml: cannot be opened");
  }
}

TEST(SharedAssembly, StopsWhenAsked) {
  const Cameras cameras = make_cameras(1, 4);
  Post post(2);
  ThreadRank first(post, 0);
  SharedAssembly assembly(first);
  std::stop_source source;
  source.request_stop();
  Execution execution;
  execution.stop = source.get_token();
  EXPECT_THROW(
      assembly.rays(cameras.views(), cameras.unknowns->bounds(), cameras.settings, execution),
      Cancelled);
}

}  // namespace
}  // namespace plenoflame::test::shared_assembly_test
