#include "plenoflame/inverse/thermal_reconstruction.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "inverse/expected_misfit.h"
#include "inverse/followed_change.h"
#include "inverse/operators/scaled_problem.h"
#include "inverse/operators/vector_sums.h"
#include "inverse/operators/worthwhile_threads.h"
#include "inverse/row_results.h"
#include "inverse/step_penalty.h"
#include "inverse/thermal_start.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/inverse/flame_estimate.h"
#include "plenoflame/inverse/gauss_newton.h"
#include "plenoflame/inverse/light_behind.h"
#include "plenoflame/inverse/penalty.h"
#include "plenoflame/inverse/posterior_chain.h"
#include "plenoflame/inverse/thermal_model.h"
#include "plenoflame/inverse/uncertainty.h"

namespace plenoflame {
namespace {

/// Share of the work that the start is, for progress.
constexpr double kStartShare = 0.4;
constexpr double kFirstStrength = 1e-4, kLowestStrength = 1e-8, kHighestStrength = 10;
/// Width of the Markov chain over that of the linearised problem, above which deviations are
/// enlarged. Smaller ratios may be chance.
constexpr double kWider = 1.2;
constexpr int kLeastSteps = 10;
/// A chain with a smaller share of accepted steps does not determine a width.
constexpr double kLeastAccepted = 0.2;

/// A model's derivative with regard to scaled variables, stored where memory suffices.
class ScaledDerivative final : public LinearOperator {
 public:
  ScaledDerivative(const ThermalModel& model, std::span<const double> x,
                   const std::vector<double>& scale, double memory, const Execution& execution) {
    if (memory > 0 && kBytesOfEntry * static_cast<double>(estimated_entries(model, x)) <= memory) {
      matrix_ = make_thermal_matrix(model, x, execution);
      plain_ = make_csr_operator(matrix_, worthwhile_threads(matrix_, execution));
    } else {
      plain_ = make_thermal_derivative(model, x, execution);
    }
    scaled_ = std::make_unique<ScaledColumns>(*plain_, scale);
  }
  std::size_t rows() const override { return scaled_->rows(); }
  std::size_t columns() const override { return scaled_->columns(); }
  void apply(std::span<const double> x, std::span<double> y) const override {
    scaled_->apply(x, y);
  }
  void apply_transpose(std::span<const double> y, std::span<double> x) const override {
    scaled_->apply_transpose(y, x);
  }
  void apply_together(std::span<const double> x, std::span<double> y) const override {
    scaled_->apply_together(x, y);
  }
  void apply_transpose_together(std::span<const double> y, std::span<double> x) const override {
    scaled_->apply_transpose_together(y, x);
  }

 private:
  CsrMatrix<float> matrix_;
  std::unique_ptr<LinearOperator> plain_;
  std::unique_ptr<ScaledColumns> scaled_;
};

class ThermalSolver {
 public:
  ThermalSolver(const ThermalInput& input, const ThermalSettings& settings,
                const Execution& execution)
      : input_(input),
        settings_(settings),
        execution_(execution),
        inner_(without_reports(execution)) {}

  ThermalReconstruction solve() {
    ThermalStart start = thermal_start(input_, settings_, kStartShare, execution_);
    result_.linear_strength = start.strength;
    result_.figures.light_outside = start.light_outside;
    if (!start.complete) return stopped(std::move(start));
    set_up_data(start);
    set_up_variables(start);
    set_up_weights(start);
    result_.figures.matrix_bytes =
        kBytesOfEntry * static_cast<double>(estimated_entries(model_, physical(x_)));
    result_.figures.stored = is_stored(settings_.linear, result_.figures.matrix_bytes);
    try {
      const auto derivative = derivative_at(x_);
      set_up_penalty(*derivative, start);
      choose_and_solve();
    } catch (const Cancelled&) {
      result_.figures.complete = false;  // x_ is kept
    }
    finish();
    return std::move(result_);
  }

 private:
  /// The point that a linear reconstruction had reached.
  ThermalReconstruction stopped(ThermalStart start) const {
    ThermalReconstruction result;
    Reconstruction& figures = result.figures = std::move(start.reached);
    figures.complete = false;
    figures.reason = StopReason::stopped;
    figures.resolved_unknowns = -1;
    figures.strength = settings_.linear.strength;  // none is chosen: that was the linear problem's
    result.estimate =
        estimate_flame(figures, *input_.unknowns, input_.absorption, input_.channels[0].source);
    return result;
  }

  std::size_t unknowns() const { return input_.unknowns->size(); }
  bool thick() const { return input_.absorption.empty(); }

  std::vector<CameraView> views_of(const ThermalPictures& pictures) const {
    std::vector<CameraView> views = input_.views;
    for (std::size_t v = 0; v < views.size(); ++v)
      views[v].window = pictures.measurements[v].window;
    return views;
  }
  /// Light behind the flame in a channel, with a factor on the absorption.
  std::vector<double> behind(std::size_t channel, double factor) const {
    const ThermalPictures& pictures = input_.channels[channel];
    std::vector<double> absorption = input_.absorption;
    for (double& kappa : absorption) kappa *= factor * pictures.absorption_ratio;
    return light_behind(views_of(pictures), *rays_[channel], *input_.unknowns, absorption,
                        rays_of_channel(settings_.linear.rays, channel, pictures.channel), inner_);
  }

  void set_up_data(const ThermalStart& start) {
    Reconstruction& figures = result_.figures;
    for (const ThermalPictures& pictures : input_.channels) {
      const CameraRaySettings how =
          rays_of_channel(settings_.linear.rays, rays_.size(), pictures.channel);
      const Box box = input_.unknowns->bounds();
      rays_.push_back(std::make_unique<CameraRays>(
          rays_of_form(settings_.linear.form, views_of(pictures), box, how, inner_)));
      MeasuredRows measured = measured_rows(pictures.measurements, *rays_.back(), how.bin);
      take_away(behind(rays_.size() - 1, 1), measured);
      b_.insert(b_.end(), measured.flux.begin(), measured.flux.end());
      measured_.push_back(std::move(measured));
      figures.rays += rays_.back()->ray_count();
      figures.drawn = figures.drawn || rays_.back()->source;
      model_.channels.push_back(
          {rays_.back().get(), pictures.source, pictures.absorption_ratio, pictures.parts});
    }
    figures.rows = b_.size();
    figures.rays_error = start.rays_error;
    figures.unseen = start.unseen;
    figures.solved = start.solved;
    hidden_ = start.hidden;
    figures.model = RowModel::source;
  }

  void set_up_weights(const ThermalStart& start) {
    // Light of channels without a linear stage: the variables' at the start, as what was counted
    // would give dark rows too much weight.
    std::vector<double> light;
    if (!start.explained.empty() && start.explained.size() < model_.channels.size())
      light = thermal_fluxes(model_, physical(x_), inner_);
    std::size_t first = 0;
    for (std::size_t channel = 0; channel < measured_.size(); ++channel) {
      const std::vector<double> weights = weights_of(
          channel, std::span<const double>(light).subspan(light.empty() ? 0 : first), start);
      weights_.insert(weights_.end(), weights.begin(), weights.end());
      first += weights.size();
    }
    Reconstruction& figures = result_.figures;
    count_left_out(weights_, figures);
    rows_ = static_cast<double>(figures.rows - figures.left_out);
  }

  /// By the light that the linear stage explained, or else by this one.
  std::vector<double> weights_of(std::size_t channel, std::span<const double> light,
                                 const ThermalStart& start) const {
    const MeasuredRows& measured = measured_[channel];
    if (start.explained.empty()) return row_weights(measured, {}, {});
    const std::vector<CameraRays::Row>& rows = rays_[channel]->rows;
    const auto& views = input_.channels[channel].measurements;
    std::vector<double> explained(rows.size());
    if (channel >= start.explained.size())
      std::copy_n(light.begin(), rows.size(), explained.begin());
    else
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto v = static_cast<std::size_t>(rows[i].view);
        explained[i] = static_cast<double>(start.explained[channel][v].at(
            rows[i].column - views[v].window.x, rows[i].row - views[v].window.y));
      }
    const double largest = *std::max_element(explained.begin(), explained.end());
    const double scale =
        start.rays_error.flux.empty() || !(largest > 0) ? 1 : largest / start.rays_error.largest;
    return row_weights(measured, explained, start.rays_error.scaled(scale));
  }

  /// Variables in units in which the brightest emission changes by about its own size.
  void set_up_variables(const ThermalStart& start) {
    model_.unknowns = input_.unknowns;
    model_.absorption = input_.absorption;
    if (thick()) model_.absorbs = start.solved;
    const SourceFunction& source = input_.channels[0].source;
    double hottest = settings_.lowest_temperature;
    for (std::size_t j = 0; j < unknowns(); ++j)
      if (start.solved[j]) hottest = std::max(hottest, start.temperature[j]);
    unit_ = source(hottest) / source_slope(source, hottest);
    for (std::size_t j = 0; j < unknowns(); ++j) {
      // Matter that absorbs and is dark is cold.
      const bool cold = !thick() && input_.absorption[j] > 0 && !start.solved[j];
      x_.push_back((cold ? settings_.lowest_temperature : start.temperature[j]) / unit_);
      lower_.push_back(settings_.lowest_temperature / unit_);
      upper_.push_back((cold ? settings_.lowest_temperature : settings_.highest_temperature) /
                       unit_);
      scale_.push_back(unit_);
      smooth_.push_back(!cold);
      result_.figures.empty += start.solved[j] == 0;
    }
    if (!thick()) return;
    for (std::size_t j = 0; j < unknowns(); ++j) {
      x_.push_back(std::log(start.absorption[j]));
      lower_.push_back(std::log(settings_.lowest_absorption));
      upper_.push_back(std::log(settings_.highest_absorption));
      scale_.push_back(1);
    }
  }

  /// Each part of the variables is penalised by its share of the pictures' information.
  void set_up_penalty(const LinearOperator& derivative, const ThermalStart& start) {
    ReconstructionSettings how = settings_.linear;
    how.solver = ReconstructionSolver::cgls;
    for (std::size_t part = 0; part < (thick() ? 2U : 1U); ++part) {
      const std::vector<char>& mask = part == 0 ? smooth_ : start.solved;
      ChosenPenalty penalty = make_penalty_of(how, *input_.unknowns, mask, false);
      std::vector<double> uniform(x_.size(), 0.0);
      for (std::size_t j = 0; j < unknowns(); ++j)
        uniform[part * unknowns() + j] = mask.empty() || mask[j] != 0 ? 1 : 0;
      const double unit = penalty_unit(derivative, weights_, uniform, penalty.reference);
      penalty_.add(std::move(penalty.l), std::sqrt(unit));
    }
  }

  std::vector<double> physical(std::span<const double> x) const {
    std::vector<double> values(x.begin(), x.end());
    scale_by(scale_, values);
    return values;
  }
  /// J
  std::unique_ptr<LinearOperator> derivative_at(std::span<const double> x) const {
    return std::make_unique<ScaledDerivative>(
        model_, physical(x), scale_, result_.figures.stored ? settings_.linear.memory : 0, inner_);
  }

  /// Steps from x_. @param done, share the part of the whole that is done, and that these steps are
  Solution steps(double strength, int count, double change, double done, double share,
                 bool choosing) const {
    NonlinearProblem problem;
    problem.model = [this](std::span<const double> x) {
      last_.fluxes = thermal_fluxes(model_, physical(x), inner_);
      last_.x.assign(x.begin(), x.end());
      return last_.fluxes;
    };
    problem.derivative = [this](std::span<const double> x) { return derivative_at(x); };
    problem.b = b_;
    problem.weights = weights_;
    problem.lower = lower_;
    problem.upper = upper_;
    SolverOptions options;
    options.iterations = count;
    options.relative_change = change;
    options.start = x_;
    options.watch = [&, this](int step, double misfit, std::span<const double> x) {
      if (std::ranges::equal(x, last_.x)) taken_ = last_;
      if (settings_.linear.watch)
        settings_.linear.watch({std::span<const double>(physical(x)).first(unknowns()), true,
                                choosing, misfit / rows_});
      if (!execution_.progress) return;
      Progress progress;
      progress.fraction = done + share * std::min(1.0, step / static_cast<double>(count));
      execution_.progress(progress);
    };
    return solve_gauss_newton(problem, {&penalty_, strength}, options, inner_);
  }

  /// Variables at their bounds do not move.
  std::vector<char> free_variables() const {
    std::vector<char> free(x_.size());
    for (std::size_t j = 0; j < free.size(); ++j) free[j] = x_[j] > lower_[j] && x_[j] < upper_[j];
    return free;
  }

  /// f(x_)
  std::vector<double> explained_by(const Execution& execution) const {
    return taken_.x == x_  ? taken_.fluxes
           : last_.x == x_ ? last_.fluxes
                           : thermal_fluxes(model_, physical(x_), execution);
  }

  /// Squared factor of errors over those that noise alone would cause. The rest are errors
  /// of the grid: each is one of a place, and shared by all rows that see it.
  double square_of_errors(double misfit, double resolved) const {
    const double all = free_chi_squared(misfit, rows_, resolved);
    const double noise = std::min(all, 1 + margin_of_noise(rows_));
    return noise + (all - noise) * rows_ / std::min(rows_, static_cast<double>(unknowns()));
  }

  /// A step towards the largest evidence (MacKay 1992), on the problem that is linearised about x_.
  double strength_after(double strength) const {
    constexpr Draws kProbes{4, 2};
    constexpr ProbeAccuracy kRough{1000, 1e-4};
    constexpr double kSmoother = 1.5;  // by experiments: rows share errors also where chi^2 is 1
    const auto derivative = derivative_at(x_);
    const FreeSteps steps(*derivative, penalty_, free_variables());
    const LinearProblem problem{&steps.moving, b_, weights_};
    const double resolved = std::max(
        1.0, estimate_resolution(problem, {&steps.penalty, strength}, kProbes, inner_, kRough)
                 .resolved_unknowns);
    const double errors = square_of_errors(misfit_of(explained_by(inner_), b_, weights_), resolved);
    return std::clamp(kSmoother * errors * resolved / std::pow(norm(penalty_ * x_), 2),
                      kLowestStrength, kHighestStrength);
  }

  void choose_and_solve() {
    constexpr int kMostTrials = 6, kStepsOfTrial = 4;
    constexpr double kSettled = 0.1, kShare = 0.45 / kMostTrials;
    Reconstruction& figures = result_.figures;
    double done = kStartShare, strength = settings_.linear.strength;
    if (strength < 0) {
      figures.strength = -1;  // where a stop comes before one is chosen
      strength = kFirstStrength;
      for (int k = 0; k < kMostTrials; ++k) {
        x_ = steps(strength, kStepsOfTrial, 1e-3, done, kShare, true).x;
        done += kShare;
        const double before = std::exchange(strength, strength_after(strength));
        if (std::abs(strength - before) < kSettled * before) break;
      }
      figures.strength_at_end = strength <= kLowestStrength || strength >= kHighestStrength;
    }
    strength_ = figures.strength = strength;
    const Solution solution = steps(strength_, settings_.steps, 1e-5, done, 1 - done, false);
    x_ = solution.x;
    figures.reason = solution.reason;
    for (const SolverStep& step : solution.history) figures.history.push_back(step.misfit / rows_);
  }

  void finish() {
    Reconstruction& figures = result_.figures;
    figures.complete = figures.complete && !execution_.stop.stop_requested();
    if (!figures.complete) figures.reason = StopReason::stopped;
    FlameEstimate& estimate = result_.estimate;
    const std::vector<double> values = physical(x_);
    const std::size_t n = unknowns();
    const SourceFunction& source = input_.channels[0].source;
    estimate.temperature.assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n));
    estimate.absorption = input_.absorption;
    if (thick()) {
      estimate.absorption.assign(n, 0.0);
      for (std::size_t j = 0; j < n; ++j)
        if (model_.absorbs[j]) estimate.absorption[j] = std::exp(values[n + j]);
    }
    for (std::size_t j = 0; j < n; ++j)
      estimate.emission.push_back(estimate.absorption[j] * source(estimate.temperature[j]));
    const std::vector<double> explained = explained_by(execution_.threads_only());
    figures.chi_squared = figures.noise_chi_squared = misfit_of(explained, b_, weights_) / rows_;
    figures.explained_by_noise = explained_by_noise(figures.chi_squared * rows_, rows_);
    std::span<const double> fluxes = explained, weights = weights_;
    for (std::size_t c = 0; c < measured_.size(); ++c) {
      const std::size_t own = measured_[c].flux.size();
      add_row_pictures(input_.channels[c].measurements, *rays_[c], measured_[c].flux,
                       fluxes.first(own), weights.first(own), figures);
      fluxes = fluxes.subspan(own);
      weights = weights.subspan(own);
    }
    figures.resolved_unknowns = -1;
    if (!figures.complete) return;  // a derivative would follow all rays again, several times
    try {
      const auto derivative = derivative_at(x_);
      // Hotter means brighter for every pixel.
      const std::vector<double> brighter = transposed_times(*derivative, explained);
      figures.unseen = 0;
      for (std::size_t j = 0; j < n; ++j) figures.unseen += brighter[j] == 0 && figures.solved[j];
      add_uncertainty(*derivative, explained);
    } catch (const Cancelled&) {
      figures.complete = false;
    }
  }

  /// Deviations and resolution of the linearised problem (uncertainty.h says how), with the
  /// emission's: temperature and absorption err against each other.
  void add_uncertainty(const LinearOperator& derivative, std::span<const double> explained) {
    const std::size_t n = unknowns();
    const int draws = settings_.linear.draws, probes = settings_.linear.probes;
    const ProbeAccuracy accuracy{std::max(100, settings_.linear.iterations), 1e-5};
    const FreeSteps steps(derivative, penalty_, free_variables());
    const LinearProblem problem{&steps.moving, b_, weights_};
    const Regularisation penalty{&steps.penalty, strength_};
    Reconstruction& figures = result_.figures;
    if (probes > 0) {
      const Uncertainty found =
          estimate_resolution(problem, penalty, {probes, 1}, inner_, accuracy);
      figures.resolved_unknowns = found.resolved_unknowns;
      for (std::size_t j = 0; j < n; ++j) {
        result_.resolved_temperature.push_back(std::clamp(found.resolved[j], 0.0, 1.0));
        if (thick())
          result_.resolved_absorption.push_back(std::clamp(found.resolved[n + j], 0.0, 1.0));
      }
    }
    const double misfit = figures.chi_squared * rows_;
    figures.noise_factor = std::sqrt(free_chi_squared(misfit, rows_, figures.resolved_unknowns));
    if (draws < 1) return;
    figures.absorption_error = thick() ? 0 : settings_.linear.absorption_error;
    const std::vector<double> shift = shift_of(problem, penalty, figures.absorption_error);
    FlameEstimate& estimate = result_.estimate;
    const SourceFunction& source = input_.channels[0].source;
    std::vector<double> emission(n, 0.0), temperature(n, 0.0), absorption(n, 0.0);
    const double factor = std::sqrt(square_of_errors(misfit, figures.resolved_unknowns));
    const double share = factor * factor / draws;
    std::vector<std::vector<double>> kept;
    const bool chained = draws >= kLeastSteps && x_.size() < kMostChained;
    const auto add = [&](std::span<const double> moved) {
      if (chained) kept.emplace_back(moved.begin(), moved.end());
      for (std::size_t j = 0; j < n; ++j) {
        const double hotter = unit_ * moved[j], thicker = thick() ? moved[n + j] : 0;
        const double t = estimate.temperature[j];
        const double brighter =
            hotter * source_slope(source, t) / std::max(source(t), 1e-300) + thicker;
        temperature[j] += share * hotter * hotter;
        absorption[j] += share * thicker * thicker;
        emission[j] += share * brighter * brighter;
      }
    };
    draw_posterior(problem, penalty, {draws, 1}, add, inner_, accuracy);
    double wider = 1;
    if (chained) {
      try {
        figures.chain = chain_of(std::move(kept), factor, steps.moving, explained);
        if (figures.chain->width > kWider && figures.chain->accepted > kLeastAccepted)
          wider = figures.chain->width;
      } catch (const Cancelled&) {
        figures.complete = false;  // the deviations of the linearised problem are there
      }
    }
    std::vector<double> light(n, 0.0);
    for (std::size_t j = 0; j < n; ++j)
      if (estimate.absorption[j] > 0) light[j] = source(estimate.temperature[j]);
    // Temperature and absorption may each account for all of the light between the places.
    std::vector<double> between = errors_of_chords(*input_.unknowns, light, estimate.absorption);
    for (std::size_t j = 0; j < n; ++j)
      if (!(temperature[j] > 0)) between[j] = 0;  // held at a bound
    for (std::size_t j = 0; j < n; ++j) {
      const double t = estimate.temperature[j], kappa = estimate.absorption[j];
      const double relative = light[j] > 0 ? between[j] / light[j] : 0;
      // If the absorption is larger, the temperatures are lower, and the emission is the product.
      const double brighter = shift[j] * source_slope(source, t) / std::max(source(t), 1e-300) -
                              figures.absorption_error;
      estimate.temperature_deviation.push_back(
          std::hypot(wider * std::sqrt(temperature[j]), shift[j],
                     temperature_deviation(t, between[j], source)));
      estimate.emission_deviation.push_back(
          estimate.emission[j] * std::hypot(wider * std::sqrt(emission[j]), brighter, relative));
      if (thick())
        estimate.absorption_deviation.push_back(absorption_deviation(
            kappa, std::hypot(wider * std::sqrt(absorption[j]), std::min(relative, 1.0))));
    }
    add_hidden();
  }

  /// Places behind dark pixels, which do not shine in the estimate, may do so by what noise hides.
  void add_hidden() {
    FlameEstimate& estimate = result_.estimate;
    const SourceFunction& source = input_.channels[0].source;
    for (std::size_t j = 0; j < hidden_.size(); ++j) {
      const double hidden = hidden_[j], t = estimate.temperature[j];
      if (!(hidden > 0)) continue;
      if (thick()) {
        estimate.emission_deviation[j] = hidden;
        estimate.absorption_deviation[j] = hidden / source(t);
      } else if (estimate.absorption[j] > 0) {
        estimate.emission_deviation[j] = estimate.absorption[j] * hidden;
        estimate.temperature_deviation[j] = temperature_deviation(t, hidden, source);
      }
    }
  }

  /// [K] Error of the temperatures, found less true, if the true absorption is larger by its error.
  std::vector<double> shift_of(const LinearProblem& linear, const Regularisation& penalty,
                               double error) const {
    if (!(error > 0)) return std::vector<double>(unknowns(), 0.0);
    const std::vector<double> change = change_by_absorption([this](double factor) {
      ThermalModel other = model_;
      for (double& absorption : other.absorption) absorption *= factor;
      std::vector<double> fluxes = thermal_fluxes(other, physical(x_), inner_);
      std::size_t first = 0;
      for (std::size_t c = 0; c < rays_.size(); ++c) {
        const std::vector<double> light = behind(c, factor);
        for (std::size_t i = 0; i < light.size(); ++i) fluxes[first + i] += light[i];
        first += measured_[c].flux.size();
      }
      return fluxes;
    });
    std::vector<double> shift = follow_change(linear, penalty, change, {300, 1e-5}, inner_);
    for (double& value : shift) value *= error * unit_;
    return shift;
  }

  /// The posterior beside that of the linearised problem, where the flame shines.
  /// @param factor of the deviations over those of the draws
  PosteriorChain chain_of(std::vector<std::vector<double>> draws, double factor,
                          const LinearOperator& derivative,
                          std::span<const double> explained) const {
    for (std::vector<double>& draw : draws)
      for (double& value : draw) value *= factor;
    const auto excess = [&](std::span<const double> moved) {
      std::vector<double> x = x_, linear(b_.size());
      for (std::size_t j = 0; j < x.size(); ++j)
        x[j] = std::clamp(x[j] + moved[j], lower_[j], upper_[j]);
      derivative.apply(moved, linear);
      const std::vector<double> fluxes = thermal_fluxes(model_, physical(x), inner_);
      double sum = 0;
      for (std::size_t i = 0; i < b_.size(); ++i)
        if (weights_[i] > 0)
          sum += weights_[i] * weights_[i] *
                 (std::pow(fluxes[i] - b_[i], 2) - std::pow(explained[i] + linear[i] - b_[i], 2));
      return 0.5 * sum / (factor * factor);
    };
    std::vector<double> light = result_.estimate.emission;
    if (thick()) light.insert(light.end(), light.begin(), light.end());
    return run_posterior_chain(draws, excess, light, 1);
  }

  const ThermalInput& input_;
  const ThermalSettings& settings_;
  const Execution& execution_;
  Execution inner_;
  std::vector<std::unique_ptr<CameraRays>> rays_;
  ThermalModel model_;
  std::vector<MeasuredRows> measured_;  // of the channels
  std::vector<double> b_, weights_;
  std::vector<double> x_, lower_, upper_, scale_;  // variables in their units
  std::vector<char> smooth_;                       // temperatures that take part in the penalty
  std::vector<double> hidden_;                     // ThermalStart's
  struct Fluxes {
    std::vector<double> x, fluxes;
  };
  /// The fluxes of the last evaluated variables, and of the last accepted ones: after a stop they
  /// give the picture of the result.
  mutable Fluxes last_, taken_;
  double unit_ = 1, rows_ = 0, strength_ = 0;
  BlockPenalty penalty_;
  ThermalReconstruction result_;
};

}  // namespace

ThermalReconstruction reconstruct_thermal(const ThermalInput& input,
                                          const ThermalSettings& settings,
                                          const Execution& execution) {
  const std::size_t views = input.views.size();
  bool fits = views > 0 && !input.channels.empty(), parts_fit = true;
  for (const ThermalPictures& pictures : input.channels) {
    fits = fits && pictures.measurements.size() == views;
    parts_fit = parts_fit && (pictures.parts.empty() || pictures.parts.size() == views);
  }
  if (!fits) throw UsageError("a reconstruction needs one picture for each camera and channel");
  if (!parts_fit) throw UsageError("the parts of the stop are those of each view");
  if (input.absorption.empty() && input.channels.size() < 2 && !has_two_colours(input))
    throw UsageError(
        "one channel knows the emission only: give the absorption, a second channel, or filters of "
        "two colours in the pupil");
  if (input.absorption.empty() &&
      std::any_of(input.views.begin(), input.views.end(),
                  [](const CameraView& view) { return shines_without_flames(*view.scene); }))
    throw InputError(
        "the scene has lamps, surroundings or surfaces that shine: how much of their light passes "
        "the flame is known only where the absorption is; give it, or take them out of the scene");
  const std::size_t n = input.unknowns->size();
  for (const auto* known : {&input.absorption, &input.start_temperature, &input.start_absorption})
    if (!known->empty() && known->size() != n)
      throw InputError("a known field has " + std::to_string(known->size()) + " values for " +
                       std::to_string(n) + " unknowns");
  if (!input.start_temperature.empty() && input.absorption.empty() &&
      input.start_absorption.empty())
    throw UsageError("a start needs temperatures and absorptions");
  return ThermalSolver(input, settings, execution).solve();
}

}  // namespace plenoflame
