#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/scene/pupil_filter_spec.h"

namespace plenoflame {

/// The parts of the main lens' stop that filters cover. Points are in radii of the stop, in the
/// frame of the main lens. Immutable.
class PupilFilters {
 public:
  PupilFilters() = default;
  explicit PupilFilters(const std::vector<PupilFilterSpec>& filters) : filters_(filters) {}

  bool empty() const { return filters_.empty(); }
  /// The filters, and what none of them covers as the last part; without filters there is one part.
  int parts() const { return static_cast<int>(filters_.size()) + 1; }
  /// The part to which a point belongs; of two filters that meet there the first.
  int part_at(Vec2 point) const;
  /// Share of the stop's area that belongs to each part, by a raster: to 1e-4.
  std::vector<double> areas() const;
  /// The name of a filter, "open" for what no filter covers.
  std::string name(int part) const;
  const std::vector<PupilFilterSpec>& filters() const { return filters_; }

 private:
  std::vector<PupilFilterSpec> filters_;
};

/// Tells whether a filter covers a point. @param margin so far inside, at least
bool covers(const PupilFilterSpec& filter, Vec2 point, double margin = 0);
/// Tells whether two filters overlap, on a raster of a 400th of the stop's radius.
bool overlap(const PupilFilterSpec& a, const PupilFilterSpec& b);

/// Corners as in a scene file: "0 0, 1 0, 1 1". @throws InputError
std::vector<Vec2> parse_corners(std::string_view text);
std::string format_corners(const std::vector<Vec2>& corners);

}  // namespace plenoflame
