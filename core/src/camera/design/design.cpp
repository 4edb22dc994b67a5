#include "plenoflame/camera/design.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/camera/resolution.h"

namespace plenoflame {
namespace {

constexpr int kSpotSpokes = 24;

std::string digits(double value, int count = 3) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", count, value);
  return text;
}

/// Length of a union of intervals.
double union_length(std::vector<std::pair<double, double>> intervals) {
  std::sort(intervals.begin(), intervals.end());
  double sum = 0, end = -kInfinity;
  for (const auto& [low, high] : intervals) {
    sum += std::max(0.0, high - std::max(low, end));
    end = std::max(end, high);
  }
  return sum;
}

TypeDesign type_design(const Camera& camera, const Microlens& lens, double pixel) {
  const FirstOrder& main = camera.lens_first_order();
  const double diameter = camera.spec().array.diameter;
  TypeDesign type;
  type.name = lens.name;
  type.focal_length = lens.first_order.focal_length;
  type.sensor_distance = lens.sensor_distance;
  type.f_number = type.sensor_distance / diameter;
  // The angle of the exit pupil, seen from the front principal plane.
  const double pupil_slope =
      std::isfinite(main.exit_pupil)
          ? main.exit_pupil_diameter / (camera.exit_pupil() - lens.front_principal)
          : main.entrance_pupil_diameter / main.focal_length;
  type.image_diameter = type.sensor_distance * std::fabs(pupil_slope);
  type.keplerian = type.focal_length < type.sensor_distance;
  type.array = depth_of_field(type.focal_length, type.sensor_distance, diameter, pixel);
  type.virtual_depth = type.array.focus / type.sensor_distance;
  type.dioptric_width = 2 * pixel / (diameter * type.sensor_distance);
  const auto object = [&](double a) {
    return paraxial_object_distance(main, camera.rear_vertex() - (lens.front_principal + a));
  };
  type.object = {object(type.array.near), object(type.array.focus), object(type.array.far)};
  // Distance of the array from the image of an infinitely far object, in dioptres like the range.
  const double infinite =
      1 / (camera.rear_vertex() - lens.front_principal - main.back_focal_distance);
  type.object_through_infinity = 1 / type.array.far < infinite && infinite < 1 / type.array.near;
  const double magnification = paraxial_magnification(main, type.object.focus);
  type.disparity_rate = camera.spec().array.pitch * type.sensor_distance / pixel *
                        std::pow(magnification / type.array.focus, 2);
  return type;
}

/// Ratio of the distance of neighbouring micro-images to that of their lenses.
double sensor_scale(const Camera& camera) {
  const double pupil = camera.exit_pupil();
  return std::isfinite(pupil) ? (pupil - camera.sensor()) / (pupil - camera.array_back()) : 1;
}

LatticeDesign count_lenses(const Camera& camera, Lattice lattice, double image_diameter) {
  ArraySpec array = camera.spec().array;
  array.lattice = lattice;
  array.pitch *= sensor_scale(camera);
  array.pitch_y *= sensor_scale(camera);
  const SensorSpec& sensor = camera.spec().sensor;
  const double diameter = std::min(image_diameter, array.pitch);
  const auto [width, height] = sensor.size();
  const Vec2 reach{0.5 * (width - diameter), 0.5 * (height - diameter)};
  LatticeDesign result;
  if (!(reach.x >= 0) || !(reach.y >= 0)) return result;
  result.lenses =
      static_cast<int>(MicrolensLattice(array).within({-reach.x, -reach.y}, reach).size());
  result.used_share = result.lenses * 0.25 * constants::pi * diameter * diameter / (width * height);
  return result;
}

ViewDesign view_design(const Camera& camera, const CameraDesign& d) {
  const ArraySpec& array = camera.spec().array;
  const SensorSpec& sensor = camera.spec().sensor;
  ViewDesign views;
  views.across = d.types.front().image_diameter / sensor.pixel_pitch;
  views.count =
      0.25 * constants::pi * views.across * (d.types.front().image_diameter / sensor.pixel().y);
  const double pitch = array.pitch * sensor_scale(camera);
  const double row = array.lattice == Lattice::hexagonal ? std::sqrt(0.75) * pitch
                     : is_regular(array)                 ? pitch
                                                         : array.pitch_y * sensor_scale(camera);
  views.columns = sensor.size().x / pitch;
  views.rows = sensor.size().y / row;
  const FirstOrder& lens = d.lens;
  const double magnification = std::fabs(paraxial_magnification(lens, d.object_distance));
  const double image = paraxial_image_distance(lens, d.object_distance);
  // Distance from the exit pupil, or in units of it when it is infinitely far.
  const bool telecentric = !std::isfinite(lens.exit_pupil);
  const double to_image = image - lens.exit_pupil;
  const double to_array = camera.lens_distance() - lens.exit_pupil;
  const double step = telecentric ? array.pitch : array.pitch * to_image / to_array;
  const double cone = telecentric ? lens.entrance_pupil_diameter / lens.focal_length
                                  : lens.exit_pupil_diameter / to_image;
  views.object_pixel = step / magnification;
  views.disparity_rate = cone * magnification * magnification / step;
  return views;
}

/// Notes the types that are less sharp for real rays than they should be, and the cause.
void compare_blur(const Camera& camera, double pixel, CameraDesign& design) {
  for (std::size_t k = 0; k < design.types.size(); ++k) {
    const TypeDesign& type = design.types[k];
    const double distance = type.object.focus;
    if (!(distance > 0) || !std::isfinite(distance)) continue;
    const TracedBlur blur = BlurTracer(camera, k)(distance);
    if (!(blur.all > 1.5 * pixel)) continue;
    const bool microlens = blur.central > 0.7 * blur.all;
    design.warnings.push_back("type \"" + type.name + "\" should be sharp to a pixel at " +
                              format_quantity(std::stod(digits(distance, 6)), Dimension::length) +
                              ", but real rays blur " + digits(blur.all / pixel) +
                              " pixels there (" + digits(blur.central / pixel) +
                              " in the microlens on the axis): " +
                              (microlens ? "aberrations of the microlens itself"
                                         : "other zones of the main lens focus elsewhere"));
  }
}

void compare_with_rays(const Camera& camera, double pixel, CameraDesign& design) {
  compare_blur(camera, pixel, design);
  if (camera.ideal_lens()) return;
  const SensorSpec& sensor = camera.spec().sensor;
  const double corner = sensor.corner();
  for (const double field : {0.0, 0.5, 1.0}) {
    try {
      design.spots.push_back(
          best_spot(camera.spec().lens.surfaces, design.object_distance, field * corner));
    } catch (const InputError&) {
      design.warnings.push_back("no ray of the point imaged " +
                                readable_quantity(field * corner, Dimension::length) +
                                " from the axis gets through the main lens");
    }
  }
  if (design.spots.empty()) return;
  const double rms = design.spots.front().rms;
  const std::string blur = "aberrations of the main lens: the RMS radius on the axis is " +
                           digits(1e3 * rms) + " mm at best focus, ";
  const TypeDesign* worst = nullptr;
  double worst_blur = 1;
  for (const TypeDesign& type : design.types) {
    const double pixels = rms * std::fabs(1 / type.virtual_depth) / pixel;
    if (pixels > worst_blur) worst = &type, worst_blur = pixels;
  }
  if (worst)
    design.warnings.push_back(blur + digits(worst_blur) + " pixels behind microlenses of type \"" +
                              worst->name +
                              "\", more than the pixel by which the types differ: the "
                              "differences between the types cannot be seen");
  else if (design.types.empty() && rms > pixel)
    design.warnings.push_back(blur + digits(rms / pixel) + " pixels");
}

}  // namespace

bool passes_infinity(double near, double far) {
  return near > 0 && std::isfinite(near) && far < 0;
}

SharpRange depth_of_field(double f, double b, double diameter, double pixel) {
  const auto at = [&](double share) { return 1.0 / (1.0 / f - share / b); };
  return {at(1 - pixel / diameter), at(1), at(1 + pixel / diameter)};
}

double paraxial_object_distance(const FirstOrder& lens, double image_distance) {
  // Newton's equation: the product of the distances from the focal points is f^2.
  const double beyond = image_distance - lens.back_focal_distance;
  return -lens.front_focal_distance + lens.focal_length * lens.focal_length / beyond;
}

SpotDesign best_spot(const std::vector<SurfaceSpec>& surfaces, double object_distance,
                     double image_height, int rings) {
  const FirstOrder lens = first_order(surfaces);
  const LensSystem system(surfaces);
  const double last = system.vertices().back();
  const double paraxial = paraxial_image_distance(lens, object_distance);
  const bool infinite = std::isinf(object_distance);
  // The paraxial entrance pupil is at z = -entrance_pupil. Real pupils differ, so rays are aimed
  // wider.
  const double pupil_z = -lens.entrance_pupil, pupil = 0.65 * lens.entrance_pupil_diameter;
  const double start_z = infinite ? std::max(0.0, pupil_z) + lens.focal_length : object_distance;
  const double object_height =
      infinite ? 0 : image_height / paraxial_magnification(lens, object_distance);
  const double slope = infinite ? image_height / lens.focal_length : 0;  // dx/dz of the light
  // Sums of positions at the last vertex and of slopes, for the line of centroids and the scatter.
  double n = 0, x = 0, u = 0, w = 0, xx = 0, xu = 0, uu = 0, yy = 0, yw = 0, ww = 0, y = 0;
  for (int ring = 0; ring < rings; ++ring)
    for (int spoke = 0; spoke < kSpotSpokes; ++spoke) {
      const double r = pupil * std::sqrt((ring + 0.5) / rings);  // equal areas
      const double angle = 6.283185307179586 * (spoke + 0.5 * (ring % 2)) / kSpotSpokes;
      const Vec3 target{r * std::cos(angle), r * std::sin(angle), pupil_z};
      // Light that is imaged at +x travels towards +x, i.e. x increases as z decreases.
      const Vec3 direction = infinite ? normalize({slope, 0, -1})
                                      : normalize(target - Vec3{object_height, 0, start_z});
      if (direction.z >= 0) continue;
      Ray ray{target + ((start_z - pupil_z) / direction.z) * direction, direction};
      if (system.trace_to_sensor(ray).status != RayStatus::reached) continue;
      const double sx = -ray.direction.x / ray.direction.z, sy = -ray.direction.y / ray.direction.z;
      const double px = ray.origin.x + sx * (ray.origin.z - last);
      const double py = ray.origin.y + sy * (ray.origin.z - last);
      n += 1, x += px, y += py, u += sx, w += sy;
      xx += px * px, yy += py * py, xu += px * sx, yw += py * sy, uu += sx * sx, ww += sy * sy;
    }
  const double position = xx + yy - (x * x + y * y) / n, mixed = xu + yw - (x * u + y * w) / n;
  const double spread = uu + ww - (u * u + w * w) / n;
  if (!(n > 0) || !(spread > 0))
    throw InputError("no ray from the object point gets through camera.lens");
  const double plane = -mixed / spread;
  return {image_height, std::sqrt(std::max(0.0, position - mixed * mixed / spread) / n),
          paraxial - plane};
}

std::vector<TypeDesign> design_types(const Camera& camera) {
  std::vector<TypeDesign> types;
  for (const Microlens& microlens : camera.microlenses())
    types.push_back(type_design(camera, microlens, camera.spec().sensor.pixel_pitch));
  return types;
}

CameraDesign first_order_design(const Camera& camera) {
  CameraDesign design;
  const FirstOrder& lens = design.lens = camera.lens_first_order();
  const double pixel = camera.spec().sensor.pixel_pitch;
  const ArraySpec& array = camera.spec().array;
  design.array_f_number =
      std::isfinite(lens.exit_pupil)
          ? (camera.exit_pupil() - camera.array_front()) / lens.exit_pupil_diameter
          : lens.focal_length / lens.entrance_pupil_diameter;
  design.object_distance = camera.spec().focus.object_distance;
  if (camera.spec().focus.mode == FocusMode::distance)
    design.object_distance = paraxial_object_distance(lens, camera.lens_distance());
  if (!(design.object_distance > 0)) design.object_distance = kInfinity;
  design.types = design_types(camera);
  if (!design.types.empty()) {
    std::vector<std::pair<double, double>> ranges;
    for (const TypeDesign& type : design.types) {
      // The range from a0+ to a0- in dioptres, in which infinity is an ordinary value.
      const double low = 1 / type.array.far;
      ranges.emplace_back(low, low + type.dioptric_width);
      const double overlap = (type.image_diameter - array.pitch) / pixel;
      if (std::fabs(overlap) > 0.05 * array.pitch / pixel)
        design.warnings.push_back("f-numbers do not match for type \"" + type.name +
                                  "\": micro-images are " + digits(std::fabs(overlap)) +
                                  (overlap > 0 ? " pixels wider" : " pixels narrower") +
                                  " than the pitch");
    }
    design.joint_ratio = union_length(ranges) / design.types.front().dioptric_width;
    const bool hexagonal = array.lattice == Lattice::hexagonal;
    design.covering_depth = design.types.size() == 3 && hexagonal ? 2
                            : design.types.size() > 1             ? 0
                            : hexagonal                           ? 2 / std::sqrt(3.0)
                                                                  : std::sqrt(2.0);
    design.hexagonal =
        count_lenses(camera, Lattice::hexagonal, design.types.front().image_diameter);
    design.square = count_lenses(camera, Lattice::square, design.types.front().image_diameter);
    design.views = view_design(camera, design);
  }
  return design;
}

CameraDesign design(const Camera& camera) {
  CameraDesign result = first_order_design(camera);
  compare_with_rays(camera, camera.spec().sensor.pixel_pitch, result);
  return result;
}

}  // namespace plenoflame
