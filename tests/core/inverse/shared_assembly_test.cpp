// Rays and matrices that several ranks make, against those of one process: the same bits.
#include "plenoflame/inverse/shared_assembly.h"

#include <gtest/gtest.h>

#include <thread>

#include "core/inverse/thread_ranks.h"
#include "plenoflame/base/error.h"

namespace plenoflame::test::shared_assembly_test {
namespace {

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
