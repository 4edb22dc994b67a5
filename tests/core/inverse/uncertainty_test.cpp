#include "plenoflame/inverse/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/inverse/dense.h"
#include "plenoflame/base/error.h"
#include "plenoflame/inverse/gauss_newton.h"
#include "plenoflame/inverse/penalty.h"
#include "plenoflame/inverse/strength.h"
#include "support/approx.h"

namespace plenoflame::uncertainty_test {
namespace {

using namespace test;

/// Chords of a smooth profile of 30 samples, blurred: ill conditioned, with noise of known size.
struct Profile {
  static constexpr int kSamples = 30, kRows = 90;
  double sigma = 0.05;
  TwinMatrix a = twin_of(matrix());
  std::vector<double> truth, b, w;
  std::unique_ptr<LinearOperator> op = make_csr_operator(a.sparse);
  std::unique_ptr<LinearOperator> penalty = make_penalty({{kSamples, 1, 1}});

  explicit Profile(unsigned seed = 1) {
    for (int j = 0; j < kSamples; ++j) truth.push_back(2 + std::sin(0.25 * j));
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, sigma);
    b = plain(a.dense * dense(truth));
    for (double& value : b) value += noise(random);
    w.assign(kRows, 1 / sigma);
  }
  static Eigen::MatrixXd matrix() {
    Eigen::MatrixXd m(kRows, kSamples);
    for (int i = 0; i < kRows; ++i)
      for (int j = 0; j < kSamples; ++j) {
        const double d = i / 3.0 - j;
        m(i, j) = static_cast<float>(std::exp(-d * d / 8) / 5);
      }
    return m;
  }
  /// The ratio of traces, which any number would do for.
  double unit() const { return op->squared_norm(w) / penalty->squared_norm({}); }
  LinearProblem problem() const { return {op.get(), b, w}; }
  StrengthChoice choice(const StrengthRange& range) const {
    SolverOptions options;
    options.relative_change = 1e-10;
    return choose_strength(problem(), {penalty.get()}, unit(), range, options);
  }
  Eigen::VectorXd exact(double strength) const {
    const Eigen::MatrixXd wa = a.dense / sigma, l = dense(*penalty);
    return (wa.transpose() * wa + strength * l.transpose() * l)
        .ldlt()
        .solve(wa.transpose() * dense(b) / sigma);
  }
};

// The least of cross-validation's function, worked out densely on the same strengths.
TEST(Strength, IsTheLeastOfCrossValidation) {
  const Profile p;
  StrengthRange range;
  range.probes = 400;
  range.iterations = 3000;
  const StrengthChoice choice = p.choice(range);
  const double unit = p.unit();
  const Eigen::MatrixXd wa = p.a.dense / p.sigma, l = dense(*p.penalty);
  double least = 1e300, best = 0;
  for (const StrengthPoint& point : choice.curve) {
    const Eigen::MatrixXd normal = wa.transpose() * wa + point.strength * unit * l.transpose() * l;
    const double trace = normal.ldlt().solve(wa.transpose() * wa).trace();
    const Eigen::VectorXd x = p.exact(point.strength * unit);
    const double misfit = (wa * x - dense(p.b) / p.sigma).squaredNorm();
    const double gcv = misfit / std::pow(Profile::kRows - trace, 2);
    EXPECT_TRUE(relative(point.gcv, gcv, 0.03)) << point.strength;
    EXPECT_TRUE(relative(point.penalty, (l * x).squaredNorm(), 0.01)) << point.strength;
    if (gcv < least) least = gcv, best = point.strength;
  }
  EXPECT_EQ(choice.strength, best);
  EXPECT_FALSE(choice.at_end);
  EXPECT_LT(distance(choice.solution.x, p.exact(choice.strength * unit)), 1e-6);
}

// The search goes on between the steps of the range, and does not follow strengths that are ever
// worse: with next to no penalty noise makes the error that is expected several times larger.
TEST(Strength, GoesOnAboutTheBestOnly) {
  const Profile p;
  StrengthRange range;
  range.lowest = 1e-12;
  range.points = 17;
  const StrengthChoice choice = p.choice(range);
  const double step = std::pow(range.highest / range.lowest, 1.0 / (range.points - 1));
  EXPECT_GT(choice.curve.front().strength, 1e3 * range.lowest);
  for (std::size_t k = 1; k + 1 < choice.curve.size(); ++k) {
    if (choice.curve[k].strength != choice.strength) continue;
    EXPECT_LT(choice.curve[k + 1].strength, std::pow(step, 0.51) * choice.strength);
    EXPECT_GT(choice.curve[k - 1].strength, std::pow(step, -0.51) * choice.strength);
  }
  range.highest = 1e-6 * choice.strength;
  EXPECT_TRUE(p.choice(range).at_end);
}

// A profile with a gap that is negative, with bounds: the conditions of Karush, Kuhn and Tucker
// hold, and the unknowns at their bound follow no data.
TEST(Strength, OfABoundedProfile) {
  Profile p;
  for (std::size_t i = 0; i < p.b.size(); ++i)
    if (i > p.b.size() / 2) p.b[i] = -0.3 * p.b[i];
  StrengthRange range;
  range.probes = 400;
  range.iterations = 20000;
  range.bounded = true;
  const StrengthChoice choice = p.choice(range);
  const Eigen::VectorXd x = dense(choice.solution.x);
  std::vector<int> free;
  for (int j = 0; j < Profile::kSamples; ++j)
    if (x[j] > 0) free.push_back(j);
  ASSERT_LT(free.size(), 25U);
  const double strength = choice.strength * p.unit();
  const Eigen::MatrixXd wa = p.a.dense / p.sigma, l = dense(*p.penalty);
  const Eigen::MatrixXd normal = wa.transpose() * wa + strength * l.transpose() * l;
  const Eigen::VectorXd data = wa.transpose() * dense(p.b) / p.sigma;
  const Eigen::VectorXd gradient = normal * x - data;
  for (int j = 0; j < Profile::kSamples; ++j)
    EXPECT_GT(gradient[j], -1e-4 * data.norm())
        << j << (x[j] > 0 ? " is free" : " is at its bound");
  EXPECT_LT(gradient(free).norm(), 1e-4 * data.norm());
  const Eigen::MatrixXd of_free = wa(Eigen::all, free);
  const double trace =
      Eigen::MatrixXd(normal(free, free)).ldlt().solve(of_free.transpose() * of_free).trace();
  const double gcv =
      (wa * x - dense(p.b) / p.sigma).squaredNorm() / std::pow(Profile::kRows - trace, 2);
  const auto chosen = std::ranges::find(choice.curve, choice.strength, &StrengthPoint::strength);
  EXPECT_TRUE(relative(chosen->gcv, gcv, 0.03));
}

// A pyramid that falls to half within two samples along one axis and one along the other; at the
// rim its width is not known.
TEST(Uncertainty, HalfWidthsOfAPyramid) {
  std::vector<double> values;
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 7; ++j)
      values.push_back(8 * std::max(0.0, 1 - std::abs(i - 4) / 3.0 - std::abs(j - 3) / 2.0));
  const auto widths = half_widths(values, {9, 7, 1}, {0.5, 3, 1}, 4 * 7 + 3);
  EXPECT_TRUE(relative(widths[0], 3 * 0.5, 1e-12));
  EXPECT_TRUE(relative(widths[1], 2 * 3, 1e-12));
  EXPECT_EQ(widths[2], 0);
  const std::vector<double> flat(5, 1.0);
  EXPECT_TRUE(std::isinf(half_widths(flat, {5, 1, 1}, {1, 1, 1}, 2)[0]));
}

TEST(Uncertainty, ProbesAndDrawsAgreeWithDenseAlgebra) {
  const Profile p;
  const double strength = 20;
  const Eigen::MatrixXd wa = p.a.dense / p.sigma, l = dense(*p.penalty);
  const Eigen::MatrixXd covariance = (wa.transpose() * wa + strength * l.transpose() * l).inverse();
  const Eigen::MatrixXd resolution = covariance * wa.transpose() * wa;
  const Regularisation regularisation{p.penalty.get(), strength};
  const Uncertainty exact = exact_uncertainty(p.problem(), regularisation);
  constexpr int kProbes = 2000;
  const Uncertainty probed = estimate_resolution(p.problem(), regularisation, {kProbes, 7});
  EXPECT_TRUE(relative(exact.resolved_unknowns, resolution.trace(), 1e-9));
  std::vector<double> squares(Profile::kSamples);
  draw_posterior(p.problem(), regularisation, {kProbes, 3}, [&](std::span<const double> x) {
    for (std::size_t j = 0; j < x.size(); ++j) squares[j] += x[j] * x[j] / kProbes;
  });
  for (Eigen::Index j = 0; j < Profile::kSamples; ++j) {
    const auto at = static_cast<std::size_t>(j);
    EXPECT_TRUE(relative(exact.resolved[at], resolution(j, j), 1e-8));
    EXPECT_TRUE(relative(exact.deviation[at], std::sqrt(covariance(j, j)), 1e-8));
    // Standard errors of the probes: off-diagonal entries make that of the resolution, the square
    // of a normal number has a relative variance of 2.
    const double spread =
        std::sqrt((resolution.row(j).squaredNorm() - std::pow(resolution(j, j), 2)) / kProbes);
    EXPECT_TRUE(within_standard_errors(probed.resolved[at], resolution(j, j), spread, 5)) << j;
    EXPECT_TRUE(within_standard_errors(squares[at], covariance(j, j),
                                       covariance(j, j) * std::sqrt(2.0 / kProbes), 5))
        << j;
  }
  const std::vector<double> spread = point_spread(p.problem(), regularisation, 12);
  EXPECT_LT(distance(spread, resolution.col(12)), 1e-6);
}

// Flames of the prior, with noise: what the deviations say of the errors is true, smoothing
// included. The scatter of noise alone is a good half of it. 5 standard errors of a variance.
TEST(Uncertainty, DeviationsAreTheErrorsOfFlamesOfThePrior) {
  Profile p;
  p.penalty = make_penalty({{Profile::kSamples, 1, 1}, {1, 1, 1}, {1, 1, 1}, {}, true});
  const double strength = 2000;
  const Eigen::MatrixXd wa = p.a.dense / p.sigma, l = dense(*p.penalty);
  const Regularisation regularisation{p.penalty.get(), strength};
  const Uncertainty exact = exact_uncertainty(p.problem(), regularisation);
  const Eigen::MatrixXd root =
      (strength * l.transpose() * l)
          .llt()
          .matrixU()
          .solve(Eigen::MatrixXd::Identity(Profile::kSamples, Profile::kSamples));
  std::mt19937 random(17);
  std::normal_distribution<double> normal(0, 1);
  const auto noise = [&](Eigen::Index n) {
    return Eigen::VectorXd(Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); }));
  };
  constexpr int kRuns = 2000;
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(Profile::kSamples), of_noise = squares;
  for (int run = 0; run < kRuns; ++run) {
    const Eigen::VectorXd truth = root * noise(Profile::kSamples),
                          e = p.sigma * noise(Profile::kRows);
    p.b = plain(p.a.dense * truth + e);
    squares += (p.exact(strength) - truth).array().square().matrix() / kRuns;
    p.b = plain(e);
    of_noise += p.exact(strength).array().square().matrix() / kRuns;
  }
  for (Eigen::Index j = 0; j < Profile::kSamples; ++j) {
    const double variance = std::pow(exact.deviation[static_cast<std::size_t>(j)], 2);
    EXPECT_TRUE(within_standard_errors(squares[j], variance, variance * std::sqrt(2.0 / kRuns), 5))
        << j;
  }
  EXPECT_LT(of_noise.sum(), 0.7 * squares.sum());
}

// b = exp(-A x) with bounds: the optimum satisfies Karush, Kuhn and Tucker's conditions, and
// consistent data give the truth.
class Exponential : public testing::Test {
 protected:
  TwinMatrix a_ = random_matrix(30, 6, 0.6, 5);
  std::vector<double> truth_ = random_vector(6, 0.1, 0.6, 6), w_ = random_vector(30, 5, 9, 7), b_;

  class Scaled final : public LinearOperator {
   public:
    explicit Scaled(Eigen::MatrixXd m) : m_(std::move(m)) {}
    std::size_t rows() const override { return static_cast<std::size_t>(m_.rows()); }
    std::size_t columns() const override { return static_cast<std::size_t>(m_.cols()); }
    void apply(std::span<const double> x, std::span<double> y) const override {
      const Eigen::VectorXd product = m_ * Eigen::Map<const Eigen::VectorXd>(x.data(), m_.cols());
      std::copy(product.data(), product.data() + product.size(), y.begin());
    }
    void apply_transpose(std::span<const double> y, std::span<double> x) const override {
      const Eigen::VectorXd product =
          m_.transpose() * Eigen::Map<const Eigen::VectorXd>(y.data(), m_.rows());
      std::copy(product.data(), product.data() + product.size(), x.begin());
    }

   private:
    Eigen::MatrixXd m_;
  };

  Eigen::VectorXd model(std::span<const double> x) const {
    return (-a_.dense * Eigen::Map<const Eigen::VectorXd>(x.data(), 6)).array().exp();
  }
  NonlinearProblem problem() const {
    NonlinearProblem p;
    p.model = [this](std::span<const double> x) { return plain(model(x)); };
    p.derivative = [this](std::span<const double> x) -> std::unique_ptr<LinearOperator> {
      return std::make_unique<Scaled>(-(model(x).asDiagonal() * a_.dense));
    };
    p.b = b_;
    p.weights = w_;
    return p;
  }
  SolverOptions options() const {
    SolverOptions o;
    o.iterations = 200;
    o.relative_change = 0;
    o.start = std::vector<double>(6, 0.0);
    return o;
  }
};

TEST_F(Exponential, ConsistentDataGiveTheTruth) {
  b_ = plain(model(truth_));
  const Solution s = solve_gauss_newton(problem(), {}, options());
  EXPECT_LT(distance(s.x, dense(truth_)), 1e-9);
  EXPECT_LT(s.history.size(), 30u);
}

TEST_F(Exponential, BoundsAndPenaltyGiveAnOptimum) {
  b_ = plain(model(truth_));
  const auto noise = random_vector(30, -0.1, 0.1, 8);
  for (std::size_t i = 0; i < b_.size(); ++i) b_[i] += noise[i];
  NonlinearProblem p = problem();
  p.lower.assign(6, 0.3);
  p.upper.assign(6, 0.45);
  const auto penalty = make_penalty({{6, 1, 1}});
  const Regularisation regularisation{penalty.get(), 0.5};
  const Solution s = solve_gauss_newton(p, regularisation, options());
  const Eigen::VectorXd x = dense(s.x), m = model(s.x);
  const Eigen::MatrixXd j = -(m.asDiagonal() * a_.dense), l = dense(*penalty);
  const Eigen::VectorXd w2 = dense(w_).array().square();
  const Eigen::VectorXd uphill =
      j.transpose() * w2.asDiagonal() * (m - dense(b_)) + 0.5 * l.transpose() * l * x;
  const double scale = (j.transpose() * w2.asDiagonal() * dense(b_)).cwiseAbs().maxCoeff();
  int held = 0;
  for (std::size_t k = 0; k < 6; ++k) {
    const double g = uphill[static_cast<Eigen::Index>(k)];
    if (s.x[k] == 0.3)
      EXPECT_GT(g, 0.0) << k;
    else if (s.x[k] == 0.45)
      EXPECT_LT(g, 0.0) << k;
    else
      EXPECT_LT(std::abs(g), 1e-6 * scale) << k;
    held += s.x[k] == 0.3 || s.x[k] == 0.45;
  }
  EXPECT_GT(held, 0);
  EXPECT_LT(held, 6);
}

TEST(Refusals, NameWhatIsMissing) {
  const Profile p;
  StrengthRange range;
  range.lowest = 0;
  EXPECT_THROW(p.choice(range), UsageError);
  EXPECT_THROW(estimate_resolution(p.problem(), {}, {0, 1}), UsageError);
  EXPECT_THROW(draw_posterior(p.problem(), {}, {0, 1}, [](std::span<const double>) {}), UsageError);
  EXPECT_THROW(point_spread(p.problem(), {}, 30), UsageError);
  EXPECT_THROW(solve_gauss_newton({}, {}, {}), UsageError);
}

}  // namespace
}  // namespace plenoflame::uncertainty_test
