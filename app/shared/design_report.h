#pragma once
#include <string>
#include <vector>

#include "plenoflame/camera/design.h"
#include "plenoflame/camera/resolution.h"
#include "plenoflame/scene/scene.h"
#include "plot.h"
#include "report.h"

namespace plenoflame {

/// A length for people; infinity as a word.
std::string length_text(double value);
/// Distances in front of the array from near to far; it says where they pass through infinity.
std::string array_range_text(double near, double far);
/// A distance in the scene; negative ones lie past infinity.
std::string object_text(double value);

/// The effective resolution of a scene's camera, as every front end shows it. The wavelength is
/// that of the first channel if it is narrow, else the one of the glasses' indices.
std::vector<ResolutionPoint> design_curve(const Camera& camera, const Scene& scene);

void add_main_lens(const CameraDesign& design, Report& report);
void add_types(const Camera& camera, const CameraDesign& design, Report& report);
/// Lens counts, views, and the comparison of the paper's Table 2.
void add_array(const Camera& camera, const CameraDesign& design, Report& report);
void add_spots(const CameraDesign& design, Report& report);
void add_resolution(const std::vector<ResolutionPoint>& curve, const CameraDesign& design,
                    Report& report);

/// Adds how far each window moves a point in focus, and how far all of them together do.
void add_windows(const Camera& camera, const std::vector<WindowSpec>& windows, Report& report);

/// Effective resolution against the object's distance: paraxial dashed, by rays solid.
Plot resolution_plot(const std::vector<ResolutionPoint>& curve, const CameraDesign& design);
/// RMS radius of the spot of the main lens over the field, and over the object's distance around
/// the plane in focus. Empty for an ideal lens.
std::vector<Plot> spot_plots(const Camera& camera, const CameraDesign& design);

}  // namespace plenoflame
