#include "calibration/free_values.h"

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

double pitch_of(const CameraSpec& camera) {
  return camera.array.pitch;
}
double unity(const CameraSpec&) {
  return 1;
}
double plane_of(const CameraSpec& camera) {
  return camera.lens.distortion.distance;
}
/// Tangent of the angle at which the sensor's corner is seen, to a power: terms of distortion
/// change directions by it.
template <int kPower>
double per_field(const CameraSpec& camera) {
  return std::pow(camera.focus.lens_distance / camera.sensor.corner(), kPower);
}

const FreeValue kFreeValues[]{
    {"camera.lens.focal_length", [](CameraSpec& c) -> double& { return c.lens.focal_length; }, 1e-5,
     pitch_of, ValueGroup::optics},
    {"camera.focus.lens_distance", [](CameraSpec& c) -> double& { return c.focus.lens_distance; },
     1e-5, pitch_of, ValueGroup::optics},
    {"camera.array.sensor_distance",
     [](CameraSpec& c) -> double& { return c.array.sensor_distance; }, 1e-5, pitch_of,
     ValueGroup::optics},
    {"camera.lens.decentre[0]", [](CameraSpec& c) -> double& { return c.lens.decentre.x; }, 1e-4,
     pitch_of, ValueGroup::optics},
    {"camera.lens.decentre[1]", [](CameraSpec& c) -> double& { return c.lens.decentre.y; }, 1e-4,
     pitch_of, ValueGroup::optics},
    {"camera.array.offset[0]", [](CameraSpec& c) -> double& { return c.array.offset.x; }, 1e-4,
     pitch_of, ValueGroup::array},
    {"camera.array.offset[1]", [](CameraSpec& c) -> double& { return c.array.offset.y; }, 1e-4,
     pitch_of, ValueGroup::array},
    {"camera.array.pitch", [](CameraSpec& c) -> double& { return c.array.pitch; }, 1e-7, pitch_of,
     ValueGroup::array},
    {"camera.array.rotation", [](CameraSpec& c) -> double& { return c.array.rotation; }, 1e-7,
     unity, ValueGroup::array},
    {"camera.array.tilt[0]", [](CameraSpec& c) -> double& { return c.array.tilt.x; }, 1e-6, unity,
     ValueGroup::array},
    {"camera.array.tilt[1]", [](CameraSpec& c) -> double& { return c.array.tilt.y; }, 1e-6, unity,
     ValueGroup::array},
    {"camera.lens.distortion.k1", [](CameraSpec& c) -> double& { return c.lens.distortion.k1; },
     1e-4, per_field<2>, ValueGroup::distortion},
    {"camera.lens.distortion.k2", [](CameraSpec& c) -> double& { return c.lens.distortion.k2; },
     1e-4, per_field<4>, ValueGroup::distortion},
    {"camera.lens.distortion.k3", [](CameraSpec& c) -> double& { return c.lens.distortion.k3; },
     1e-4, per_field<6>, ValueGroup::distortion},
    {"camera.lens.distortion.p1", [](CameraSpec& c) -> double& { return c.lens.distortion.p1; },
     1e-4, per_field<1>, ValueGroup::distortion},
    {"camera.lens.distortion.p2", [](CameraSpec& c) -> double& { return c.lens.distortion.p2; },
     1e-4, per_field<1>, ValueGroup::distortion},
    {"camera.lens.distortion.distance",
     [](CameraSpec& c) -> double& { return c.lens.distortion.distance; }, 1e-5, plane_of,
     ValueGroup::distortion},
};

template <std::size_t kType>
double& focal_length_of(CameraSpec& camera) {
  return camera.array.types[kType].focal_length;
}
template <std::size_t kType>
double scale_of_type(const CameraSpec& camera) {
  return camera.array.types[kType].focal_length;
}

const FreeValue kMicrolenses[]{
    {"camera.array.types[0].focal_length", focal_length_of<0>, 1e-6, scale_of_type<0>,
     ValueGroup::microlens},
    {"camera.array.types[1].focal_length", focal_length_of<1>, 1e-6, scale_of_type<1>,
     ValueGroup::microlens},
    {"camera.array.types[2].focal_length", focal_length_of<2>, 1e-6, scale_of_type<2>,
     ValueGroup::microlens},
};

/// The values that are fitted by default.
std::vector<const FreeValue*> usual_values(bool with_centres) {
  std::vector<const FreeValue*> values;
  for (const FreeValue& value : kFreeValues)
    if (value.group == ValueGroup::optics || (value.group == ValueGroup::array && with_centres))
      values.push_back(&value);
  return values;
}

}  // namespace

const FreeValue* microlens_value(std::size_t type) {
  return &kMicrolenses[type];
}

bool is_plane(const FreeValue* value) {
  return value->scale == plane_of;
}

std::vector<const FreeValue*> chosen_values(const GeometrySettings& settings, bool with_centres) {
  if (settings.free.empty()) return usual_values(with_centres);
  std::vector<const FreeValue*> values;
  const auto add = [&](const FreeValue* value) {
    if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
  };
  for (const std::string& name : settings.free) {
    if (name == kUsualValues) {
      for (const FreeValue* value : usual_values(with_centres)) add(value);
      continue;
    }
    bool known = false;
    for (const FreeValue& value : kFreeValues) {
      // "camera.lens.decentre" means both of its numbers, "camera.lens.distortion" all terms.
      const std::string key = value.key;
      if (key != name && !key.starts_with(name + "[") && !key.starts_with(name + ".")) continue;
      known = true;
      add(&value);
    }
    if (!known) {
      std::string names = kUsualValues;
      for (const FreeValue& value : kFreeValues) names.append(", ").append(value.key);
      throw InputError("'" + name + "' cannot be searched for; these can: " + names);
    }
  }
  return values;
}

std::vector<std::string> calibrated_keys() {
  std::vector<std::string> keys;
  for (const FreeValue& value : kFreeValues) keys.emplace_back(value.key);
  return keys;
}

}  // namespace plenoflame
