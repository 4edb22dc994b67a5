#pragma once
#include <string>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/scene/array_spec.h"
#include "plenoflame/scene/main_lens_spec.h"
#include "plenoflame/scene/pupil_filter_spec.h"
#include "plenoflame/scene/sensor_spec.h"

/// A camera as plain values (scene.h).
namespace plenoflame {

/// Ways to find the distance between main lens and array (or sensor).
enum class FocusMode {
  distance,  ///< given by lens_distance
  paraxial,  ///< object_distance is imaged paraxially on the conjugate plane
  best,      ///< least RMS spot of real rays from the axial point at object_distance
};

struct FocusSpec {
  FocusMode mode = FocusMode::paraxial;
  double lens_distance = 0;    ///< [m] mode distance: rear vertex of the main lens to the front
                               ///< vertices of the microlenses, or to the sensor without array
  double object_distance = 0;  ///< [m] from the front vertex of the main lens
  /// The plane conjugate to the object. "array" (plenoptic 1.0): the front principal plane of the
  /// first type. The name of a microlens type (2.0): the plane on which that type is sharp.
  /// "sensor": only without array.
  std::string conjugate = "array";
  friend bool operator==(const FocusSpec&, const FocusSpec&) = default;
};

/// Losses of light on its way through the camera.
struct TransmissionSpec {
  bool fresnel = false;  ///< reflection at every real surface
  /// A single layer of this index on the main lens' surfaces that border on air, a quarter of the
  /// wavelength thick; 0: uncoated.
  double coating_index = 0;
  double coating_wavelength = 550e-9;  ///< [m]
  double cover_index = 1;              ///< of the sensor's cover glass, a plane plate; 1: none
  std::string filter = {};             ///< "400 nm 0.9, 700 nm 0.8"; empty: none
  friend bool operator==(const TransmissionSpec&, const TransmissionSpec&) = default;
};

struct CameraSpec {
  std::string name = {};         ///< of one of several; also for messages
  Vec3 position;                 ///< [m] world, of the front vertex of the main lens
  Vec3 look_direction{1, 0, 0};  ///< world
  Vec3 up{0, 0, 1};              ///< world; camera y (down) is the part of -up across the axis
  MainLensSpec lens;
  ArraySpec array;
  SensorSpec sensor;
  FocusSpec focus;
  TransmissionSpec transmission = {};
  std::vector<PupilFilterSpec> pupil_filters = {};  ///< no two of which overlap
  /// [m] of the light that it is traced for, where that matters: the coating. 0: the coating's. Not
  /// in files; compile() sets it.
  double wavelength = 0;
  friend bool operator==(const CameraSpec&, const CameraSpec&) = default;
};

}  // namespace plenoflame
