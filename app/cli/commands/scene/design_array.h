#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/report.h"
#include "plenoflame/camera/array_solver.h"
#include "plenoflame/scene/scene.h"
#include "plot.h"

namespace plenoflame::cli {

/// The task of solving for microlens types: the options of `design --solve`.
struct ArrayTask {
  std::string freedom;  ///< index, radius or thickness; empty: not at all
  int types = 3;
  double index_limit = 2.0;
  std::string least_radius, greatest_thickness;  ///< with unit; empty: no limit but the shape's own
  std::string output;                            ///< scene with the solved types; empty: none
};

/// Solves, and adds what came out to the report. @throws InputError, UsageError
std::vector<SolvedType> solve_for_array(const ArrayTask& task, const Scene& scene, Report& report);

/// The scene with the solved types in place of its own. @throws UsageError when the thickness was
/// free, which all types of a scene share
Scene with_solved_array(const Scene& scene, const std::vector<SolvedType>& types,
                        MicrolensFreedom freedom);

/// The paper's Fig. 4: focal length against index, radius and thickness of the first type, with the
/// solved types marked where that property was free.
std::vector<Plot> microlens_plots(const ArraySpec& array, const std::vector<SolvedType>& types,
                                  const std::string& freedom);

}  // namespace plenoflame::cli
