#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/report.h"
#include "plenoflame/camera/lens_design.h"
#include "plot.h"

namespace plenoflame::cli {

/// `design` of a lens without a camera.
struct LensTask {
  std::string file;        ///< .zmx, .dat, .txt, or TOML with [camera.lens]
  std::string field;       ///< with unit; empty: as far as light gets through
  std::string distance;    ///< of the object, with unit; empty: infinite
  std::string wavelength;  ///< with unit; empty: the d line
  bool paraxial_focus = false;
};

/// True if a file holds a lens alone: by its ending, or TOML without a sensor.
bool is_bare_lens(const std::string& path);

/// Adds the report. @param surfaces the lens that was read
LensDesign add_lens_design(const LensTask& task, MainLensSpec& lens,
                           std::vector<std::string>& notes, Report& report);

std::vector<Plot> spot_diagrams(const LensDesign& design);
std::vector<Plot> ray_fans(const LensDesign& design);
/// Field curvature, distortion, vignetting.
std::vector<Plot> field_plots(const LensDesign& design);

}  // namespace plenoflame::cli
