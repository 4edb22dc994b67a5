#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/optics/first_order.h"
#include "plenoflame/optics/surface_shape.h"
#include "scene/schema/nearest.h"
#include "scene/validation/issues.h"

namespace plenoflame {

double sag(double radius, double height) {
  if (std::isinf(radius)) return 0;
  // h^2 / (R (1 + sqrt(1 - h^2/R^2))), which keeps its digits for a flat surface.
  const double c = height / radius;
  return height * c / (1 + std::sqrt(std::max(0.0, 1 - c * c)));
}

std::string short_length(double value) {
  return readable_quantity(value, Dimension::length);
}

namespace {

constexpr double kMostPixels = 1e9;
constexpr double kMostLenses = 1e8;
constexpr double kMostOverlap = 100;
/// Faces may touch; this share of their length is rounding.
constexpr double kTouch = 1e-12;

void check_orientation(const CameraSpec& camera, Issues& issues) {
  const double look = length(camera.look_direction);
  const double up = length(camera.up);
  if (look == 0) {
    issues.error("camera.look_direction",
                 "camera.look_direction is 0, 0, 0; give the direction in which the camera looks");
    return;
  }
  if (up == 0 || length(cross(camera.look_direction, camera.up)) <= 1e-9 * look * up)
    issues.error("camera.up",
                 "camera.up is parallel to camera.look_direction; give another direction that is "
                 "up in the picture");
}

/// Two consecutive surfaces must not cross within the clear diameter of both. Between spheres the
/// gap changes monotonically with the height, so its ends are enough; other surfaces are sampled
/// between them too.
void check_gap(const std::vector<SurfaceSpec>& surfaces, std::size_t i, Issues& issues) {
  const SurfaceSpec& a = surfaces[i];
  const SurfaceSpec& b = surfaces[i + 1];
  double height = 0.5 * std::min(a.diameter, b.diameter);
  const auto gap_at = [&](Vec2 place) {
    return a.thickness + surface_sag(b, place) - surface_sag(a, place);
  };
  double gap = gap_at({height, 0});
  if (is_aspheric(a) || is_aspheric(b)) {
    constexpr int kSteps = 32;
    for (const Vec2 place : places_on(is_round(a) && is_round(b), height, kSteps))
      if (const double here = gap_at(place); here < gap) gap = here, height = length(place);
  }
  if (gap >= -kTouch * (a.thickness + height)) return;
  issues.error(fmt::format("camera.lens.surfaces[{}].thickness", i),
               fmt::format("surfaces {} and {} of the main lens overlap by {} at their common rim, "
                           "{} from the axis; "
                           "make the thickness {} or more, or a diameter smaller",
                           i, i + 1, short_length(-gap), short_length(height),
                           short_length(a.thickness - gap)));
}

/// Smallest focal length over diameter: R / (2 (n - 1)) with 2 R = D and n = 5. It belongs to a
/// thin lens of two spheres of that diameter and of the highest index that a file can give.
constexpr double kShortest = 1.0 / 16;

/// An ideal lens that no glass could be.
void check_strength(const std::string& key, double focal_length, double diameter, Issues& issues) {
  if (focal_length == 0 || std::fabs(focal_length) >= kShortest * diameter) return;
  issues.error(
      key, fmt::format("{} is {}, too short for glass with the diameter {}; it must be at least {}",
                       key, short_length(focal_length), short_length(diameter),
                       short_length(kShortest * diameter)));
}

/// The f-number is computed from the stop. It is wrong where the rims of the glass limit the light
/// instead. Light that converges may pass a stop that is somewhat wider than the glass behind it.
void check_stop(const std::vector<SurfaceSpec>& surfaces, std::size_t stop, Issues& issues) {
  constexpr double kMostWider = 1.5;
  double widest = 0;
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    if (i != stop) widest = std::max(widest, surfaces[i].diameter);
  if (widest > 0 && surfaces[stop].diameter > kMostWider * widest)
    issues.warning(fmt::format("camera.lens.surfaces[{}].diameter", stop),
                   fmt::format("the stop of the main lens is {} wide and its widest surface {}: "
                               "the surfaces limit the light, and the f-number, which is computed "
                               "from the stop, is too small; make the stop smaller",
                               short_length(surfaces[stop].diameter), short_length(widest)));
}

void check_lens(const MainLensSpec& lens, Issues& issues) {
  if (lens.surfaces.empty()) {
    if (lens.model == LensModel::real) {
      issues.error("camera.lens",
                   "the main lens has no surfaces; list them as [[camera.lens.surfaces]], or set "
                   "camera.lens.model = \"ideal\" with focal_length and diameter");
      return;
    }
    if (lens.focal_length <= 0)
      issues.error("camera.lens.focal_length",
                   "camera.lens.focal_length is missing: an ideal lens without surfaces needs it");
    if (lens.diameter <= 0)
      issues.error("camera.lens.diameter",
                   "camera.lens.diameter is missing: an ideal lens without surfaces needs it, or "
                   "camera.lens.f_number");
    if (lens.focal_length > 0)
      check_strength("camera.lens.focal_length", lens.focal_length, lens.diameter, issues);
    return;
  }
  const std::size_t errors = issues.errors();
  std::vector<std::size_t> stops;
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    const SurfaceSpec& surface = lens.surfaces[i];
    if (surface.stop) stops.push_back(i);
    const std::string path = fmt::format("camera.lens.surfaces[{}].", i);
    if (const auto fault = surface_fault(surface))
      issues.error(path + fault->key,
                   fmt::format("surface {} of the main lens {}", i, fault->text));
    if (lens.model == LensModel::ideal && !is_round(surface))
      issues.error(
          "camera.lens.model",
          fmt::format("surface {} of the main lens is not round, and an ideal lens has one "
                      "focal length; set camera.lens.model = \"real\"",
                      i));
  }
  if (stops.empty())
    issues.error("camera.lens.surfaces",
                 "no surface of the main lens is the stop; set stop = true on one of them");
  if (stops.size() > 1)
    issues.error(
        fmt::format("camera.lens.surfaces[{}].stop", stops[1]),
        fmt::format("surfaces {} and {} of the main lens are both the stop; only one can be",
                    stops[0], stops[1]));
  if (lens.surfaces.back().index != 1)
    issues.error(fmt::format("camera.lens.surfaces[{}].index", lens.surfaces.size() - 1),
                 "the index behind the last surface of the main lens must be 1: the light leaves "
                 "it into air");
  if (issues.errors() == errors)
    for (std::size_t i = 0; i + 1 < lens.surfaces.size(); ++i) check_gap(lens.surfaces, i, issues);
  if (issues.errors() != errors) return;
  const double focal_length = first_order(lens).focal_length;
  if (!(focal_length > 0) || std::isinf(focal_length))
    issues.error("camera.lens.surfaces",
                 "the main lens does not converge, so it forms no image; its focal length is " +
                     (std::isfinite(focal_length) ? short_length(focal_length) : "infinite"));
  check_stop(lens.surfaces, stops.front(), issues);
  if (lens.focal_length != 0)
    issues.warning("camera.lens.focal_length",
                   "camera.lens.focal_length is not used, because the lens has surfaces");
}

void check_type(const ArraySpec& array, std::size_t i, Issues& issues) {
  const MicrolensSpec& type = array.types[i];
  const std::string path = fmt::format("camera.array.types[{}].", i);
  const double height = MicrolensAperture(array).radius();
  const std::size_t errors = issues.errors();
  const auto check_radius = [&](const char* name, double radius) {
    if (height > std::fabs(radius))
      issues.error_among(
          {path + name, "camera.array.diameter"},
          fmt::format("microlens type {} has a {} of {}, too small for the diameter of {}{}", i,
                      name, short_length(radius), short_length(2 * height),
                      array.aperture == ApertureShape::circular ? "" : " across its corners"));
  };
  check_radius("radius_front", type.radius_front);
  check_radius("radius_back", type.radius_back);
  if (issues.errors() != errors) return;
  const bool planes = std::isinf(type.radius_front) && std::isinf(type.radius_back);
  if (planes && array.model == LensModel::real) {
    issues.error(
        path + "radius_front",
        fmt::format(
            "microlens type {} has two plane faces; give it a radius_front or a radius_back", i));
    return;
  }
  if (planes && type.focal_length == 0)
    issues.error(path + "focal_length",
                 fmt::format("microlens type {} needs a focal_length, or radii", i));
  if (planes || (array.model == LensModel::ideal && type.focal_length != 0))
    check_strength(path + "focal_length", type.focal_length, array.diameter, issues);
  if (!planes && type.focal_length != 0 && array.model == LensModel::real)
    issues.warning(path + "focal_length",
                   path + "focal_length is not used, because the type has radii");
  // Faces must not cross at the rim; convex ones take this much of the thickness.
  const double taken = sag(type.radius_front, height) + sag(type.radius_back, height);
  if (array.model == LensModel::real &&
      array.thickness - taken < -kTouch * (array.thickness + height))
    issues.error_among(
        {"camera.array.thickness", "camera.array.diameter", path + "radius_front",
         path + "radius_back"},
        fmt::format("the faces of microlens type {} overlap at its rim; a thickness of at "
                    "least {} is needed",
                    i, short_length(taken)));
}

void check_array(const CameraSpec& camera, Issues& issues) {
  const ArraySpec& array = camera.array;
  if (!array.present) return;
  const std::size_t errors = issues.errors();
  if (array.types.empty() || array.types.size() > 3)
    issues.error(
        "camera.array.types",
        fmt::format("the microlens array has {} types; list 1 to 3 as [[camera.array.types]]",
                    array.types.size()));
  for (std::size_t i = 0; i < array.types.size(); ++i) {
    const std::string& name = array.types[i].name;
    const std::string path = fmt::format("camera.array.types[{}].name", i);
    if (name.empty()) issues.error(path, fmt::format("microlens type {} has no name", i));
    if (name == "array" || name == "sensor")
      issues.error(path, "a microlens type must not be named \"" + name +
                             "\", which has a meaning in camera.focus.conjugate");
    for (std::size_t k = 0; k < i; ++k)
      if (!name.empty() && array.types[k].name == name)
        issues.error(
            path, fmt::format("microlens types {} and {} are both named {}; names must differ", k,
                              i, quote_for_message(name)));
  }
  const double shortest = shortest_pitch(array);
  const Vec2 pixel = camera.sensor.pixel();
  const double lenses =
      (camera.sensor.columns * (pixel.x / shortest)) * (camera.sensor.rows * (pixel.y / shortest));
  if (!(lenses < kMostLenses))
    issues.error("camera.array.pitch",
                 fmt::format("at a pitch of {} about {:.1g} microlenses are in front of the "
                             "sensor; at most {:.0e} are possible",
                             short_length(array.pitch), lenses, kMostLenses));
  check_microlens_shape(array, issues);
  for (std::size_t i = 0; i < array.types.size(); ++i) check_type(array, i, issues);
  if (issues.errors() != errors) return;

  // From the rear vertices to the sensor; a concave rear face reaches further back at its rim.
  const double rear_principal = first_order(array, array.types[0]).rear_principal;
  const bool from_vertex =
      array.measured_from == ArrayReference::vertex || array.model == LensModel::ideal;
  const double gap =
      array.sensor_distance + (from_vertex ? 0 : rear_principal) + array.spacing_error;
  double reach = 0;
  if (array.model == LensModel::real)
    for (const MicrolensSpec& type : array.types)
      reach = std::max(reach, -sag(type.radius_back, MicrolensAperture(array).radius()));
  if (!(gap > reach))
    issues.error_among(
        {"camera.array.sensor_distance", "camera.array.types", "camera.array.thickness"},
        fmt::format(
            "the sensor would lie inside the microlenses, {} from their rear vertices; make "
            "camera.array.sensor_distance larger",
            short_length(gap)));
  if (const double room = room_of_microlenses(array); array.centre_jitter > room)
    issues.error_among(
        {"camera.array.centre_jitter", "camera.array.diameter", "camera.array.pitch"},
        fmt::format(
            "microlenses displaced by up to {} would overlap: of the pitch of {} the diameter "
            "of {} leaves {} to each; make centre_jitter or diameter smaller",
            short_length(array.centre_jitter), short_length(array.pitch),
            short_length(array.diameter), short_length(std::max(0.0, room))));
  const double reach_across = camera.sensor.corner();
  const double fall = std::tan(length(array.tilt)) * reach_across;
  if (fall >= gap - reach)
    issues.error(
        "camera.array.tilt",
        fmt::format("the array is {} from the sensor, and its tilt takes it {} nearer at "
                    "the sensor's corner; make the tilt less than {}",
                    short_length(gap - reach), short_length(fall),
                    readable_quantity(std::atan((gap - reach) / reach_across), Dimension::angle)));
  // The radii that jitter leaves must still hold the clear diameter.
  if (array.model == LensModel::real && array.focal_jitter > 0)
    for (std::size_t i = 0; i < array.types.size(); ++i)
      for (const double radius : {array.types[i].radius_front, array.types[i].radius_back})
        if (MicrolensAperture(array).radius() > std::fabs(radius) * (1 - array.focal_jitter)) {
          issues.error("camera.array.focal_jitter",
                       fmt::format("with a focal_jitter of {} a radius of microlens type {} may "
                                   "become {}, too small for the diameter of {}",
                                   array.focal_jitter, i,
                                   short_length(std::fabs(radius) * (1 - array.focal_jitter)),
                                   short_length(array.diameter)));
          break;
        }
  if (pixel.x > array.pitch || pixel.y > array.pitch)
    issues.warning(
        pixel.x > array.pitch ? "camera.sensor.pixel_pitch" : "camera.sensor.pixel_pitch_y",
        fmt::format(
            "a pixel of {} is larger than a microlens of {}, so micro-images are not resolved",
            short_length(std::max(pixel.x, pixel.y)), short_length(array.pitch)));
}

void check_focus(const CameraSpec& camera, bool lens_is_sound, Issues& issues) {
  const FocusSpec& focus = camera.focus;
  std::vector<std::string> allowed;
  if (camera.array.present) {
    allowed.emplace_back("array");
    for (const MicrolensSpec& type : camera.array.types) allowed.push_back(type.name);
  } else {
    allowed.emplace_back("sensor");
  }
  if (std::find(allowed.begin(), allowed.end(), focus.conjugate) == allowed.end()) {
    std::string list;
    for (const std::string& name : allowed) list.append(list.empty() ? "" : ", ").append(name);
    issues.error_among({"camera.focus.conjugate", "camera.array.types", "camera.array.present"},
                       "camera.focus.conjugate is " + quote_for_message(focus.conjugate) +
                           ", but with this camera it can be " + list);
  }
  if (focus.mode == FocusMode::distance) {
    if (focus.lens_distance <= 0)
      issues.error("camera.focus.lens_distance",
                   "camera.focus.lens_distance is missing: mode \"distance\" needs it");
    return;
  }
  if (focus.object_distance <= 0) {
    issues.error(
        "camera.focus.object_distance",
        "camera.focus.object_distance is missing: modes \"paraxial\" and \"best\" need it");
    return;
  }
  if (!lens_is_sound) return;
  const double focal_point = -first_order(camera.lens).front_focal_distance;
  if (focus.object_distance <= focal_point)
    issues.error("camera.focus.object_distance",
                 fmt::format("the object plane at {} lies inside the front focal point at {}, so "
                             "its image is virtual "
                             "and cannot be in focus; move it farther away",
                             short_length(focus.object_distance), short_length(focal_point)));
}

/// Number of microlenses, in a row, that light one pixel: the width of a micro-image over the
/// pitch. The cost of a pixel grows with its square.
void check_overlap(const Camera& camera, Issues& issues) {
  if (!camera.has_array()) return;
  const FirstOrder& lens = camera.lens_first_order();
  const double distance = camera.exit_pupil() - camera.aim_plane(0);
  const double cone = std::isfinite(distance) ? lens.exit_pupil_diameter / std::fabs(distance)
                                              : lens.entrance_pupil_diameter / lens.focal_length;
  const double gap = camera.aim_plane(0) - camera.sensor();
  const double row = gap * cone / camera.spec().array.pitch;
  if (row <= kMostOverlap) return;
  issues.error_among({"camera.array.sensor_distance", "camera.array.pitch"},
                     fmt::format("the micro-images are {} wide at a pitch of {}: {:.3g} of them, "
                                 "in a row, overlap on every pixel, and at most {:.0f} are "
                                 "possible; make camera.array.sensor_distance or the stop smaller",
                                 short_length(gap * cone), short_length(camera.spec().array.pitch),
                                 row, kMostOverlap));
}

}  // namespace

void check_camera(const CameraSpec& camera, Issues& issues) {
  const std::size_t errors_before = issues.errors();
  check_orientation(camera, issues);
  const std::size_t errors = issues.errors();
  check_lens(camera.lens, issues);
  const bool lens_is_sound = issues.errors() == errors;
  check_array(camera, issues);
  if (double(camera.sensor.columns) * camera.sensor.rows > kMostPixels)
    issues.error("camera.sensor.columns",
                 fmt::format("the sensor has {} x {} pixels; at most {:.0f} million are possible",
                             camera.sensor.columns, camera.sensor.rows, 1e-6 * kMostPixels));
  check_focus(camera, lens_is_sound, issues);
  if (issues.errors() != errors_before) return;
  // Some faults show only when the parts are put in their places, which are those of camera.focus.
  try {
    std::vector<std::string> warnings;
    const Camera solved(camera, &warnings);
    check_overlap(solved, issues);
    for (const std::string& warning : warnings) issues.warning("camera.focus", warning);
  } catch (const InputError& error) {
    issues.error("camera.focus", error.what());
  }
}

}  // namespace plenoflame
