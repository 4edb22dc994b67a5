#pragma once
#include <string>
#include <vector>

#include "plenoflame/camera/design.h"
#include "plenoflame/camera/resolution.h"
#include "plot.h"
#include "report.h"

namespace plenoflame::cli {

/// A length for people; infinity as a word.
std::string length_text(double value);
/// A distance in the scene; negative ones lie past infinity.
std::string object_text(double value);

void add_main_lens(const CameraDesign& design, Report& report);
void add_types(const Camera& camera, const CameraDesign& design, Report& report);
/// Lens counts, views, and the comparison of the paper's Table 2.
void add_array(const Camera& camera, const CameraDesign& design, Report& report);
void add_spots(const CameraDesign& design, Report& report);
void add_resolution(const std::vector<ResolutionPoint>& curve, const CameraDesign& design,
                    Report& report);

/// Effective resolution against the object's distance: paraxial dashed, by rays solid.
Plot resolution_plot(const std::vector<ResolutionPoint>& curve, const CameraDesign& design);
/// RMS radius of the spot of the main lens over the field, and over the object's distance around
/// the plane in focus. Empty for an ideal lens.
std::vector<Plot> spot_plots(const Camera& camera, const CameraDesign& design);

}  // namespace plenoflame::cli
