#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/report.h"
#include "plenoflame/camera/design.h"
#include "plenoflame/camera/resolution.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// A length for people; infinity as a word.
std::string length_text(double value);
/// Distances in front of the array from near to far; it says where they pass through infinity.
std::string array_range_text(double near, double far);

/// The effective resolution of a scene's camera. The wavelength is that of the first channel if it
/// is narrow, else the one of the glasses' indices.
std::vector<ResolutionPoint> design_curve(const Camera& camera, const Scene& scene);

/// The report of a design: main lens, microlens types, array with the paper's Table 2, resolution,
/// spots. @param curve of design_curve(), or empty
void add_design(const Camera& camera, const CameraDesign& design,
                const std::vector<ResolutionPoint>& curve, Report& report);

/// Adds how far each window moves a point in focus, and how far all of them together do.
void add_windows(const Camera& camera, const std::vector<WindowSpec>& windows, Report& report);

}  // namespace plenoflame
