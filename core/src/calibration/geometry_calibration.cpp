#include "plenoflame/calibration/geometry_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "calibration/free_values.h"
#include "calibration/geometry_fit.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/camera/camera.h"

namespace plenoflame {
namespace {

constexpr int kMostTurns = 5;

/// @throws InputError for an observation outside of the sensor by more than a micro-image. The edge
///         may cut off the part of a micro-image that holds its centre or, with noise, a corner
void check_on_sensor(const CameraSpec& camera, const std::string& what, Vec2 pixel) {
  const SensorSpec& sensor = camera.sensor;
  const Vec2 margin{camera.array.pitch / sensor.pixel().x, camera.array.pitch / sensor.pixel().y};
  if (pixel.x >= -margin.x && pixel.y >= -margin.y && pixel.x <= sensor.columns + margin.x &&
      pixel.y <= sensor.rows + margin.y)
    return;
  throw InputError(
      fmt::format("{} at column {:.6g}, row {:.6g} does not lie on the camera's sensor of {} x {} "
                  "pixels: is it another camera's?",
                  what, pixel.x, pixel.y, sensor.columns, sensor.rows));
}

/// @param free the fitted values @param rms_of_start with the poses alone
/// @throws InputError where lengths ran away, or the start camera explains more
void check_plausible(const CameraSpec& start, const std::vector<const FreeValue*>& free,
                     double rms_of_start, const GeometryCalibration& found) {
  constexpr double kMost = 2;  // times, or a half: values to start with are those of a data sheet
  const std::string what_to_do = fmt::format(
      "give more poses at other distances and angles, {}search for fewer values, or "
      "check whether the corners are this camera's",
      found.centres == 0 ? "give centres of micro-images, " : "");
  CameraSpec before = start, after = found.camera;
  for (const FreeValue* value : free) {
    const std::string key = value->key;
    if (!key.ends_with("focal_length") && !key.ends_with("lens_distance") &&
        !key.ends_with("sensor_distance") && !key.ends_with("pitch"))
      continue;
    const double from = value->of(before), to = value->of(after);
    if (to > from / kMost && to < from * kMost) continue;
    throw InputError(fmt::format("the fit ran away: {} went from {} to {}; {}", key,
                                 readable_quantity(from, Dimension::length),
                                 readable_quantity(to, Dimension::length), what_to_do));
  }
  constexpr double kWorse = 1.05;  // places give way to centres and blur
  if (found.corner_rms > kWorse * rms_of_start)
    throw InputError(fmt::format(
        "the camera that was found leaves {:.3g} pixels RMS of the corners, the one to start with "
        "{:.3g}; {}",
        found.corner_rms, rms_of_start, what_to_do));
}

/// Some corners of each pose, and some centres: enough to choose where to start.
GeometryObservations thinned(const GeometryObservations& seen) {
  constexpr std::size_t kCornersOfPose = 100, kCentres = 500;
  std::map<int, std::size_t> count, number;
  for (const CornerObservation& corner : seen.corners) ++count[corner.pose];
  GeometryObservations some;
  some.radii = seen.radii;
  for (const CornerObservation& corner : seen.corners)
    if (number[corner.pose]++ % (1 + count[corner.pose] / kCornersOfPose) == 0)
      some.corners.push_back(corner);
  for (std::size_t i = 0; i < seen.centres.size(); i += 1 + seen.centres.size() / kCentres)
    some.centres.push_back(seen.centres[i]);
  return some;
}

void solve_poses(GeometryFit& fit, const Execution& execution) {
  fit.start_poses();
  fit.solve({}, execution);
  fit.turn_poses_over(execution);
}

/// The camera with the poses. A better camera tells more about the poses. @return count of steps
int solve_from_start(GeometryFit& fit, const std::vector<const FreeValue*>& free,
                     const Execution& execution) {
  int steps = fit.solve(free, execution);
  for (int round = 0; round < kMostTurns && fit.turn_poses_over(execution); ++round)
    steps += fit.solve(free, execution);
  return steps + fit.solve(free, execution);
}

/// The camera of the focal length from which a part of the observations is explained best. The
/// plane in focus stays.
CameraSpec best_start(const CameraSpec& spec, const GeometryObservations& seen,
                      const std::vector<const FreeValue*>& free, const Execution& execution) {
  const bool is_free = std::any_of(free.begin(), free.end(), [](const FreeValue* value) {
    return std::string(value->key) == "camera.lens.focal_length";
  });
  if (!is_free) return spec;
  const GeometryObservations some = thinned(seen);
  const double focus = GeometryFit::plane_in_focus(Camera(spec));
  CameraSpec best = spec;
  double least = 0;
  for (const double factor : {1.0, 0.93, 1.07}) {
    CameraSpec start = spec;
    start.lens.focal_length *= factor;
    start.focus.lens_distance = 1 / (1 / start.lens.focal_length - 1 / focus);
    if (factor == 1) start.focus.lens_distance = spec.focus.lens_distance;
    try {
      GeometryFit fit(start, some);
      solve_poses(fit, execution);
      solve_from_start(fit, free, execution);
      constexpr double kBetter = 0.99;  // or the first one remains
      if (factor != 1 && !(fit.misfit() < kBetter * least)) continue;
      least = fit.misfit();
      best = start;
    } catch (const InputError&) {  // a camera that cannot be
      if (factor == 1) throw;
    }
  }
  return best;
}

/// Finds what corners have in common beside the camera. These are places of the board's points, and
/// displacements outwards in their micro-images, which differ between types, and from the radii.
int loosen(GeometryFit& fit, const GeometryObservations& seen, const Execution& execution) {
  double reach = 0;
  for (const CornerObservation& corner : seen.corners)
    reach = std::max(reach, length(corner.board));
  constexpr double kBoard = 1e-3, kOutwards = 0.03;  // where deviations start
  int steps = fit.loosen(&Looseness::board, kBoard * reach, execution);
  if (fit.types() > 1 || seen.radii || fit.has_blur())
    steps += fit.loosen(&Looseness::outwards, kOutwards, execution);
  return steps;
}

}  // namespace

GeometryCalibration calibrate_geometry(const CameraSpec& start,
                                       const std::vector<CornerObservation>& corners,
                                       const std::vector<CentreObservation>& centres,
                                       const GeometrySettings& settings,
                                       const Execution& execution) {
  if (!(start.lens.model == LensModel::ideal && start.lens.surfaces.empty() &&
        start.array.present && start.array.model == LensModel::ideal))
    throw InputError(
        "the fit starts from a camera with a thin ideal main lens and ideal microlenses; an "
        "imported camera is such");
  if (corners.empty()) throw InputError("there is no corner among the observations");
  for (const CornerObservation& corner : corners)
    check_on_sensor(start, fmt::format("a corner of pose {}", corner.pose), corner.pixel);
  for (const CentreObservation& centre : centres)
    check_on_sensor(start, "a micro-image's centre", centre.pixel);
  const Camera camera(start);
  CameraSpec spec = start;
  spec.focus.mode = FocusMode::distance;
  spec.focus.lens_distance = camera.lens_distance();
  spec.array.measured_from = ArrayReference::principal_plane;
  spec.array.sensor_distance = camera.microlenses()[0].sensor_distance;
  spec.array.spacing_error = 0;
  const std::vector<const FreeValue*> free = chosen_values(settings, !centres.empty());
  const auto plane = std::find_if(free.begin(), free.end(), is_plane);
  const bool finds_plane = plane != free.end();
  // Distortion that is not there yet begins with the plane in focus.
  if (spec.lens.distortion.none() || (finds_plane && !std::isfinite(spec.lens.distortion.distance)))
    spec.lens.distortion.distance = GeometryFit::plane_in_focus(camera);
  GeometryObservations seen{corners, centres, {}};
  if (!settings.radii.empty()) seen.radii = radii_slope(settings.radii, settings.f_number);
  // Without distortion its plane has no effect, so the plane is fitted last.
  std::vector<const FreeValue*> found = free;
  if (finds_plane) found.erase(found.begin() + (plane - free.begin()));
  GeometryFit fit(spec, seen);
  solve_poses(fit, execution);
  const double rms_of_start = fit.corner_rms();
  if (const CameraSpec start_of_fit = best_start(spec, seen, found, execution);
      start_of_fit.lens.focal_length != spec.lens.focal_length) {
    fit = GeometryFit(start_of_fit, seen);
    solve_poses(fit, execution);
  }
  int steps = solve_from_start(fit, found, execution);
  fit.check_determined();
  const auto solve_all = [&] {
    steps += fit.solve(found, execution);
    if (!finds_plane) return;
    const double before = fit.plane();
    const bool is_asked_for =
        std::find(settings.free.begin(), settings.free.end(), (*plane)->key) != settings.free.end();
    if (is_asked_for || fit.knows_plane(free)) {
      steps += fit.solve(free, execution);
      if (is_asked_for || fit.knows_plane(free)) return;
      fit.put_plane(before);
    }
    steps += fit.solve(found, execution);
  };
  if (finds_plane) solve_all();
  if (settings.outlier > 0 && fit.leave_out(settings.outlier) > 0) solve_all();
  fit.check_determined();
  const double conflict = fit.radii_conflict();
  double by_places = 0;  // relative error of the sensor distance
  if (std::ranges::any_of(corners, [](const auto& corner) { return corner.blur_error > 0; }))
    for (const CalibratedValue& value : fit.result(steps, settings.pupil).values)
      if (value.key == "camera.array.sensor_distance") by_places = value.error / value.value;
  steps += fit.use_blur(settings.microlens, execution);
  if (seen.radii && !fit.has_blur()) steps += fit.solve_weighted(execution);
  steps += loosen(fit, seen, execution);
  GeometryCalibration result = fit.result(steps, settings.pupil);
  if (result.blur) result.blur->change_error = std::hypot(settings.microlens, by_places);
  check_plausible(spec, found, rms_of_start, result);
  result.camera.array.diameter = std::min(start.array.diameter, result.camera.array.pitch);
  if (result.radii) {
    result.radii->conflict = conflict;
    if (!result.blur) set_focal_lengths(result.camera, seen.radii->blur);
  }
  return result;
}

}  // namespace plenoflame
