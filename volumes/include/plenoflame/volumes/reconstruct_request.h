#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/inverse/operator_problem.h"
#include "plenoflame/inverse/thermal_reconstruction.h"

namespace plenoflame {

/// The fields that a reconstruction looks for.
enum class Sought {
  emission,     ///< emission or source function: a linear problem
  temperature,  ///< with known absorption, on the renderer's own formulas
  both,         ///< temperature and absorption, of two channels or more
};

/// An earlier result at the places of the unknowns.
struct EarlierResult {
  std::vector<double> emission, temperature, absorption;  ///< empty: the file has no such grid
  double strength = -1;                                   ///< of its penalty; negative: not stated
  std::string shape;                                      ///< shape_text(); empty: not stated
  std::string input;                                      ///< ReconstructResult::input
};

/// A request for a reconstruction.
struct ReconstructRequest {
  UnknownsRequest unknowns;
  Sought find = Sought::emission;
  std::vector<std::string> channels;  ///< empty: the pictures' first; for both the first two
  double absorption_error = 0;        ///< relative deviation of a known absorption
  double noise = 0;                   ///< added to each pixel's own, as a share of the largest
  /// Absorption of the further channels over that of the first; empty: as that of soot.
  std::vector<double> absorption_ratios;
  std::string support;  ///< .vdb file whose first grid is 0 where nothing is
  bool all = false;     ///< also places behind dark pixels
  ReconstructionSolver solver = ReconstructionSolver::fista;
  std::vector<double> smoothing;  ///< weight of the penalty along each axis; empty: 1
  std::optional<double> strength = {};
  int iterations = 300;
  std::optional<int> subsets = {};
  std::optional<double> relaxation = {};
  std::string prior, start, resume;  ///< .vdb files; empty: none
  int rays = 64;
  int bin = 1;  ///< of rows: N, kMicroImage, kView
  int cells = 3, draws = 30, probes = 16;
  std::vector<Vec3> spreads;        ///< [m] places whose point spreads are told
  std::vector<SuspectKind> refine;  ///< quantities of cameras that are corrected
  bool refine_axis = false;         ///< the rings' axis as well, before the flame is found
  int memory = 2000;                ///< [MB] of the matrix
  OperatorForm form = OperatorForm::automatic;
  bool truth = false;  ///< compare with the first scene's flames
  std::optional<std::uint64_t> seed = {};
  /// An operator that was made for the same settings; it must outlive the reconstruction.
  BuiltRows built = {};
  /// Values in place of files.
  std::shared_ptr<const EarlierResult> start_values = nullptr, prior_values = nullptr;

  const SettingNames& names() const { return unknowns.names; }
};

/// Names of solvers, in their order.
std::vector<std::string> reconstruction_solvers();

/// Settings for core; nothing that cannot work passes, before anything is read or followed.
/// @throws UsageError
ReconstructionSettings reconstruction_settings(const ReconstructRequest& request,
                                               std::uint64_t seed);

}  // namespace plenoflame
