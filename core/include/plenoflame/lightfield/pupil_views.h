#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame {

/// The scene as it looks through one filter of the stop.
struct PupilView {
  std::string filter;  ///< its name
  /// Radiance behind the filter [W/(m^2 sr)] and its standard error, a pixel for the area of a
  /// microlens; 0 where nothing is known. The error is empty where the light field has none.
  LightFieldChannel light;
  double pixels = 0;  ///< of the sensor for each of its pixels, on average
};

/// One picture per filter. A microlens' value is the light of the pixels that see the stop through
/// this filter alone. It is divided by their light from a uniform scene of radiance 1. Pixels that
/// also see another part of the stop or a neighbour's light are left out. Pixels that are not
/// numbers are left out as well.
/// @param channel empty: the first
/// @throws InputError: no filters, unknown channel, a filter that no pixel sees alone
std::vector<PupilView> extract_pupil_views(const LightField& light_field,
                                           const MicroImages& micro_images,
                                           const std::string& channel = {},
                                           const Execution& execution = {});

/// Blur of the stop for a pixel, in radii of the stop. Rays of one pixel through different points
/// of its microlens cross the stop this far apart. A filter must be wider to be seen alone.
/// @param type of microlens, near the axis
double blur_of_stop(const MicroImages& micro_images, int type);

/// The part of the stop (PupilFilters::part_at()) that each view of a grid sees near the axis.
/// Views are ordered row by row, as in the command `views`. -1: several parts, or none as a whole.
/// @param grid views along a side
/// @param spread as ViewSettings::spread
std::vector<int> parts_of_views(const MicroImages& micro_images, int grid, double spread);

}  // namespace plenoflame
