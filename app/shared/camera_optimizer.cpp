#include "camera_optimizer.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "plenoflame/base/error.h"
#include "plenoflame/base/mended_by.h"
#include "plenoflame/math/readable.h"

namespace plenoflame {
namespace {

constexpr double kImpossible = -1e30, kOverlapping = -1e20;
constexpr double kTouching = 1e-9;  ///< pixels: the rounding of an overlap of none
constexpr int kGlobalPerVariable = 1500, kLocalPerVariable = 400, kTracedPerVariable = 60;

struct OptimizerDeleter {
  void operator()(nlopt_opt_s* optimizer) const { nlopt_destroy(optimizer); }
};
using Optimizer = std::unique_ptr<nlopt_opt_s, OptimizerDeleter>;

/// The merit as a function of the logarithms of factors on the start.
class Problem {
 public:
  Problem(const CameraSpec& start, const OptimizerTask& task) : start_(start), task_(task) {
    const Camera camera(start);
    for (const Microlens& lens : camera.microlenses())
      focal_lengths_.push_back(lens.first_order.focal_length);
    for (const std::string& name : task.vary) {
      if (name == "types") continue;
      const std::size_t count = name == "focal" ? focal_lengths_.size() : 1;
      for (std::size_t k = 0; k < count; ++k) variables_.push_back({name, k});
    }
    if (variables_.empty())
      throw mended_by(InputError("there is no parameter to vary; give some"), {"vary"});
    const bool free = std::any_of(variables_.begin(), variables_.end(),
                                  [](const Variable& v) { return v.name != "focal"; });
    allowed_overlap_ = task.overlap.value_or(free ? 0.0 : std::max(0.0, overlap_pixels(camera)));
  }

  std::size_t size() const { return variables_.size(); }
  int evaluations() const { return evaluations_; }
  void set_traced(bool traced) { traced_ = traced; }

  CameraSpec camera_at(const double* x) const {
    CameraChange change;
    change.freedom = task_.freedom;
    change.limits = task_.limits;
    bool focal = false;
    std::vector<double> lengths = focal_lengths_;
    for (std::size_t i = 0; i < variables_.size(); ++i) {
      const double factor = std::exp(x[i]);
      const std::string& name = variables_[i].name;
      if (name == "focal") lengths[variables_[i].type] *= factor, focal = true;
      if (name == "pitch") change.pitch = factor;
      if (name == "spacing") change.sensor_distance = factor;
      if (name == "aperture") change.aperture = factor;
      if (name == "focus") change.object_distance = factor;
    }
    if (focal) change.focal_lengths = lengths;
    return changed_camera(start_, change);
  }

  const OptimizerTask& task() const { return task_; }
  double allowed_overlap() const { return allowed_overlap_; }

  /// The value to be maximised: the merit. A camera with overlapping micro-images gets a lower
  /// value than any merit, which falls with the overlap. An impossible camera gets the lowest
  /// value.
  double value(const double* x) {
    ++evaluations_;
    try {
      const Camera camera(camera_at(x));
      const double excess = overlap_pixels(camera) - allowed_overlap_;
      if (excess > kTouching) return kOverlapping * (1 + excess);
      const double found = merit(camera, task_.merit, traced_);
      return std::isfinite(found) ? found : kImpossible;
    } catch (const InputError&) {
      return kImpossible;
    }
  }

 private:
  struct Variable {
    std::string name;
    std::size_t type;
  };
  const CameraSpec& start_;
  const OptimizerTask& task_;
  std::vector<Variable> variables_;
  std::vector<double> focal_lengths_;
  double allowed_overlap_ = 0;
  bool traced_ = false;
  int evaluations_ = 0;
};

/// A problem, and the algorithm that works on it.
struct Search {
  Problem& problem;
  nlopt_opt_s* optimizer;
};

double evaluate(unsigned, const double* x, double*, void* search) {
  const auto [problem, optimizer] = *static_cast<Search*>(search);
  if (problem.task().stop.stop_requested()) nlopt_force_stop(optimizer);
  return problem.value(x);
}

/// Runs one algorithm from x; x becomes the best point that it saw, if that is better.
void improve(Problem& problem, nlopt_algorithm algorithm, int evaluations, double time_limit,
             double first_step, std::vector<double>& x) {
  const Optimizer optimizer(nlopt_create(algorithm, static_cast<unsigned>(problem.size())));
  const double bound = std::log(problem.task().bound);
  nlopt_set_lower_bounds1(optimizer.get(), -bound);
  nlopt_set_upper_bounds1(optimizer.get(), bound);
  Search search{problem, optimizer.get()};
  nlopt_set_max_objective(optimizer.get(), evaluate, &search);
  nlopt_set_maxeval(optimizer.get(), evaluations);
  nlopt_set_xtol_rel(optimizer.get(), 0);
  nlopt_set_xtol_abs1(optimizer.get(), 1e-9);
  nlopt_set_initial_step1(optimizer.get(), first_step);
  if (time_limit > 0) nlopt_set_maxtime(optimizer.get(), time_limit);
  const double before = problem.value(x.data());
  std::vector<double> found = x;
  double best = before;
  const nlopt_result result = nlopt_optimize(optimizer.get(), found.data(), &best);
  if (problem.task().stop.stop_requested()) throw Cancelled();
  if (result < 0 && result != NLOPT_ROUNDOFF_LIMITED) return;
  if (best > before) x = found;
}

}  // namespace

OptimizerResult optimize_camera(const CameraSpec& start, const OptimizerTask& task) {
  Problem problem(start, task);
  std::vector<double> x(problem.size(), 0.0);
  const int n = static_cast<int>(problem.size());
  nlopt_srand(1);
  improve(problem, NLOPT_GN_CRS2_LM, kGlobalPerVariable * n, 0, 0.1, x);
  improve(problem, NLOPT_LN_SBPLX, kLocalPerVariable * n, 0, 0.02, x);
  if (task.traced) {
    problem.set_traced(true);
    // The formulas' best camera may be worse than the start by rays.
    const std::vector<double> unchanged(problem.size(), 0.0);
    if (problem.value(unchanged.data()) > problem.value(x.data())) x = unchanged;
    improve(problem, NLOPT_LN_SBPLX, kTracedPerVariable * n, task.time_limit, 0.05, x);
  }
  OptimizerResult result;
  result.camera = problem.camera_at(x.data());
  const double overlap = overlap_pixels(Camera(result.camera));
  if (overlap > problem.allowed_overlap() + kTouching)
    throw mended_by(InputError("the bounds allow no camera whose micro-images overlap by at most " +
                               readable_number(problem.allowed_overlap()) +
                               " pixels: the least overlap is " + readable_number(overlap) +
                               "; vary aperture, spacing or pitch, or raise a limit"),
                    {"bound", "overlap"});
  result.merit = merit(Camera(result.camera), task.merit, task.traced);
  result.evaluations = problem.evaluations();
  return result;
}

}  // namespace plenoflame
