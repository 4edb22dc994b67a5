#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/inverse/csr_matrix.h"
#include "plenoflame/inverse/measurement.h"
#include "plenoflame/inverse/posterior_chain.h"
#include "plenoflame/inverse/row_noise.h"
#include "plenoflame/inverse/solvers.h"
#include "plenoflame/inverse/suspect.h"
#include "plenoflame/inverse/unknowns.h"
#include "plenoflame/radiometry/source_function.h"

namespace plenoflame {

class SharedAssembly;

/// The functional that is minimised, and how (solvers.h). The values are never negative.
enum class ReconstructionSolver {
  fista,       ///< least squares without negative values, accelerated projected gradient
  active_set,  ///< the same exactly, for some hundred unknowns
  cgls,        ///< least squares, conjugate gradients; negative values are cut off at the end
  lsqr,        ///< the same by bidiagonalisation
  sirt,        ///< without a penalty, as all that follow: stopped when the noise explains the rest
  sart,        ///< in ordered subsets
  mlem,        ///< expectation maximisation
  osem,        ///< in ordered subsets
  mart,        ///< multiplicative, row after row
};
/// Tells whether the solver has a penalty, whose strength can be chosen.
bool is_penalised(ReconstructionSolver solver);
/// Tells whether the solver needs the rows of the stored matrix.
bool wants_matrix(ReconstructionSolver solver);

/// A state of a reconstruction while it runs.
struct ReconstructionState {
  std::span<const double> values;  ///< of the unknowns, as Reconstruction's, or temperatures [K]
  bool temperatures = false;
  bool choosing = false;   ///< a strength is tested; otherwise it is the solution itself
  double chi_squared = 0;  ///< per row
};

struct ReconstructionSettings {
  CameraRaySettings rays;
  ReconstructionSolver solver = ReconstructionSolver::fista;
  /// Weights of second differences along each axis of the unknowns, relative to each other.
  std::array<double, 3> penalty_axes{1, 1, 1};
  /// Strength of the penalty, relative to penalty_unit(), a number without units; negative: by
  /// cross-validation (strength.h).
  double strength = -1;
  /// Voxels are solved once more, with a prior that is as large as the flame is bright (fista).
  bool evidence = true;
  int iterations = 300;
  int subsets = 4;         ///< of sart and osem
  double relaxation = -1;  ///< of sirt, sart and mart; negative: 1.9, 1 and 0.05
  /// Unknowns behind dark pixels of any view count as empty.
  bool support = true;
  /// The error of rows for the finite number of rays counts as noise (row_noise.h).
  bool ray_noise = true;
  /// Errors of the grid (grid_errors()) count as noise of the rows.
  bool grid_noise = true;
  int draws = 30;               ///< of the posterior, for the standard deviations; 0: none
  bool test_model = false;      ///< suspect.h; it takes seven solutions for each camera
  bool test_absorption = true;  ///< with them, where the absorption is known
  /// Relative standard deviation of a known absorption, by a factor common to all places.
  double absorption_error = 0;
  /// Quantities that were corrected: the test estimates their remaining errors.
  std::vector<Suspect> corrected;
  /// Quantities of cameras that were corrected before: the flame's deviations hold their errors.
  /// Needs test_model.
  std::vector<Suspect> refined;
  int probes = 16;  ///< random vectors for the diagonal of the resolution matrix; 0: none
  OperatorForm form = OperatorForm::automatic;
  double memory = 2e9;  ///< [byte] that a stored matrix may take; above, rays are followed again
  /// Other processes that share the stored matrix; nullptr: there are none.
  SharedAssembly* assembly = nullptr;
  /// Called after each iteration, by the thread that reconstructs.
  std::function<void(const ReconstructionState&)> watch = {};
};

/// The rows of a linear problem that were made before: rays, and their matrix where it is stored.
struct BuiltRows {
  const CameraRays* rays = nullptr;          ///< nullptr: there are none
  const CsrMatrix<float>* matrix = nullptr;  ///< nullptr: rays are followed in each iteration
};

struct ReconstructionInput {
  std::vector<CameraView> views;
  std::vector<Measurement> measurements;  ///< one for each view
  const Unknowns* unknowns = nullptr;
  std::vector<double> absorption;  ///< [1/m] of each unknown; empty: none is known
  std::vector<double> start = {};  ///< start values, as Reconstruction's; empty: none
  std::vector<double> prior = {};  ///< values towards which the penalty pulls; empty: 0
  std::vector<char> support = {};  ///< 0: the unknown is known to be empty; empty: of none
  /// The channel's, for rendered_chi_squared; nullptr: that is not computed.
  const SourceFunction* source = nullptr;
  std::vector<Vec3> spread_at = {};  ///< places whose point spreads are computed
  /// Parts of each view's stop that count: rows that see others as well are left out. Empty: all.
  std::vector<std::vector<char>> parts = {};
  /// Made for these views, unknowns, absorption and rays of the settings; they must outlive the
  /// call.
  BuiltRows built = {};
};

/// The image of a single unknown in the reconstruction.
struct PointSpread {
  std::size_t unknown = 0;
  Vec3 place;                      ///< [m] world
  std::array<double, 3> widths{};  ///< [m] half_widths() along the axes of the unknowns
  double peak = 0;                 ///< value at the place itself: `resolved` there
};

/// A flame from its pictures.
struct Reconstruction {
  RowModel model = RowModel::emission;
  /// Samples of each unknown: source function [W/(m^2 sr)] where the absorption is known, else
  /// emission [W/(m^3 sr)].
  std::vector<double> values;
  /// The flame at the places of the unknowns, from these samples: values_at_places().
  std::vector<double> at_places;
  /// Standard deviations of at_places (uncertainty.h), including the misfit beyond noise. Empty: no
  /// draws, or the solver has no penalty.
  std::vector<double> deviation;
  /// The part of `deviation` that errors of corrected cameras make; also without draws. Empty: no
  /// camera was corrected.
  std::vector<double> camera_deviation;
  /// Error of at_places, found less true, if the true absorption is larger than the known one by
  /// the deviation of that. Empty: the absorption has none.
  std::vector<double> absorption_shift;
  double absorption_error = 0;  ///< this deviation, relative
  /// Root of chi^2 over the number of degrees of freedom (rows less the unknowns that they
  /// determine); at least 1. Above 1 the pictures differ from the model by this multiple of their
  /// noise.
  double noise_factor = 1;
  /// Diagonal of the resolution matrix: 1 if the pictures determine the unknown, 0 if the penalty
  /// does.
  std::vector<double> resolved;
  double resolved_unknowns = 0;  ///< trace of the resolution matrix; -1: not computed

  /// Difference of the temperatures' posterior from that of the linearised problem. Empty: there
  /// was no chain (kMostChained).
  std::optional<PosteriorChain> chain;

  std::vector<char> solved;  ///< 0: the unknown was known to be empty
  /// Standard deviation of the light that noise hides in each unknown that dark pixels rule out; 0
  /// in the others.
  std::vector<double> hidden;

  std::size_t rows = 0, left_out = 0;  ///< rows of A; rows among them without a usable pixel
  std::size_t rays = 0;
  std::size_t unseen = 0;  ///< unknowns that no ray meets
  std::size_t empty = 0;   ///< unknowns that dark pixels rule out
  bool stored = true;
  bool drawn = false;       ///< rays were not kept
  double matrix_bytes = 0;  ///< stored, or the size that it would have
  RayError rays_error;      ///< of rows, for the finite number of rays; part of the noise
  double strength = 0;      ///< chosen
  /// By evidence: strength of the prior of ratios to that solution, with which the result was found
  /// from it; 0: none.
  double ratio_strength = 0;
  bool strength_at_end = false;    ///< of the tested range: it may be wrong
  bool explained_by_noise = true;  ///< false: chi^2 is above what noise explains
  std::size_t clipped = 0;         ///< rows below 0 that a multiplicative solver took for 0
  /// Per row: 1 if noise and errors of the grid explain the residuals.
  double chi_squared = 0;
  double noise_chi_squared = 0;  ///< the same without errors of the grid
  bool coarse = false;           ///< noise explains the residuals only with errors of the grid
  /// The same of the temperatures that follow from it (flame_estimate.h). They are interpolated
  /// before the emission is computed, as in the renderer. Negative: not computed, or no
  /// temperatures.
  double rendered_chi_squared = -1;
  struct Trial {
    double strength, chi_squared, penalty;
    double gcv;
  };
  std::vector<Trial> trials;    ///< tested strengths: the L-curve
  std::vector<double> history;  ///< chi^2 per row, iteration by iteration, of the last solution
  StopReason reason = StopReason::iterations;  ///< of that solution's end
  std::vector<PointSpread> spreads;
  /// The point spread of the brightest unknown. Its widths are the resolution. Empty as `resolved`.
  std::vector<PointSpread> resolution;
  /// Faults of the cameras, those first that the pictures name; empty: no test of the model.
  std::vector<Suspect> suspects;
  /// Share of the misfit beyond noise that a grid of half the spacing explains; 0: no test, or
  /// none.
  double grid_share = 0;
  /// Per view: share of the light that pixels see which look past all unknowns, where it is above
  /// its noise. Empty with lamps and surfaces, whose light is not separated from it.
  std::vector<double> light_outside;
  bool complete = true;  ///< false: stopped early, with the result so far
  /// Per view, [W] what the reconstruction explains and the measured rows, at the first pixel of
  /// each row; 0 elsewhere.
  std::vector<Image> explained, residual;
};

/// [byte] Largest memory of a reconstruction's vectors, beside rays and matrix: those of the tested
/// strengths, of the solver, and of the result.
/// @param variables unknowns times the number of quantities of each
double vector_memory(const ReconstructionSettings& settings, const Unknowns& unknowns,
                     std::size_t variables, std::size_t rows);
/// The same, before any of it is taken. @param more [byte] beside them
/// @throws InputError where there is not so much
void require_vector_memory(const ReconstructionSettings& settings, const Unknowns& unknowns,
                           std::size_t variables, std::size_t rows, double more = 0);

/// @throws InputError: no ray of any camera meets the unknowns, nothing was measured there, a
///         start, prior or support of another size
/// @throws InputError: rows that were built for other pictures or unknowns
/// @throws InputError: a solver or form that needs the stored matrix, which does not fit into
///         memory
/// @throws Cancelled when a stop came before there was any solution
Reconstruction reconstruct(const ReconstructionInput& input, const ReconstructionSettings& settings,
                           const Execution& execution = {});

}  // namespace plenoflame
