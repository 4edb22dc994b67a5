#include "plenoflame/inverse/reconstruction.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "inverse/built_rows.h"
#include "inverse/dark_pixels.h"
#include "inverse/expected_misfit.h"
#include "inverse/followed_change.h"
#include "inverse/model_test.h"
#include "inverse/operators/remembered_product.h"
#include "inverse/operators/scaled_problem.h"
#include "inverse/operators/worthwhile_threads.h"
#include "inverse/prior_of_draws.h"
#include "inverse/row_results.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/flame_block.h"
#include "plenoflame/inverse/flame_estimate.h"
#include "plenoflame/inverse/light_behind.h"
#include "plenoflame/inverse/row_noise.h"
#include "plenoflame/inverse/shared_assembly.h"
#include "plenoflame/inverse/strength.h"
#include "plenoflame/inverse/thermal_model.h"
#include "plenoflame/inverse/uncertainty.h"

namespace plenoflame {
namespace {

/// Shares of the progress at the ends of drawing rays, of choosing the strength and of one or two
/// solutions. The deviations take the rest, and a test of the model a fifth of the whole.
constexpr double kDrawingShare = 0.05, kChosen = 0.4, kFirst = 0.43, kSolved = 0.5, kUntested = 0.8;
/// Strengths that are tried at most, about.
constexpr int kTrials = 12;
/// Strength of a first guess: enough that what no pixel tells does not run away.
constexpr double kGuessStrength = 1e-5;
constexpr int kMostTurnsOfGuess = 10;
/// Iterations of probes and draws, at least.
constexpr int kLeastProbe = 100;
/// Iterations of draws at most. After 300, some deviations were a fifth too small.
constexpr int kMostOfDraws = 3000;
/// Probes and draws end when a solution changes by less than this part of its length. Deviations
/// that end at 1e-3 are a fifth too small, after two thirds of the iterations.
constexpr double kProbed = 1e-5;
/// [byte] Products with a smaller matrix take less time than messages between ranks.
constexpr double kLeastShared = 8e6;
/// Time of the whole over that of the first guess, within a factor of 2; shortest reported time.
constexpr double kTimesGuess = 100, kLongRun = 60;

/// Reports the steps of the work as shares of the whole, and checks for a stop.
class Watch {
 public:
  Watch(const Execution& execution, double rows,
        std::function<void(const ReconstructionState&)> watch)
      : execution_(execution),
        inner_(without_reports(execution)),
        rows_(rows),
        watch_(std::move(watch)) {}
  /// The next `count` solutions advance the progress to this share of the whole. Most end before
  /// their last iteration: each begins at the share where the previous one would have ended.
  SolverOptions watched(SolverOptions options, const ScaledProblem& problem, double to, int count,
                        bool choosing) {
    const int iterations = options.iterations;
    const double step = (to - done_) / count;
    from_ = done_ - step;
    options.watch = [this, &problem, to, step, iterations, choosing](int i, double misfit,
                                                                     std::span<const double> u) {
      if (watch_) watch_({problem.samples(u), false, choosing, rows_ > 0 ? misfit / rows_ : 0});
      if (i == 1) from_ += step;
      reached(std::min(to, from_ + step * i / iterations));
    };
    return options;
  }
  /// So much of the whole is done.
  void reached(double share) {
    done_ = std::max(done_, share);
    report_fraction(execution_, done_);
  }
  /// For what reports its own progress: from what is done to the end, or up to `to`.
  Execution rest(double to) const { return part_of_progress(execution_, done_, to - done_); }
  /// For solvers: threads and the stop.
  const Execution& inner() const { return inner_; }
  bool stopped() const { return execution_.stop.stop_requested(); }

 private:
  const Execution& execution_;
  Execution inner_;
  double rows_, from_ = 0, done_ = kDrawingShare;
  std::function<void(const ReconstructionState&)> watch_;
};

/// Takes rows that see parts of the stop that do not count for rows without a usable pixel.
void leave_out_parts(const std::vector<std::vector<char>>& parts, const CameraRays& rays,
                     const Execution& execution, MeasuredRows& measured) {
  if (parts.empty()) return;
  const RowPieces pieces = pieces_of(rays);
  const Execution quiet = without_reports(execution);
  const auto task = [&](std::size_t piece, int) {
    RowRays of_rows(rays);
    for (const std::size_t i : pieces.of(piece)) {
      const std::vector<char>& counts = parts[static_cast<std::size_t>(rays.rows[i].view)];
      for (const CameraRay& ray : of_rows.of(i))
        if (!counts[static_cast<std::size_t>(ray.part)]) measured.deviation[i] = 0;
    }
  };
  if (!parallel_for(quiet, pieces.count(), task)) throw Cancelled();
}

/// When solutions end. Trial strengths, the result and noise draws share this criterion, so that
/// misfits and deviations belong to the same problem.
SolverOptions solver_options(const ReconstructionSettings& settings, double rows) {
  SolverOptions options;
  options.iterations = settings.iterations;
  options.relative_change = 1e-6;
  // Without a penalty it is the end of the iteration that keeps noise out.
  if (!is_penalised(settings.solver)) options.misfit = expected_misfit(rows);
  return options;
}

/// Strength by cross-validation; what was found on the way is the next start.
/// @param guess of the flame
std::vector<double> choose_strength_of(const ScaledProblem& problem, std::span<const double> b,
                                       const std::vector<double>& guess,
                                       const ReconstructionInput& input, Watch& watch,
                                       Reconstruction& result) {
  result.strength = -1;  // where a stop comes before one is chosen
  // Flames more than twice as bright as this one are no prior. Cross-validation prefers them if the
  // flame seems to explain errors of the model that neighbouring pixels share.
  constexpr double kMostTimesBrighter = 2;
  StrengthRange range = kLinearRange;
  range.lowest = std::clamp(strength_of_brightness(problem, problem.regularisation(1), input.prior,
                                                   guess, watch.inner()) /
                                std::pow(kMostTimesBrighter, 2),
                            range.lowest, 0.01 * range.highest);
  range.bounded = true;
  range.points = 1 + static_cast<int>(std::ceil(std::log10(range.highest / range.lowest)));
  SolverOptions options;
  options.iterations = range.iterations;
  const StrengthChoice choice = problem.choose(
      b, range, watch.watched(options, problem, kChosen, kTrials, true), watch.inner());
  watch.reached(kChosen);
  const auto rows = static_cast<double>(result.rows - result.left_out);
  if (!watch.stopped()) result.strength = choice.strength;
  // As bright as the flame is where the search has to end.
  const bool as_bright = choice.strength <= range.lowest && range.lowest > kLinearRange.lowest;
  result.strength_at_end = choice.at_end && !as_bright;
  // The solution continues from there, often without further iterations.
  for (const SolverStep& step : choice.solution.history)
    result.history.push_back(step.misfit / rows);
  for (const StrengthPoint& point : choice.curve)
    result.trials.push_back({point.strength, point.misfit / rows, point.penalty, point.gcv});
  return problem.samples(choice.solution.x);
}

/// A problem that is solved, whose penalty is a Gaussian prior.
struct SolvedProblem {
  const ScaledProblem& problem;
  Regularisation penalty;
  const PriorOfFlame* prior =
      nullptr;  ///< of ratios, which are the unknowns; nullptr: they are not
};

/// Solves once more, with a prior that is as large as the flame is bright.
PriorOfFlame solve_by_evidence(const ScaledProblem& problem, const ReconstructionInput& input,
                               const ReconstructionSettings& settings, std::span<const double> b,
                               Watch& watch, Reconstruction& result) {
  PriorOfFlame prior = prior_by_evidence(problem, input, settings, b, result, watch.inner());
  SolverOptions options;
  options.iterations = settings.iterations;
  options.relative_change = 1e-5;
  options.start = prior.ratios->scaled(result.values);
  const Solution solution =
      solve_nnls(prior.ratios->problem(b), prior.penalty,
                 watch.watched(options, *prior.ratios, kSolved, 1, false), watch.inner());
  result.values = prior.ratios->samples(solution.x);
  result.reason = solution.reason;
  result.ratio_strength = prior.penalty.strength;
  const auto rows = static_cast<double>(result.rows - result.left_out);
  for (const SolverStep& step : solution.history) result.history.push_back(step.misfit / rows);
  return prior;
}

/// Resolution and deviations.
void add_uncertainty(const SolvedProblem& solved, const ReconstructionInput& input,
                     const ReconstructionSettings& settings, std::span<const double> b,
                     Watch& watch, Reconstruction& result) {
  const auto rows = static_cast<double>(result.rows - result.left_out);
  const ProbeAccuracy accuracy{std::max(kLeastProbe, settings.iterations), kProbed};
  const LinearProblem linear = solved.problem.problem(b);
  const double all = std::max(1, settings.draws + settings.probes);
  if (settings.probes > 0) {
    const double to = kSolved + settings.probes / all * (1 - kSolved);
    Uncertainty found =
        estimate_resolution(linear, solved.penalty, {settings.probes, 1}, watch.rest(to), accuracy);
    result.resolved_unknowns = found.resolved_unknowns;
    result.resolved = std::move(found.resolved);
    for (double& value : result.resolved) value = std::clamp(value, 0.0, 1.0);
    watch.reached(to);
  }
  // The pictures themselves determine their deviation from the model.
  const double free = free_chi_squared(result.chi_squared * rows, rows, result.resolved_unknowns);
  result.noise_factor =
      std::sqrt(free_chi_squared(result.noise_chi_squared * rows, rows, result.resolved_unknowns));
  if (settings.draws < 1) return;
  PriorOfFlame other;
  Regularisation penalty = solved.penalty;
  if (solved.prior) {
    penalty.strength = strength_of_draws(*solved.prior, input, result, watch.inner());
  } else {
    other = prior_of_draws(solved.problem, input, settings, b, result, watch.inner());
    penalty = other.penalty;
  }
  const ScaledProblem& drawn_in = other.ratios ? *other.ratios : solved.problem;
  std::vector<double> squares(result.values.size(), 0.0);
  const auto add = [&](std::span<const double> u) {
    std::vector<double> moved = drawn_in.samples(u);
    // Ratios are of the light at places.
    if (!solved.prior && !other.ratios)
      moved = values_at_places(*input.unknowns, moved, result.solved);
    for (std::size_t j = 0; j < squares.size(); ++j) squares[j] += moved[j] * moved[j];
  };
  draw_posterior(drawn_in.problem(b), penalty, {settings.draws, 1}, add, watch.rest(1),
                 {kMostOfDraws, kProbed});
  const double factor = deviation_factor(free, rows, static_cast<double>(linear.a->columns()));
  result.deviation = errors_of_chords(*input.unknowns, result.at_places, input.absorption);
  for (std::size_t j = 0; j < squares.size(); ++j) {
    const double drawn = factor * std::sqrt(squares[j] / settings.draws);
    result.deviation[j] = std::hypot(result.deviation[j], drawn);
  }
}

/// The flame's part of a change of the pictures [W], at places.
std::vector<double> followed_at_places(const SolvedProblem& solved, const Unknowns& unknowns,
                                       std::span<const double> change, const Execution& execution,
                                       const Reconstruction& found) {
  const std::vector<double> u =
      follow_change(solved.problem.problem(change), solved.penalty, change, {300, 1e-5}, execution);
  return values_at_places(unknowns, solved.problem.samples(u), found.solved);
}

PointSpread spread_of(std::size_t unknown, const Unknowns& unknowns, const SolvedProblem& solved,
                      std::span<const double> b, const Execution& execution) {
  PointSpread spread;
  spread.unknown = unknown;
  spread.place = unknowns.place(unknown);
  std::vector<double> one(unknowns.size(), 0.0);
  one[unknown] = 1;
  const double unit = solved.problem.scaled(one)[unknown];
  if (!(unit > 0)) return spread;
  std::vector<double> column =
      solved.problem.samples(point_spread(solved.problem.problem(b), solved.penalty, unknown,
                                          execution, ProbeAccuracy{kLeastProbe, 1e-5}));
  for (double& value : column) value *= unit;
  spread.peak = column[unknown];
  spread.widths = half_widths(column, unknowns.shape(), unknowns.spacing(), unknown);
  return spread;
}

/// Point spreads of the places that the input names, and of the brightest one.
void add_spreads(const ReconstructionInput& input, const SolvedProblem& solved,
                 const ReconstructionSettings& settings, std::span<const double> b,
                 const Execution& execution, Reconstruction& result) {
  for (const Vec3& place : input.spread_at) {
    std::size_t unknown = 0;
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t j = 0; j < input.unknowns->size(); ++j) {
      const double distance = length(input.unknowns->place(j) - place);
      if (distance < nearest) nearest = distance, unknown = j;
    }
    result.spreads.push_back(spread_of(unknown, *input.unknowns, solved, b, execution));
  }
  if (settings.probes < 1) return;
  const auto brightest = static_cast<std::size_t>(std::ranges::max_element(result.at_places) -
                                                  result.at_places.begin());
  result.resolution.push_back(spread_of(brightest, *input.unknowns, solved, b, execution));
}

/// Rows of the temperatures that follow, as the renderer would fill them.
std::vector<double> rendered_fluxes(const ReconstructionInput& input, const CameraRays& rays,
                                    const Reconstruction& result, const Execution& execution) {
  FlameEstimate estimate = estimate_flame(result, *input.unknowns, input.absorption, *input.source);
  ThermalModel model;
  model.channels.push_back({&rays, *input.source});
  model.unknowns = input.unknowns;
  model.temperature = std::move(estimate.temperature);
  model.absorption = std::move(estimate.absorption);
  return thermal_fluxes(model, {}, execution);
}

void check_input(const ReconstructionInput& input) {
  if (input.views.empty() || input.views.size() != input.measurements.size())
    throw UsageError("a reconstruction needs one picture for each camera");
  const auto fits = [&](std::size_t size, const char* what) {
    if (size != 0 && size != input.unknowns->size())
      throw InputError(std::string(what) + " has " + std::to_string(size) + " values for " +
                       std::to_string(input.unknowns->size()) + " unknowns");
  };
  fits(input.start.size(), "the start");
  fits(input.prior.size(), "the prior");
  fits(input.support.size(), "the support");
}

/// Before rays are followed. @throws InputError, UsageError
void check_settings(const ReconstructionSettings& settings, const Unknowns& unknowns) {
  if (wants_matrix(settings.solver) && !(settings.memory > 0 && may_be_stored(settings)))
    throw InputError(
        "this solver goes through the rows of the stored matrix, for which there is no memory: "
        "give it some, or take another solver");
  if (settings.solver == ReconstructionSolver::active_set && unknowns.size() > kMostActiveSet)
    throw InputError(std::to_string(unknowns.size()) +
                     " unknowns are too many for active sets, which take " +
                     std::to_string(kMostActiveSet) + " at most: use fista, or a coarser grid");
}

/// Unknowns in units of a typical value, those that few rays meet in larger ones; 0 for what is
/// known to be empty.
std::vector<double> scales(const LinearOperator& a, std::span<const double> b,
                           const std::vector<double>& weight, const std::vector<char>& empty,
                           Reconstruction& result) {
  std::vector<double> ones(a.rows());
  for (std::size_t i = 0; i < ones.size(); ++i) ones[i] = weight[i] > 0 ? 1 : 0;
  const std::vector<double> seen = transposed_times(a, ones);
  double mean = 0;
  for (const double s : seen) {
    mean += s;
    result.unseen += !(s > 0);
  }
  mean /= static_cast<double>(std::max<std::size_t>(1, seen.size() - result.unseen));
  if (!(mean > 0)) throw InputError("no usable pixel sees any of the unknowns");
  const std::vector<double> flat = a * std::vector<double>(a.columns(), 1.0);
  double product = 0, square = 0;
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const double w = weight[i] * weight[i];
    product += w * flat[i] * b[i];
    square += w * flat[i] * flat[i];
  }
  const double typical = product > 0 ? product / square : 1;
  std::vector<double> scale(a.columns());
  for (std::size_t j = 0; j < scale.size(); ++j) {
    result.empty += empty[j] != 0;
    const double balance = seen[j] > 0 ? std::clamp(std::sqrt(mean / seen[j]), 0.2, 5.0) : 1;
    scale[j] = empty[j] ? 0 : typical * balance;
  }
  if (result.empty == scale.size())
    throw InputError("dark pixels or the support rule out every unknown: nothing is left");
  return scale;
}

}  // namespace

Reconstruction reconstruct(const ReconstructionInput& input, const ReconstructionSettings& settings,
                           const Execution& execution) {
  check_input(input);
  check_settings(settings, *input.unknowns);
  std::vector<CameraView> views = input.views;
  for (std::size_t v = 0; v < views.size(); ++v) views[v].window = input.measurements[v].window;
  require_vector_memory(settings, *input.unknowns, input.unknowns->size(), 0);
  const RowModel model = input.absorption.empty() ? RowModel::emission : RowModel::source;
  const BuiltRows& built = input.built;
  if (built.rays) check_built(input, settings);
  // Ranks draw the rays of their rows, and this one keeps none.
  const bool may_share = settings.assembly &&
                         settings.assembly->can_share(views.size(), settings.rays) && !built.rays &&
                         may_be_stored(settings) && !wants_matrix(settings.solver);
  const std::size_t unknowns = input.unknowns->size();
  const auto memory = [&](double bytes, bool shared) {
    return shared ? settings.assembly->memory(bytes, unknowns) : bytes;
  };
  if (must_be_stored(settings) && !built.rays) {  // before all rays are drawn
    const double least =
        kBytesOfEntry * least_entries({nullptr, input.unknowns, model, input.absorption}, views,
                                      settings.rays, execution);
    is_stored(settings, least, true);
    require_vector_memory(settings, *input.unknowns, unknowns, 0, memory(least, may_share));
  }
  const Execution solving = part_of_progress(execution, 0, settings.test_model ? kUntested : 1);
  const Execution drawing = part_of_progress(solving, 0, kDrawingShare);
  const Box box = input.unknowns->bounds();
  CameraRaySettings how = settings.rays;
  CameraRays drawn;
  if (may_share)
    drawn = settings.assembly->rays(views, box, settings.form, how, drawing);
  else if (!built.rays)
    drawn = rays_of_form(settings.form, views, box, how, drawing);
  const CameraRays& rays = built.rays ? *built.rays : drawn;
  if (rays.rows.empty())
    throw InputError(
        "no ray of any camera meets the grid of the unknowns: it lies outside of all pictures");
  MeasuredRows measured = measured_rows(input.measurements, rays, settings.rays.bin);
  take_away(light_behind(views, rays, *input.unknowns, input.absorption, settings.rays, execution),
            measured);
  leave_out_parts(input.parts, rays, execution, measured);

  Reconstruction result;
  result.light_outside = light_outside(views, input.measurements, rays, settings.rays.bin);
  result.model = model;
  result.rows = rays.rows.size();
  result.rays = rays.ray_count();
  require_vector_memory(settings, *input.unknowns, unknowns, result.rows);
  const EmissionProblem problem{&rays, input.unknowns, result.model, input.absorption};
  result.matrix_bytes =
      kBytesOfEntry * static_cast<double>(may_share ? settings.assembly->entries(problem)
                                                    : estimated_entries(problem));
  result.stored = built.rays ? built.matrix != nullptr : is_stored(settings, result.matrix_bytes);
  const bool shared = may_share && result.stored && result.matrix_bytes >= kLeastShared;
  if (may_share && !shared) {
    settings.assembly->forget();
    drawn = rays_of_form(settings.form, views, box, how, without_reports(execution));
  }
  result.drawn = rays.source && !shared;
  ReconstructionSettings held = settings;
  if (!result.stored) held.memory = 0;
  require_vector_memory(held, *input.unknowns, unknowns, result.rows,
                        result.stored && !built.matrix ? memory(result.matrix_bytes, shared) : 0);
  // A stop ends the solution between two iterations, so that what was reached is kept.
  const Execution quiet = execution.threads_only();
  CsrMatrix<float> made;
  if (result.stored && !built.matrix && !shared) made = make_emission_matrix(problem, execution);
  const CsrMatrix<float>& matrix = built.matrix ? *built.matrix : made;
  // A product that follows the rays takes long: a stop ends it in the middle.
  const Execution ending = without_reports(execution);
  const std::unique_ptr<LinearOperator> multiplied =
      shared          ? settings.assembly->matrix(problem, result.matrix_bytes, execution)
      : result.stored ? make_csr_operator(matrix, worthwhile_threads(matrix, quiet))
                      : make_emission_operator(problem, ending);
  const auto remembered = std::make_unique<RememberedProduct>(*multiplied);
  const LinearOperator* const a = result.stored ? multiplied.get() : remembered.get();
  const CsrMatrix<float>* stored = result.stored && !shared ? &matrix : nullptr;

  // The picture of what is handed out, also after a stop.
  const auto image_of = [&](const std::vector<double>& x) {
    if (const auto known = remembered->of(x)) return *known;
    if (result.stored || !execution.stop.stop_requested()) return *multiplied * x;
    return *make_emission_operator(problem, quiet) * x;
  };

  const std::vector<double>& b = measured.flux;
  std::vector<double> weight = row_weights(measured, {}, {}), of_noise = weight;
  count_left_out(weight, result);
  const double rows = static_cast<double>(result.rows - result.left_out);

  RuledOut ruled;
  if (settings.support) ruled = behind_dark(*a, rays, measured, views.size(), input.support);
  std::vector<char>& empty = ruled.empty;
  empty.resize(unknowns, 0);
  ruled.hidden.resize(unknowns, 0.0);
  for (std::size_t j = 0; j < input.support.size(); ++j)
    if (input.support[j] == 0) empty[j] = 1, ruled.hidden[j] = 0;
  result.hidden = std::move(ruled.hidden);
  const std::vector<double> scale = scales(*a, b, weight, empty, result);
  for (const double s : scale) result.solved.push_back(s > 0);

  Watch watch(solving, rows, settings.watch);
  // A stop before the first iteration of the solution leaves this.
  std::vector<double> reached = input.start;
  const bool counts = std::any_of(measured.electron.begin(), measured.electron.end(),
                                  [](double electron) { return electron > 0; });
  std::vector<double> guess;
  if (settings.ray_noise || counts || settings.strength < 0) {
    // A first guess tells the light whose shot noise counts, and what the finite number of rays
    // adds.
    ReconstructionSettings plain = settings;
    plain.solver = ReconstructionSolver::fista;
    const ScaledProblem first(stored, *a, weight, scale, *input.unknowns, plain);
    const auto begun = std::chrono::steady_clock::now();
    SolverOptions options;
    options.iterations = 40;
    options.relative_change = 1e-3;
    // Fine grids need some hundred iterations to explain the light.
    double misfit = std::numeric_limits<double>::infinity();
    for (int turn = 0; turn < kMostTurnsOfGuess; ++turn) {
      const Solution better = first.solve(b, kGuessStrength, guess, options, watch.inner());
      guess = first.samples(better.x);
      if (better.history.empty() || better.history.back().misfit > 0.9 * misfit) break;
      misfit = better.history.back().misfit;
    }
    if (reached.empty()) reached = guess;
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
    if (settings.draws > 0 && kTimesGuess * took.count() > kLongRun)
      execution.note(
          fmt::format("this will take about {:.0f} min", kTimesGuess * took.count() / 60));
    if (settings.ray_noise) result.rays_error = ray_error(problem, guess, quiet);
    const std::vector<double> light = image_of(guess);
    weight = of_noise = row_weights(measured, light, result.rays_error);
    if (settings.grid_noise)
      weight = row_weights(measured, light, result.rays_error,
                           grid_errors(*a, problem, guess, result.solved));
  }
  std::vector<double> start = input.start;
  std::optional<ScaledProblem> weighted;
  PriorOfFlame prior;
  result.strength = settings.strength;
  try {
    weighted.emplace(stored, *a, weight, scale, *input.unknowns, settings);
    if (!input.prior.empty()) weighted->set_prior(input.prior);
    result.clipped = weighted->clipped(b);
    if (!weighted->has_penalty())
      result.strength = 0;
    else if (settings.strength >= 0)
      result.strength = settings.strength;
    else
      reached = start = choose_strength_of(*weighted, b, guess, input, watch, result);
    if (result.strength < 0) throw Cancelled();
    // Projected gradients are slow with a strong penalty, and make little progress from 0.
    if (settings.solver == ReconstructionSolver::fista && start.empty())
      start = weighted->without_bounds(b, result.strength, watch.inner());
    const bool again = solves_ratios(input, settings);
    const SolverOptions last = watch.watched(solver_options(settings, rows), *weighted,
                                             again ? kFirst : kSolved, 1, false);
    const Solution solution = weighted->solve(b, result.strength, start, last, watch.inner());
    watch.reached(again ? kFirst : kSolved);
    result.values = weighted->samples(solution.x);
    result.reason = solution.reason;
    for (const SolverStep& step : solution.history) result.history.push_back(step.misfit / rows);
    if (again && *std::ranges::max_element(result.values) > 0) {
      reached = result.values;
      prior = solve_by_evidence(*weighted, input, settings, b, watch, result);
    }
  } catch (const Cancelled&) {
    if (reached.empty()) throw;
    result.values = std::move(reached);
    result.reason = StopReason::stopped;
  }
  result.complete = !watch.stopped();
  const std::vector<double> explained = image_of(result.values);
  result.chi_squared = misfit_of(explained, b, weight) / rows;
  result.noise_chi_squared = misfit_of(explained, b, of_noise) / rows;
  result.at_places = values_at_places(*input.unknowns, result.values, result.solved);
  // Follows all rays once more.
  if (input.source && result.model == RowModel::source && (result.complete || result.stored))
    result.rendered_chi_squared =
        misfit_of(rendered_fluxes(input, rays, result, quiet), b, weight) / rows;
  result.explained_by_noise = explained_by_noise(result.chi_squared * rows, rows);
  result.coarse =
      result.explained_by_noise && !explained_by_noise(result.noise_chi_squared * rows, rows);
  result.resolved_unknowns = -1;
  if (result.complete) {
    try {
      // The end of an iteration has no posterior.
      if (weighted->has_penalty()) {
        const SolvedProblem solved =
            prior.ratios
                ? SolvedProblem{*prior.ratios, prior.penalty, &prior}
                : SolvedProblem{*weighted, weighted->regularisation(result.strength), nullptr};
        const auto followed = [&](std::span<const double> change) {
          return followed_at_places(solved, *input.unknowns, change, watch.inner(), result);
        };
        if (settings.draws > 0 && settings.absorption_error > 0 && model == RowModel::source) {
          result.absorption_shift = followed(
              change_by_absorption(problem, result.values, views, settings.rays, watch.inner()));
          for (double& value : result.absorption_shift) value *= settings.absorption_error;
          result.absorption_error = settings.absorption_error;
        }
        add_uncertainty(solved, input, settings, b, watch, result);
        for (std::size_t j = 0; j < result.deviation.size(); ++j)
          if (ruled.empty[j]) result.deviation[j] = result.hidden[j];
        add_spreads(input, solved, settings, b, watch.inner(), result);
        if (settings.test_model) {
          std::vector<double> left = b;
          for (std::size_t i = 0; i < left.size(); ++i) left[i] -= explained[i];
          how.keep = !rays.source;
          const auto add_to_deviation = [&](std::span<const double> change) {
            const std::vector<double> moved = followed(change);
            result.camera_deviation.resize(moved.size());
            for (std::size_t j = 0; j < moved.size(); ++j)
              result.camera_deviation[j] = std::hypot(result.camera_deviation[j], moved[j]);
          };
          const ScaledProblem plain(stored, *a, of_noise, scale, *input.unknowns, settings);
          TestOfModel tested = test_model(
              {&problem, &views, &plain, how, explained, left, settings.test_absorption,
               settings.corrected, settings.refined, add_to_deviation},
              result, {kLeastProbe, 1e-3}, part_of_progress(execution, kUntested, 1 - kUntested));
          result.suspects = std::move(tested.suspects);
          result.grid_share = tested.grid_share;
          if (!result.deviation.empty())
            for (std::size_t j = 0; j < result.camera_deviation.size(); ++j)
              result.deviation[j] = std::hypot(result.deviation[j], result.camera_deviation[j]);
        }
      }
      report_fraction(execution, 1);
    } catch (const Cancelled&) {
      result.complete = false;  // the values are kept
    }
  }
  add_row_pictures(input.measurements, rays, b, explained, weight, result);
  return result;
}

}  // namespace plenoflame
