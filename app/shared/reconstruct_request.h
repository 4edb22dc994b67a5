#pragma once
#include <cstdint>
#include <memory>
#include <optional>
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

/// A request for a reconstruction; all front ends fill it. Empty texts stand for defaults.
struct ReconstructRequest {
  UnknownsRequest unknowns;
  std::string find = "emission", channel;
  double absorption_error = 0, noise = 0;
  std::string ratio, support;  ///< support: a file
  bool all = false;
  std::string solver = "fista", smoothing;
  std::optional<double> strength = {};
  int iterations = 300;
  std::optional<int> subsets = {};
  std::optional<double> relaxation = {};
  std::string prior, start, resume;  ///< files
  int rays = 64;
  int bin = 1;  ///< of rows: N, kMicroImage, kView
  int cells = 3, draws = 30, probes = 16;
  std::vector<std::string> spreads;
  std::string refine;  ///< "exposure,pose,focus,axis", or some of them
  int memory = 2000;   ///< [MB]
  std::string form = "auto";
  bool truth = false;
  std::optional<std::uint64_t> seed = {};
  /// An operator that was made for the same settings; it must outlive the reconstruction.
  BuiltRows built = {};
  /// In place of files.
  std::shared_ptr<const EarlierResult> start_values = nullptr, prior_values = nullptr;

  const SettingNames& names() const { return unknowns.names; }
  Sought sought() const;
  /// Quantities of cameras that may be corrected. @throws UsageError for other words
  std::vector<SuspectKind> refined() const;
  /// The rings' axis is corrected before the flame is found.
  bool refines_axis() const;
  /// Names of channels; empty: the pictures' first, or for two quantities the first two.
  std::vector<std::string> channels() const;
};

/// Names of solvers.
std::vector<std::string> reconstruction_solvers();

template <>
std::span<const SettingRow<ReconstructRequest>> setting_rows();

/// Sets a setting of it, or of its unknowns, by its name; flags take true or false. Repeated
/// settings are added. @throws UsageError for an unknown name and for numbers out of range
void set_option(ReconstructRequest& request, const std::string& name, const std::string& text);

/// Settings for core; nothing that cannot work passes, before anything is read or followed.
/// @throws UsageError
ReconstructionSettings reconstruction_settings(const ReconstructRequest& request,
                                               std::uint64_t seed);

}  // namespace plenoflame
