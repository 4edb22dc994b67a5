#include "inverse/model_test.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "inverse/displaced_camera.h"
#include "inverse/expected_misfit.h"
#include "inverse/followed_change.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"

namespace plenoflame {
namespace {

/// Score tests of one problem, after Rao (1948).
class ScoreTests {
 public:
  ScoreTests(const TestedModel& model, const Reconstruction& found, const ProbeAccuracy& accuracy,
             const Execution& execution)
      : model_(model),
        found_(found),
        accuracy_(accuracy),
        execution_(execution),
        factor_(deviation_factor(std::pow(found.noise_factor, 2),
                                 static_cast<double>(found.rows - found.left_out),
                                 static_cast<double>(found.values.size()))) {}

  /// @param change of the rows of its camera for a quantity that is larger by 1
  void add_of_camera(SuspectKind kind, std::size_t view, std::vector<double> change) {
    for (std::size_t i = 0; i < change.size(); ++i)
      if (static_cast<std::size_t>(model_.emission->rays->rows[i].view) != view) change[i] = 0;
    add(kind, view, std::move(change));
  }
  /// @param change of all rows
  void add(SuspectKind kind, std::size_t view, std::vector<double> change) {
    for (const Suspect& refined : model_.refined)
      if (refined.is_same({kind, view})) {
        std::vector<double> by_deviation = change;
        for (double& value : by_deviation) value *= refined.deviation;
        model_.keep(by_deviation);
      }
    const double own = product(change, change);
    std::vector<double> left = left_of(change);
    const double information = product(left, change);
    // A change that the flame follows almost entirely is not tested.
    if (!(information > kLeastLeft * own)) return;
    Suspect suspect{kind, view};
    suspect.estimate = product(left, model_.residual) / information;
    suspect.deviation = factor_ / std::sqrt(information);
    suspects_.push_back(suspect);
    effects_.push_back(std::sqrt(own / light_of(change)));
    changes_.push_back(std::move(change));
    left_.push_back(std::move(left));
  }

  /// @param change of all rows by a finer grid. A camera is not blamed for its share.
  void set_grid(std::vector<double> change) {
    std::vector<double> left = left_of(change);
    if (!(product(left, change) > kLeastLeft * product(change, change))) return;
    changes_.push_back(std::move(change));
    left_.push_back(std::move(left));
  }

  /// Names those that were corrected, then the most significant one, and then the most significant
  /// of what it leaves. The grid comes before all of them.
  TestOfModel take() {
    TestOfModel result;
    const auto count = static_cast<Eigen::Index>(changes_.size());
    Eigen::MatrixXd information(count, count);
    Eigen::VectorXd score(count);
    for (Eigen::Index j = 0; j < count; ++j) {
      score[j] = product(left_[static_cast<std::size_t>(j)], model_.residual);
      for (Eigen::Index k = 0; k < count; ++k)
        information(j, k) =
            product(left_[static_cast<std::size_t>(j)], changes_[static_cast<std::size_t>(k)]);
    }
    std::vector<Eigen::Index> named;
    const auto grid = static_cast<Eigen::Index>(suspects_.size());
    if (grid < count) named.push_back(grid);
    for (const Suspect& known : model_.corrected)
      for (Eigen::Index j = 0; j < grid; ++j)
        if (suspects_[static_cast<std::size_t>(j)].is_same(known)) named.push_back(j);
    for (int n = 0; n < kMostNamed; ++n) {
      const Eigen::Index next = most_significant(information, score, named);
      if (next < 0) break;
      named.push_back(next);
    }
    const Eigen::MatrixXd covariance = Eigen::MatrixXd(information(named, named)).inverse();
    const Eigen::VectorXd estimates = covariance * Eigen::VectorXd(score(named));
    for (Eigen::Index n = 0; n < estimates.size(); ++n) {
      const Eigen::Index j = named[static_cast<std::size_t>(n)];
      if (j == grid) {
        const double explained = std::pow(std::max(0.0, estimates[n]), 2) * information(j, j);
        if (const double misfit = beyond_noise(); misfit > 0)
          result.grid_share = std::min(1.0, explained / misfit);
        continue;
      }
      Suspect& suspect = suspects_[static_cast<std::size_t>(j)];
      suspect.named = true;
      suspect.estimate = estimates[n];
      suspect.deviation = factor_ * std::sqrt(covariance(n, n));
    }
    std::ranges::stable_sort(suspects_, [](const Suspect& a, const Suspect& b) {
      return a.named != b.named ? a.named : a.significance() > b.significance();
    });
    result.suspects = std::move(suspects_);
    return result;
  }

 private:
  static constexpr double kLeastLeft = 1e-4;
  static constexpr int kMostNamed = 3;
  /// Standard deviations. Grids and pictures leave more than noise, so that 4 were false alarms.
  static constexpr double kSignificant = 6;
  /// Share of the misfit beyond noise. Less of it may be explained by chance: the grid's misfit is
  /// shared by many pixels and is no noise.
  static constexpr double kLeastExplained = 0.1;
  /// Standard deviations that the grid's misfit does not reach by chance.
  static constexpr double kSure = 20;

  /// A camera that stands nearer looks much like one that is focused farther: that is named unless
  /// the place explains more by this factor.
  static constexpr double kForward = 0.8;
  /// Relative change of the pictures. A grid, and rays that are finite in number, look like smaller
  /// faults of a camera.
  static constexpr double kLeastChange = 0.01;

  /// Factor on the strength with which the flame follows a change. With the full strength, the part
  /// of the flame that smoothing removes looks like a displaced camera.
  static constexpr double kFreer = 0.01;

  /// The light of the rows that change.
  double light_of(std::span<const double> change) const {
    const std::span<const double> weights = model_.problem->weights();
    double sum = 0;
    for (std::size_t i = 0; i < change.size(); ++i)
      if (change[i] != 0) sum += std::pow(weights[i] * model_.light[i], 2);
    return sum;
  }

  double product(std::span<const double> a, std::span<const double> b) const {
    const std::span<const double> weights = model_.problem->weights();
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += weights[i] * weights[i] * a[i] * b[i];
    return sum;
  }

  /// The misfit that noise does not explain.
  double beyond_noise() const {
    return product(model_.residual, model_.residual) * (1 - 1 / std::pow(found_.noise_factor, 2));
  }

  /// The most significant of those that explain what the named ones leave; -1: there is none.
  Eigen::Index most_significant(const Eigen::MatrixXd& information, const Eigen::VectorXd& score,
                                const std::vector<Eigen::Index>& named) const {
    Eigen::Index best = -1;
    double most = kSignificant;
    const double misfit = beyond_noise();
    for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(suspects_.size()); ++j) {
      if (std::ranges::find(named, j) != named.end()) continue;
      double left = score[j], known = information(j, j);
      if (!named.empty()) {
        const Eigen::MatrixXd among = information(named, named);
        const Eigen::VectorXd with = information(named, std::vector<Eigen::Index>{j});
        const Eigen::VectorXd share = among.ldlt().solve(with);
        left -= share.dot(Eigen::VectorXd(score(named)));
        known -= share.dot(with);
      }
      if (!(known > kLeastLeft * information(j, j))) continue;
      const bool sure = std::fabs(left) > kSure * factor_ * std::sqrt(known);
      if (!sure && left * left / known < kLeastExplained * misfit) continue;
      const double change = effects_[static_cast<std::size_t>(j)] * std::fabs(left) / known;
      if (!(change > kLeastChange)) continue;
      double significance = std::fabs(left) / (factor_ * std::sqrt(known));
      if (suspects_[static_cast<std::size_t>(j)].kind == SuspectKind::forward)
        significance *= kForward;
      if (significance > most) most = significance, best = j;
    }
    return best;
  }

  /// The part of a change that the flame cannot follow.
  std::vector<double> left_of(const std::vector<double>& change) const {
    const LinearProblem linear = model_.problem->problem(change);
    const Regularisation penalty = model_.problem->regularisation(kFreer * found_.strength);
    std::vector<double> left =
        *linear.a * follow_change(linear, penalty, change, accuracy_, execution_);
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = change[i] - left[i];
    return left;
  }

  const TestedModel& model_;
  const Reconstruction& found_;
  ProbeAccuracy accuracy_;
  const Execution& execution_;
  double factor_;  ///< of deviations: the misfit beyond noise is an error of the grid
  std::vector<Suspect> suspects_;
  std::vector<double> effects_;  // relative changes of the pictures, for quantities larger by 1
  std::vector<std::vector<double>> changes_, left_;  // of the suspects, then of the grid
};

/// Change of the rows of a view for a quantity of its camera that is larger by 1. It is the
/// difference of two cameras whose rays have the same points of the sampler.
std::vector<double> change_of_rows(const TestedModel& model, std::size_t view, SuspectKind kind,
                                   double step, std::span<const double> x,
                                   const Execution& execution) {
  const CompiledScene moved = displaced_scene(*(*model.views)[view].scene, kind, step);
  CameraView other = (*model.views)[view];
  other.scene = &moved;
  const CameraRays rays =
      draw_camera_rays({other}, model.emission->unknowns->bounds(), model.rays, execution);
  EmissionProblem emission = *model.emission;
  emission.rays = &rays;
  const std::vector<double> light = *make_emission_operator(emission, execution) * x;
  std::map<std::pair<int, int>, double> by_pixel;
  for (std::size_t i = 0; i < rays.rows.size(); ++i)
    by_pixel[{rays.rows[i].column, rays.rows[i].row}] = light[i];
  const std::vector<CameraRays::Row>& rows = model.emission->rays->rows;
  std::vector<double> change(rows.size(), 0.0);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (static_cast<std::size_t>(rows[i].view) != view) continue;
    const auto found = by_pixel.find({rows[i].column, rows[i].row});
    change[i] = ((found == by_pixel.end() ? 0 : found->second) - model.light[i]) / step;
  }
  return change;
}

/// Change of all rows if the flame is as smooth as its values between them.
std::vector<double> change_by_finer_grid(const TestedModel& model, const Reconstruction& found,
                                         const Execution& execution) {
  const Unknowns& unknowns = *model.emission->unknowns;
  const std::unique_ptr<Unknowns> finer = unknowns.refined();
  EmissionProblem emission = *model.emission;
  emission.unknowns = finer.get();
  if (!emission.absorption.empty())
    emission.absorption = refined_values(unknowns, emission.absorption);
  std::vector<double> change =
      *make_emission_operator(emission, execution) * refined_values(unknowns, found.at_places);
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= model.light[i];
  return change;
}

}  // namespace

TestOfModel test_model(const TestedModel& model, const Reconstruction& found,
                       const ProbeAccuracy& accuracy, const Execution& execution) {
  constexpr double kPartOfStep = 0.2;  // of the grid, that a camera is displaced by
  constexpr double kFocus = 1e-3;
  const Execution quiet = without_reports(execution);
  ScoreTests tests(model, found, accuracy, quiet);
  const Unknowns& unknowns = *model.emission->unknowns;
  double least = 0, longest = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (unknowns.shape()[a] < 2) continue;
    const double step = unknowns.spacing()[a];
    if (least == 0 || step < least) least = step;
    longest = std::max(longest, step * unknowns.shape()[a]);
  }
  const double across = kPartOfStep * least;
  const std::array<std::pair<SuspectKind, double>, 5> displacements{
      {{SuspectKind::right, across},
       {SuspectKind::up, across},
       {SuspectKind::forward, kPartOfStep * longest},
       {SuspectKind::turn, across / longest},
       {SuspectKind::focus, kFocus}}};
  constexpr double kDisplacements = displacements.size();
  const auto views = static_cast<double>(model.views->size());
  for (std::size_t v = 0; v < model.views->size(); ++v) {
    tests.add_of_camera(SuspectKind::stray_light, v, std::vector<double>(model.light.size(), 1.0));
    if (views > 1)
      tests.add_of_camera(SuspectKind::exposure, v, {model.light.begin(), model.light.end()});
    if (!(least > 0)) continue;
    for (std::size_t d = 0; d < displacements.size(); ++d) {
      const auto& [kind, step] = displacements[d];
      report_fraction(execution,
                      (static_cast<double>(v) + static_cast<double>(d) / kDisplacements) / views);
      try {
        tests.add_of_camera(kind, v, change_of_rows(model, v, kind, step, found.values, quiet));
      } catch (const InputError&) {
        // A camera that is displaced may be one that there cannot be: it has no test.
      }
    }
  }
  if (model.absorption && model.emission->model == RowModel::source)
    tests.add(SuspectKind::absorption, 0,
              change_by_absorption(*model.emission, found.values, *model.views, model.rays, quiet));
  if (unknowns.is_linear()) tests.set_grid(change_by_finer_grid(model, found, quiet));
  return tests.take();
}

}  // namespace plenoflame
