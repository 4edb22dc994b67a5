// A matrix that several ranks keep, against that of one process: the same bits.
#include "plenoflame/inverse/shared_assembly.h"

#include <gtest/gtest.h>

#include <functional>
#include <new>
#include <thread>
#include <tuple>
#include <utility>

#include "core/inverse/random_vectors.h"
#include "core/inverse/thread_ranks.h"
#include "plenoflame/base/available_memory.h"
#include "plenoflame/base/error.h"
#include "support/approx.h"

namespace plenoflame::test::shared_assembly_test {
namespace {

EmissionProblem problem_of(const Cameras& cameras, const CameraRays& rays) {
  return {&rays, cameras.unknowns.get(), RowModel::source,
          std::vector<double>(cameras.unknowns->size(), 20)};
}

CameraRays rays_by(SharedAssembly& assembly, const Cameras& cameras,
                   const Execution& execution = {}, OperatorForm form = OperatorForm::automatic) {
  return assembly.rays(cameras.views(), cameras.unknowns->bounds(), form, cameras.settings,
                       execution);
}

Execution threads(int count) {
  Execution execution;
  execution.threads = count;
  return execution;
}

/// Finds the longest message that a rank hands on.
class Counting final : public Communicator {
 public:
  Counting(Post& post, int rank) : own_(post, rank) {}
  int rank() const override { return own_.rank(); }
  int size() const override { return own_.size(); }
  void send(int to, std::string bytes) override {
    most_ = std::max(most_, bytes.size());
    own_.send(to, std::move(bytes));
  }
  std::optional<RankMessage> receive() override { return own_.receive(); }
  std::size_t most() const { return most_; }

 private:
  ThreadRank own_;
  std::size_t most_ = 0;
};

void expect_same_rows(const CameraRays& drawn, const CameraRays& kept) {
  ASSERT_EQ(drawn.rows.size(), kept.rows.size());
  for (std::size_t i = 0; i < kept.rows.size(); ++i) {
    const CameraRays::Row &a = drawn.rows[i], &b = kept.rows[i];
    EXPECT_EQ(std::tie(a.view, a.column, a.row, a.begin),
              std::tie(b.view, b.column, b.row, b.begin));
  }
  EXPECT_EQ(drawn.ray_count(), kept.rays.size());
  EXPECT_EQ(drawn.pixel_ends, kept.pixel_ends);
}

TEST(SharedAssembly, HasTheBitsOfOneProcess) {
  struct Case {
    int bin, cells, samples, ranks;
    OperatorForm form = OperatorForm::automatic;
  };
  for (const auto& [bin, cells, samples, ranks, form] :
       {Case{1, 0, 16, 2}, Case{1, 0, 16, 5}, Case{3, 0, 8, 3}, Case{1, 1, 16, 3},
        Case{2, 0, 8, 3, OperatorForm::drawn}}) {
    Cameras cameras = make_cameras(bin, samples);
    cameras.settings.cells = cells;
    const CameraRays kept =
        draw_camera_rays(cameras.views(), cameras.unknowns->bounds(), cameras.settings);
    const CsrMatrix<float> matrix = make_emission_matrix(problem_of(cameras, kept), {});
    const auto alone = make_csr_operator(matrix);
    Post post(ranks);
    std::vector<std::jthread> others;
    for (int rank = 1; rank < ranks; ++rank)
      others.emplace_back([&, rank] {
        Counting own(post, rank);
        EXPECT_TRUE(serve_assembly(cameras.views(), *cameras.unknowns, own, threads(rank)));
        // Neither rays nor rows travel.
        EXPECT_LT(own.most(), matrix.entries() * sizeof(float));
      });
    ThreadRank first(post, 0);
    SharedAssembly assembly(first);
    const CameraRays rays = rays_by(assembly, cameras, threads(2), form);
    expect_same_rows(rays, kept);
    const EmissionProblem problem = problem_of(cameras, rays);
    EXPECT_EQ(assembly.entries(problem), estimated_entries(problem_of(cameras, kept)));
    const auto shared = assembly.matrix(problem, 1e6, threads(2));
    ASSERT_EQ(shared->rows(), matrix.rows());
    ASSERT_EQ(shared->columns(), matrix.columns());
    const auto x = random_vector(matrix.columns(), 0, 1, 1);
    const auto y = random_vector(matrix.rows(), -1, 1, 2);
    for (int turn = 0; turn < 20; ++turn) {
      ASSERT_EQ(*shared * x, *alone * x);
      ASSERT_EQ(transposed_times(*shared, y), transposed_times(*alone, y));
    }
    EXPECT_EQ(shared->squared_norm(y), alone->squared_norm(y));
    EXPECT_EQ(shared->squared_norm({}), alone->squared_norm({}));
  }
}

TEST(SharedAssembly, AnotherRanksFailureEndsIt) {
  const Cameras cameras = make_cameras(1, 4);
  Post post(2);
  ThreadRank first(post, 0), other(post, 1);
  other.send(0, rank_message::kFailed + std::string("front.toml: cannot be opened"));
  SharedAssembly assembly(first);
  try {
    rays_by(assembly, cameras);
    FAIL() << "nothing is said";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "front.toml: cannot be opened");
  }
}

TEST(SharedAssembly, SharesCellsOutByCameras) {
  Cameras cameras = make_cameras(1, 16);
  cameras.settings.cells = 1;
  std::vector<CameraView> views = cameras.views();
  std::swap(views[0], views[1]);
  const Box box = cameras.unknowns->bounds();
  std::vector<double> rays;
  for (const CameraView& view : views)
    rays.push_back(
        static_cast<double>(draw_camera_rays({view}, box, cameras.settings).ray_count()));
  const double larger = rays[0] / (rays[0] + rays[1]);
  ASSERT_GT(larger, 0.51);  // the middle is in this camera
  for (const int on_node : {1, 2}) {
    Post post(2);
    std::jthread other([&] {
      ThreadRank own(post, 1);
      serve_assembly(views, *cameras.unknowns, own, {});
    });
    ThreadRank first(post, 0, on_node);
    SharedAssembly assembly(first);
    EXPECT_TRUE(assembly.can_share(2, cameras.settings));
    EXPECT_FALSE(assembly.can_share(1, cameras.settings));
    EXPECT_TRUE(assembly.can_share(1, {}));
    assembly.rays(views, box, OperatorForm::automatic, cameras.settings, {});
    const double share = on_node == 1 ? larger : 1;
    EXPECT_TRUE(relative(assembly.memory(1, 0), share, 0.01));
    EXPECT_EQ(assembly.memory(0, 10), 2 * 10 * sizeof(double));
  }
}

TEST(SharedAssembly, OneRankSharesNothing) {
  Post post(1);
  ThreadRank first(post, 0);
  EXPECT_FALSE(SharedAssembly(first).can_share(2, {}));
}

TEST(SharedAssembly, CountsTheMemoryOfAllRanksOfAMachine) {
  const Cameras cameras = make_cameras(1, 4);
  const double bytes = 1.5 * available_memory();
  for (const int on_node : {1, 2}) {
    Post post(2);
    std::jthread other([&] {
      ThreadRank own(post, 1);
      serve_assembly(cameras.views(), *cameras.unknowns, own, {});
    });
    ThreadRank first(post, 0, on_node);
    SharedAssembly assembly(first);
    const CameraRays rays = rays_by(assembly, cameras);
    const EmissionProblem problem = problem_of(cameras, rays);
    assembly.entries(problem);
    if (on_node == 1)
      EXPECT_NO_THROW(assembly.matrix(problem, bytes, {}));
    else
      EXPECT_THROW(assembly.matrix(problem, bytes, {}), InputError);
  }
}

/// Does something before its messages go.
class Meddling final : public Communicator {
 public:
  Meddling(Post& post, int rank, std::function<void(const std::string&)> before)
      : own_(post, rank), before_(std::move(before)) {}
  int rank() const override { return own_.rank(); }
  int size() const override { return own_.size(); }
  void send(int to, std::string bytes) override {
    before_(bytes);
    own_.send(to, std::move(bytes));
  }
  std::optional<RankMessage> receive() override { return own_.receive(); }

 private:
  ThreadRank own_;
  std::function<void(const std::string&)> before_;
};

TEST(SharedAssembly, GoesOnAfterAFailure) {
  const Cameras cameras = make_cameras(1, 4);
  const CameraRays kept =
      draw_camera_rays(cameras.views(), cameras.unknowns->bounds(), cameras.settings);
  const CsrMatrix<float> matrix = make_emission_matrix(problem_of(cameras, kept), {});
  const auto x = random_vector(matrix.columns(), 0, 1, 1);
  const auto y = random_vector(matrix.rows(), -1, 1, 2);
  Post post(3);
  bool fails = false;
  std::vector<std::jthread> others;
  for (int rank = 1; rank < 3; ++rank)
    others.emplace_back([&, rank] {
      Meddling own(post, rank, [&](const std::string&) {
        if (rank == 1 && std::exchange(fails, false)) throw std::bad_alloc();
      });
      serve_assembly(cameras.views(), *cameras.unknowns, own, {});
    });
  ThreadRank first(post, 0);
  SharedAssembly assembly(first);
  std::stop_source stop;
  stop.request_stop();
  Execution stopped;
  stopped.stop = stop.get_token();
  // This rank alone stops; the others' answers come later. Then a rank fails during a product.
  for (int turn = 0; turn < 4; ++turn) {
    const CameraRays rays = rays_by(assembly, cameras);
    const EmissionProblem problem = problem_of(cameras, rays);
    EXPECT_EQ(assembly.entries(problem), estimated_entries(problem_of(cameras, kept)));
    if (turn == 0) {
      EXPECT_THROW(assembly.matrix(problem, 1e6, stopped), Cancelled);
      continue;
    }
    const auto shared = assembly.matrix(problem, 1e6, {});
    fails = turn < 3;
    try {
      if (turn == 1) static_cast<void>(transposed_times(*shared, y));
      EXPECT_EQ(*shared * x, *make_csr_operator(matrix) * x);
      EXPECT_EQ(turn, 3);
    } catch (const Error& error) {
      EXPECT_STREQ(error.what(), "a rank has not enough memory");
    }
  }
}

TEST(SharedAssembly, EndsTheWorkOfOthers) {
  const Cameras cameras = make_cameras(1, 1 << 10);  // some seconds of work
  Post post(2);
  std::stop_source stop;
  Execution execution;
  execution.stop = stop.get_token();
  {
    std::jthread other([&] {
      ThreadRank own(post, 1);
      EXPECT_TRUE(serve_assembly(cameras.views(), *cameras.unknowns, own, threads(1)));
    });
    int messages = 0;
    Meddling first(post, 0, [&](const std::string&) {
      if (++messages == 2) stop.request_stop();  // the rays are asked for
    });
    SharedAssembly assembly(first);
    EXPECT_THROW(rays_by(assembly, cameras, execution, OperatorForm::drawn), Cancelled);
  }
  ThreadRank first(post, 0);
  const auto answer = first.receive();
  ASSERT_TRUE(answer);
  EXPECT_NE(answer->bytes.find("a rank was stopped"), std::string::npos);
}

/// Another rank that never answers. The stop comes when somebody waits for it.
class Silent final : public Communicator {
 public:
  int rank() const override { return 0; }
  int size() const override { return 2; }
  void send(int, std::string) override {}
  std::optional<RankMessage> receive() override {
    source.request_stop();
    return std::nullopt;
  }
  std::stop_source source;
};

TEST(SharedAssembly, StopsWhenAsked) {
  Silent first;
  SharedAssembly assembly(first);
  Execution execution;
  execution.stop = first.source.get_token();
  EXPECT_THROW(rays_by(assembly, make_cameras(1, 4), execution), Cancelled);
}

}  // namespace
}  // namespace plenoflame::test::shared_assembly_test
