#include "plenoflame/inverse/solvers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "core/inverse/dense.h"
#include "plenoflame/base/error.h"
#include "plenoflame/inverse/penalty.h"
#include "support/approx.h"

namespace plenoflame::solvers_test {
namespace {

using namespace test;

/// Enough iterations for any solver to arrive, and no other rule.
SolverOptions to_the_end(int iterations) {
  SolverOptions options;
  options.iterations = iterations;
  options.relative_change = 0;
  return options;
}

/// A solver by name, for consistent data without a penalty.
struct Named {
  const char* name;
  std::function<Solution(const TwinMatrix&, const std::vector<double>&)> solve;
  double tolerance;
};

std::vector<LinearProblem> halves(const std::vector<std::unique_ptr<LinearOperator>>& operators,
                                  const std::vector<std::vector<double>>& data) {
  std::vector<LinearProblem> subsets;
  for (std::size_t k = 0; k < operators.size(); ++k)
    subsets.push_back({operators[k].get(), data[k]});
  return subsets;
}

/// Two interleaved subsets of rows, kept alive while something is solved with them.
Solution with_halves(const TwinMatrix& a, const std::vector<double>& b,
                     const std::function<Solution(std::span<const LinearProblem>)>& solve) {
  std::vector<CsrMatrix<float>> matrices;
  std::vector<std::vector<double>> data(2);
  for (std::size_t k = 0; k < 2; ++k) {
    matrices.push_back(interleaved_rows(a.sparse, k, 2));
    for (std::size_t i = k; i < b.size(); i += 2) data[k].push_back(b[i]);
  }
  std::vector<std::unique_ptr<LinearOperator>> operators;
  for (const auto& matrix : matrices) operators.push_back(make_csr_operator(matrix));
  return solve(halves(operators, data));
}

const std::vector<Named>& solvers() {
  static const std::vector<Named> all{
      {"cgls",
       [](const TwinMatrix& a, const std::vector<double>& b) {
         return solve_cgls({make_csr_operator(a.sparse).get(), b}, {}, to_the_end(200));
       },
       1e-10},
      {"lsqr",
       [](const TwinMatrix& a, const std::vector<double>& b) {
         return solve_lsqr({make_csr_operator(a.sparse).get(), b}, {}, to_the_end(200));
       },
       1e-10},
      {"nnls",
       [](const TwinMatrix& a, const std::vector<double>& b) {
         return solve_nnls({make_csr_operator(a.sparse).get(), b}, {}, to_the_end(20000));
       },
       1e-10},
      {"active_set",
       [](const TwinMatrix& a, const std::vector<double>& b) {
         return solve_nnls_active_set({make_csr_operator(a.sparse).get(), b}, {});
       },
       1e-10},
      {"sirt",
       [](const TwinMatrix& a, const std::vector<double>& b) {
         const auto op = make_csr_operator(a.sparse);
         return solve_sirt(std::vector<LinearProblem>{{op.get(), b}}, 1.9, to_the_end(30000));
       },
       1e-10},
      {"sart",
       [](const TwinMatrix& a, const std::vector<double>& b) {
         return with_halves(a, b, [](std::span<const LinearProblem> subsets) {
           return solve_sirt(subsets, 1, to_the_end(30000));
         });
       },
       1e-10},
      {"mlem",
       [](const TwinMatrix& a, const std::vector<double>& b) {
         const auto op = make_csr_operator(a.sparse);
         return solve_mlem(std::vector<LinearProblem>{{op.get(), b}}, 0, to_the_end(40000));
       },
       1e-8},
      {"osem",
       [](const TwinMatrix& a, const std::vector<double>& b) {
         return with_halves(a, b, [](std::span<const LinearProblem> subsets) {
           return solve_mlem(subsets, 0, to_the_end(40000));
         });
       },
       1e-8},
      {"mart",
       [](const TwinMatrix& a, const std::vector<double>& b) {
         return solve_mart(a.sparse, b, 0, 1, to_the_end(30000));
       },
       1e-8},
  };
  return all;
}

class EverySolver : public testing::TestWithParam<std::size_t> {
 protected:
  const Named& solver() const { return solvers()[GetParam()]; }
};

// By hand: [2 1 0; 1 2 1; 0 1 2] times (1, 2, 3).
TEST_P(EverySolver, SolvesThreeVoxelsByHand) {
  // Subsets of two rows and of one see the voxels with different weights: OSEM then ends in a cycle
  // near the solution, which its authors exclude (subset balance).
  if (std::string(solver().name) == "osem") return;
  Eigen::MatrixXd m(3, 3);
  m << 2, 1, 0, 1, 2, 1, 0, 1, 2;
  const Solution solution = solver().solve(twin_of(m), {4, 8, 8});
  EXPECT_LT(distance(solution.x, dense(std::vector<double>{1, 2, 3})), solver().tolerance);
}

TEST_P(EverySolver, FindsThePositiveSolutionOfConsistentData) {
  const TwinMatrix a = random_matrix(24, 8, 0.6, 21);
  const auto truth = random_vector(8, 0.5, 2, 22);
  const Solution solution = solver().solve(a, plain(a.dense * dense(truth)));
  EXPECT_LT(distance(solution.x, dense(truth)), solver().tolerance);
}

INSTANTIATE_TEST_SUITE_P(Solvers, EverySolver, testing::Range(std::size_t{0}, solvers().size()),
                         [](const auto& index) {
                           return std::string(solvers()[index.param].name);
                         });

/// A regularised, weighted problem with noise and a prior, and its solution by dense algebra.
struct Tikhonov {
  TwinMatrix a = random_matrix(60, 20, 0.4, 31);
  std::vector<double> b = random_vector(60, -1, 5, 32), w = random_vector(60, 0.2, 3, 33),
                      prior = random_vector(20, -1, 1, 34);
  std::unique_ptr<LinearOperator> op = make_csr_operator(a.sparse);
  std::unique_ptr<LinearOperator> penalty = make_penalty({{4, 5, 1}});
  double strength = 0.7;

  LinearProblem problem() const { return {op.get(), b, w}; }
  Regularisation regularisation() const { return {penalty.get(), strength, prior}; }
  Eigen::MatrixXd normal() const {
    const Eigen::MatrixXd wa = dense(w).asDiagonal() * a.dense, l = dense(*penalty);
    return wa.transpose() * wa + strength * l.transpose() * l;
  }
  Eigen::VectorXd right() const {
    const Eigen::MatrixXd wa = dense(w).asDiagonal() * a.dense, l = dense(*penalty);
    return wa.transpose() * dense(w).asDiagonal() * dense(b) +
           strength * l.transpose() * l * dense(prior);
  }
};

TEST(Krylov, SolvesTheRegularisedProblemFromAnyStart) {
  const Tikhonov t;
  const Eigen::VectorXd exact = t.normal().ldlt().solve(t.right());
  SolverOptions options = to_the_end(200);
  for (const auto& start : {std::vector<double>{}, random_vector(20, -9, 9, 35)}) {
    options.start = start;
    EXPECT_LT(distance(solve_cgls(t.problem(), t.regularisation(), options).x, exact), 1e-10);
    EXPECT_LT(distance(solve_lsqr(t.problem(), t.regularisation(), options).x, exact), 1e-10);
  }
}

TEST(Krylov, HistoryTellsMisfitAndPenaltyOfTheSolution) {
  const Tikhonov t;
  for (const auto& solve : {solve_cgls, solve_lsqr}) {
    const Solution s = solve(t.problem(), t.regularisation(), to_the_end(7), {});
    ASSERT_EQ(s.history.size(), 7u);
    EXPECT_EQ(s.reason, StopReason::iterations);
    const double misfit =
        (dense(t.w).asDiagonal() * (t.a.dense * dense(s.x) - dense(t.b))).squaredNorm();
    const double penalty = (dense(*t.penalty) * (dense(s.x) - dense(t.prior))).squaredNorm();
    EXPECT_TRUE(relative(s.history.back().misfit, misfit, 1e-11));
    EXPECT_TRUE(relative(s.history.back().penalty, penalty, 1e-11));
  }
}

/// The conditions of Karush, Kuhn and Tucker for x >= 0: the gradient is 0 where x > 0 and points
/// inwards where x = 0, against the size of what cancels in it.
void expect_optimal(const Tikhonov& t, const std::vector<double>& x, double tolerance) {
  const Eigen::VectorXd gradient = t.normal() * dense(x) - t.right();
  const double scale = t.right().cwiseAbs().maxCoeff();
  int zero = 0;
  for (std::size_t j = 0; j < x.size(); ++j) {
    const double g = gradient[static_cast<Eigen::Index>(j)];
    EXPECT_GE(x[j], 0.0);
    if (x[j] > 0)
      EXPECT_LT(std::abs(g), tolerance * scale) << j;
    else
      EXPECT_GT(g, -tolerance * scale) << j;
    zero += x[j] == 0;
  }
  EXPECT_GT(zero, 0) << "no constraint is active: the case tests nothing";
}

TEST(NonNegative, IsOptimalWithWeightsPenaltyAndPrior) {
  Tikhonov t;
  t.b = random_vector(60, -4, 5, 36);
  t.strength = 0.05;
  expect_optimal(t, solve_nnls(t.problem(), t.regularisation(), to_the_end(20000)).x, 1e-11);
  expect_optimal(t, solve_nnls_active_set(t.problem(), t.regularisation()).x, 1e-11);
}

TEST(NonNegative, FindsASparseSolutionOfConsistentData) {
  const TwinMatrix a = random_matrix(50, 30, 0.3, 41);
  std::vector<double> truth(30, 0.0);
  truth[3] = 1;
  truth[17] = 2.5;
  truth[29] = 0.1;
  const std::vector<double> b = plain(a.dense * dense(truth));
  const auto op = make_csr_operator(a.sparse);
  const Solution exact = solve_nnls_active_set({op.get(), b}, {});
  EXPECT_LT(distance(exact.x, dense(truth)), 1e-12);
  EXPECT_LT(distance(solve_nnls({op.get(), b}, {}, to_the_end(20000)).x, dense(truth)), 1e-9);
}

TEST(StopRules, DiscrepancyStopsWhenTheMisfitIsThatOfTheNoise) {
  const Tikhonov t;
  const auto op = t.op.get();
  SolverOptions options = to_the_end(200);
  const double least = solve_cgls(t.problem(), {}, options).misfit();
  options.misfit = 1.001 * least;
  const Solution s = solve_cgls({op, t.b, t.w}, {}, options);
  EXPECT_EQ(s.reason, StopReason::discrepancy);
  EXPECT_LE(s.misfit(), options.misfit);
  EXPECT_GT(s.history[s.history.size() - 2].misfit, options.misfit);
}

TEST(StopRules, ChangeAndConvergenceAndStop) {
  const Tikhonov t;
  SolverOptions options = to_the_end(500);
  EXPECT_EQ(solve_cgls(t.problem(), t.regularisation(), options).reason, StopReason::converged);
  options.relative_change = 1e-3;
  const Solution changed = solve_nnls(t.problem(), t.regularisation(), options);
  EXPECT_EQ(changed.reason, StopReason::change);
  EXPECT_LE(changed.history.back().change, 1e-3);
  std::stop_source source;
  Execution execution;
  execution.stop = source.get_token();
  options = to_the_end(500);
  options.watch = [&](int iteration, double, std::span<const double>) {
    if (iteration == 5) source.request_stop();
  };
  const Solution stopped = solve_nnls(t.problem(), t.regularisation(), options, execution);
  EXPECT_EQ(stopped.reason, StopReason::stopped);
  EXPECT_EQ(stopped.history.size(), 5u);
}

// Rows of weight 0 hold what is no number, and change nothing.
TEST(Weights, RowsOfWeightZeroAreLeftOut) {
  const TwinMatrix a = random_matrix(24, 6, 0.7, 61);
  const auto truth = random_vector(6, 0.5, 2, 62);
  std::vector<double> b = plain(a.dense * dense(truth)), w(24, 1.0);
  for (const std::size_t row : {0u, 7u, 23u}) {
    b[row] = std::numeric_limits<double>::quiet_NaN();
    w[row] = 0;
  }
  const auto op = make_csr_operator(a.sparse);
  const LinearProblem problem{op.get(), b, w};
  const std::vector<LinearProblem> one{problem};
  const std::vector<Solution> solutions{
      solve_cgls(problem, {}, to_the_end(100)),   solve_lsqr(problem, {}, to_the_end(100)),
      solve_nnls(problem, {}, to_the_end(20000)), solve_nnls_active_set(problem, {}),
      solve_sirt(one, 1.5, to_the_end(20000)),    solve_mlem(one, 0, to_the_end(50000))};
  for (const Solution& s : solutions) EXPECT_LT(distance(s.x, dense(truth)), 1e-7);
}

TEST(Solvers, GoOnFromWhereTheyStopped) {
  const TwinMatrix a = random_matrix(24, 8, 0.6, 71);
  const std::vector<double> b = plain(a.dense * dense(random_vector(8, 0.5, 2, 72)));
  const auto op = make_csr_operator(a.sparse);
  const std::vector<LinearProblem> one{{op.get(), b}};
  SolverOptions first = to_the_end(10), second = to_the_end(15);
  second.start = solve_sirt(one, 1, first).x;
  EXPECT_EQ(solve_sirt(one, 1, second).x, solve_sirt(one, 1, to_the_end(25)).x);
  second.start = solve_mlem(one, 0, first).x;
  EXPECT_EQ(solve_mlem(one, 0, second).x, solve_mlem(one, 0, to_the_end(25)).x);
}

TEST(Solvers, RefuseWhatDoesNotFit) {
  const TwinMatrix a = random_matrix(4, 3, 1, 81);
  const auto op = make_csr_operator(a.sparse);
  const std::vector<double> b(4, 1.0), three(3, 1.0), negative{1, -1, 1, 1},
      unknown{1, std::nan(""), 1, 1};
  const auto penalty = make_penalty({{5, 1, 1}});
  EXPECT_THROW(solve_cgls({op.get(), three}, {}, {}), UsageError);
  EXPECT_THROW(solve_cgls({op.get(), unknown}, {}, {}), InputError);
  EXPECT_THROW(solve_cgls({op.get(), b, three}, {}, {}), UsageError);
  EXPECT_THROW(solve_cgls({op.get(), b, negative}, {}, {}), InputError);
  EXPECT_THROW(solve_cgls({op.get(), b}, {penalty.get(), 1}, {}), UsageError);
  EXPECT_THROW(solve_cgls({op.get(), b}, {nullptr, -1}, {}), UsageError);
  SolverOptions options;
  options.start = b;
  EXPECT_THROW(solve_lsqr({op.get(), b}, {}, options), UsageError);
  const std::vector<LinearProblem> one{{op.get(), negative}};
  EXPECT_THROW(solve_mlem(one, 0, {}), InputError);
  EXPECT_THROW(solve_sirt(one, 2, {}), UsageError);
  EXPECT_THROW(solve_mart(a.sparse, b, 0, 0, {}), UsageError);
}

}  // namespace
}  // namespace plenoflame::solvers_test
