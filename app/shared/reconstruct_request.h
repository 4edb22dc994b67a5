#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "plenoflame/inverse/thermal_reconstruction.h"
#include "unknowns_request.h"

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
};

/// A call for a reconstruction, as texts of the options of `plenoflame reconstruct`; all
/// front ends fill it. Empty texts stand for defaults.
struct ReconstructRequest {
  std::vector<std::string> spreads;
  std::string refine;  ///< "exposure,pose,focus,axis", or some of them
  UnknownsRequest unknowns;
  std::string find = "emission", channel, solver = "fista", smoothing, ratio;
  std::string start, resume, prior, support;  ///< files
  std::string rays = "64", iterations = "300", draws = "30", probes = "16", bin = "1", cells = "3",
              seed, subsets, memory = "2000", form = "auto";
  double strength = -1, noise = 0, relaxation = -1, absorption_error = 0;
  bool all = false, truth = false;
  /// In place of files.
  std::shared_ptr<const EarlierResult> start_values = nullptr, prior_values = nullptr;

  Sought sought() const;
  /// Quantities of cameras that may be corrected. @throws UsageError for other words
  std::vector<SuspectKind> refined() const;
  /// The rings' axis is corrected before the flame is found.
  bool refines_axis() const;
  /// Names of channels; empty: the pictures' first, or for two quantities the first two.
  std::vector<std::string> channels() const;
};

/// Names that options take.
std::vector<std::string> reconstruction_solvers();

/// Sets an option by its name, "unknowns" or "absorption-ratios"; flags ("truth", "all-voxels")
/// take true or false.
/// @throws UsageError for an unknown name and for numbers out of range
void set_option(ReconstructRequest& request, const std::string& name, const std::string& text);

/// Settings for core; nothing that cannot work passes, before anything is read or followed.
/// @throws UsageError in the words of the command line
ReconstructionSettings reconstruction_settings(const ReconstructRequest& request,
                                               std::uint64_t seed);

}  // namespace plenoflame
