#include "inverse/model_test.h"

#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// Change of the samples of voxels when their field is moved against a direction by 1 m.
std::vector<double> slope_along(const Unknowns& unknowns, std::span<const double> samples,
                                Vec3 direction) {
  const std::array<int, 3> shape = unknowns.shape();
  std::vector<double> slope(samples.size(), 0.0);
  std::size_t stride = 1;
  for (std::size_t a = 3; a-- > 0; stride *= static_cast<std::size_t>(shape[a])) {
    if (shape[a] < 2) continue;
    const Vec3 step = unknowns.place(stride) - unknowns.place(0);
    const double along = dot(direction, step) / dot(step, step);
    for (std::size_t j = 0; j < samples.size(); ++j) {
      const int at = static_cast<int>(j / stride % static_cast<std::size_t>(shape[a]));
      const double before = at > 0 ? samples[j - stride] : 0,
                   after = at + 1 < shape[a] ? samples[j + stride] : 0;
      slope[j] += 0.5 * along * (after - before);
    }
  }
  return slope;
}

/// Score tests of one problem.
class ScoreTests {
 public:
  ScoreTests(const ScaledProblem& problem, const CameraRays& rays, std::span<const double> residual,
             const Reconstruction& found, const ProbeAccuracy& accuracy, const Execution& execution)
      : problem_(problem),
        rays_(rays),
        residual_(residual),
        found_(found),
        accuracy_(accuracy),
        execution_(execution) {}

  /// @param change of the rows for a quantity that is larger by 1; those of other cameras do not
  /// change
  void add(SuspectKind kind, std::size_t view, std::vector<double> change) {
    for (std::size_t i = 0; i < change.size(); ++i)
      if (static_cast<std::size_t>(rays_.rows[i].view) != view) change[i] = 0;
    // The part of the change that the flame cannot follow.
    const std::vector<double> left = left_of(change);
    const std::span<const double> weights = problem_.weights();
    double score = 0, information = 0, own = 0;
    for (std::size_t i = 0; i < change.size(); ++i) {
      const double w = weights[i] * weights[i];
      score += w * left[i] * residual_[i];
      information += w * left[i] * change[i];
      own += w * change[i] * change[i];
    }
    // What the flame follows all but entirely is not tested.
    if (!(information > kLeastLeft * own)) return;
    suspects_.push_back(
        {kind, view, score / information, found_.noise_factor / std::sqrt(information)});
  }

  std::vector<Suspect> take() { return std::move(suspects_); }

 private:
  static constexpr double kLeastLeft = 1e-4;

  std::vector<double> left_of(const std::vector<double>& change) const {
    if (execution_.stop.stop_requested()) throw Cancelled();
    const LinearProblem linear = problem_.problem(change);
    const Regularisation penalty = problem_.regularisation(found_.strength);
    SolverOptions options;
    options.iterations = accuracy_.iterations;
    options.relative_change = accuracy_.relative_change;
    const Solution followed =
        solve_cgls(linear, {penalty.penalty, penalty.strength}, options, execution_);
    std::vector<double> left = *linear.a * followed.x;
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = change[i] - left[i];
    return left;
  }

  const ScaledProblem& problem_;
  const CameraRays& rays_;
  std::span<const double> residual_;
  const Reconstruction& found_;
  ProbeAccuracy accuracy_;
  const Execution& execution_;
  std::vector<Suspect> suspects_;
};

}  // namespace

std::vector<Suspect> test_model(const ReconstructionInput& input, const ScaledProblem& problem,
                                const CameraRays& rays, std::span<const double> residual,
                                const Reconstruction& found, const ProbeAccuracy& accuracy,
                                const Execution& execution) {
  ScoreTests tests(problem, rays, residual, found, accuracy, execution);
  const std::size_t views = input.views.size();
  const LinearOperator& a = *problem.problem(residual).a;
  const auto rows_of = [&](const std::vector<double>& samples) {
    return a * problem.scaled(samples);
  };
  const std::vector<double> light = rows_of(found.values);
  const bool voxels = input.unknowns->shape()[2] > 1;
  for (std::size_t v = 0; v < views; ++v) {
    tests.add(SuspectKind::stray_light, v, std::vector<double>(residual.size(), 1.0));
    if (views < 2) continue;
    tests.add(SuspectKind::exposure, v, light);
    if (!voxels) continue;
    const Vec3 look = normalize(input.views[v].scene->scene.camera.look_direction);
    const Vec3 across = cross(look, Vec3{0, 0, 1});
    if (!(length(across) > 0)) continue;
    const Vec3 right = normalize(across), up = cross(right, look);
    tests.add(SuspectKind::right, v, rows_of(slope_along(*input.unknowns, found.values, right)));
    tests.add(SuspectKind::up, v, rows_of(slope_along(*input.unknowns, found.values, up)));
  }
  return tests.take();
}

}  // namespace plenoflame
