#pragma once
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/camera/lens_distortion.h"
#include "plenoflame/camera/microlens_aperture.h"
#include "plenoflame/camera/microlens_lattice.h"
#include "plenoflame/camera/pupil_filters.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/optics/first_order.h"
#include "plenoflame/optics/lens_system.h"
#include "plenoflame/scene/camera_spec.h"
#include "plenoflame/scene/main_lens_spec.h"

namespace plenoflame {

/// The paraxial transform of a lens between its principal planes, with its stop: slope changes by
/// -height / focal_length, height stays. All z in the camera frame.
struct IdealLens {
  double rear_principal = 0;   ///< z of the principal plane on the sensor's side [m]
  double front_principal = 0;  ///< z of the one on the scene's side [m]
  double focal_length = 0;     ///< [m]
  /// A ray has height h and slope s at the rear principal plane (towards the scene). It meets the
  /// stop at stop_height * h + stop_slope * s, up to scale, and passes within stop_radius.
  double stop_height = 1;
  double stop_slope = 0;   ///< [m]
  double stop_radius = 0;  ///< [m]
};

/// One kind of microlens in its place.
struct Microlens {
  std::string name;
  FirstOrder first_order;
  double radius_front = 0, radius_back = 0;  ///< [m] > 0: convex
  double index = 1;
  double rear_principal = 0;   ///< z [m] camera frame
  double front_principal = 0;  ///< z [m]
  double sensor_distance = 0;  ///< B: rear principal plane to the sensor [m]
  /// a0 = 1 / (1/f - 1/B): where in front of the front principal plane objects are sharp on the
  /// sensor [m]; negative: behind it (Galilean). Perwass and Wietzke 2012.
  double sharp_distance = 0;
};

/// A camera, solved and ready to trace; immutable. Positions are in the camera frame: origin at the
/// front vertex of the main lens, +z towards the scene, x right, y down.
class Camera {
 public:
  /// Solves the focus and places every part. Non-fatal findings are appended to `warnings`.
  /// @throws InputError when the camera cannot exist (no light path, array inside the lens, ...)
  explicit Camera(const CameraSpec& spec, std::vector<std::string>* warnings = nullptr);

  const CameraSpec& spec() const { return spec_; }
  const RigidTransform& to_world() const { return to_world_; }
  /// Filters over parts of the stop.
  const PupilFilters& pupil_filters() const { return pupil_filters_; }
  bool has_array() const { return spec_.array.present; }
  bool ideal_lens() const { return spec_.lens.model == LensModel::ideal; }
  bool ideal_array() const { return spec_.array.model == LensModel::ideal; }
  const FirstOrder& lens_first_order() const { return lens_first_order_; }
  const LensSystem& lens() const { return lens_; }     ///< used by the real model
  const IdealLens& ideal() const { return ideal_; }    ///< used by the ideal model
  double rear_vertex() const { return rear_vertex_; }  ///< z of the main lens' last vertex [m]
  /// z of the exit pupil [m]; infinite for a lens that is telecentric on the sensor's side.
  double exit_pupil() const { return rear_vertex_ - lens_first_order_.exit_pupil; }
  const std::vector<Microlens>& microlenses() const { return microlenses_; }
  const MicrolensLattice& lattice() const { return lattice_; }
  const MicrolensAperture& aperture() const { return aperture_; }  ///< of every microlens
  /// Middle of a lens in its aim plane [m]: its centre in the lattice, turned with the array.
  Vec3 lens_place(LensIndex lens) const;
  /// Frames of the main lens and of the array in that of the camera: what decentre and tilts say.
  const RigidTransform& lens_pose() const { return lens_pose_; }
  const RigidTransform& array_pose() const { return array_pose_; }
  bool lens_moved() const { return lens_moved_; }
  /// Tells whether the main lens is rotationally symmetric about its axis.
  bool lens_is_round() const { return lens_is_round_; }
  bool array_tilted() const { return array_tilted_; }
  /// Tells whether microlenses at the same distance from the axis differ: a decentre, a tilt, focal
  /// jitter, or a main lens that is not round.
  bool misaligned() const {
    return lens_moved_ || array_tilted_ || !lens_is_round_ || spec_.array.focal_jitter != 0;
  }
  /// Distortion of the main lens, in its frame.
  const LensDistortion& distortion() const { return distortion_; }
  /// The same camera without distortion: light takes the same ways within it.
  Camera undistorted() const;
  /// The same camera without errors of mounting and making, with the round counterpart of its main
  /// lens (surface_shape.h). Rotation, offset, spacing and centre jitter stay.
  Camera aligned() const;
  /// The same camera with circles around its microlenses, which may overlap.
  Camera with_circles() const;
  /// The place where the light of the main lens meets the array at a right angle [m], camera x, y.
  /// It lies below the exit pupil: (0, 0) unless the main lens is moved.
  Vec2 foot() const { return foot_; }
  double array_front() const { return array_front_; }  ///< z of the front vertices [m]
  double array_back() const { return array_back_; }    ///< z of the rear vertices [m]
  double sensor() const { return sensor_; }            ///< z of the sensor [m]
  /// Rear vertex of the main lens to the front vertices of the array (or to the sensor) [m].
  double lens_distance() const { return lens_distance_; }

  /// Number of surfaces from the scene to the sensor: those of the main lens, then front and back
  /// of a microlens. An ideal lens counts as one surface.
  int surface_count() const;
  std::string surface_name(int surface) const;

  /// Plane at which rays from a sensor point are aimed. Real microlenses: the rear vertices. Ideal
  /// ones: the rear principal plane of the type. Without array: the plane of the main lens' rear
  /// vertex. With a tilted array each lens has a plane parallel to this one, through lens_place().
  double aim_plane(int type) const;

  struct Path {
    TraceStatus status;        ///< surface numbered from the scene
    Ray exit;                  ///< leaving the front of the camera when status is reached
    std::vector<Vec3> points;  ///< sensor point, one per surface that was met (two for an ideal
                               ///< lens with separated principal planes)
    double passed = 1;   ///< share of the light that its surfaces and the cover glass let through
    int pupil_part = 0;  ///< PupilFilters::part_at() where it crossed the stop
  };
  /// The ray from `sensor_point` [m, camera x, y] towards `aim` on the aim plane, through microlens
  /// `lens`. Without `lens`: there is no array, or the ray passes between its lenses. Exact, in
  /// double precision.
  Path trace(Vec2 sensor_point, std::optional<LensIndex> lens, Vec2 aim,
             bool with_points = false) const;

  /// Place in the plane of the stop, from its middle [m], of the ray from a sensor point through
  /// the middle of a microlens. Up to scale for an ideal main lens. None: the ray is blocked.
  std::optional<Vec2> at_stop(Vec2 sensor_point, LensIndex lens) const;
  /// The same of the ray towards `aim` on the aim plane [m, camera x, y].
  std::optional<Vec2> at_stop(Vec2 sensor_point, LensIndex lens, Vec2 aim) const;

  /// The end of a ray from the scene.
  struct Arrival {
    std::optional<LensIndex> lens;  ///< through which it went; none: no array, or between lenses
    Vec2 sensor_point;              ///< [m] camera x, y
    /// Solid angle times projected area of a thin beam around the ray, on the sensor over that in
    /// the scene. It is 1 for refraction and cos^4 / cos^4 of the angles with the axis for the
    /// paraxial transform. It changes the beam's flux, but not its radiance. The transmission of
    /// surfaces and cover glass is multiplied in.
    double etendue_ratio = 1;
    int pupil_part = 0;  ///< PupilFilters::part_at() where it crossed the stop
  };
  /// Traces a ray that comes from the scene to the plane of the sensor, in double precision: the
  /// reverse of trace(). The ray is in the camera frame and travels towards -z. Appends the
  /// arrivals through every microlens that lets the ray pass. There is one, or several for ideal
  /// types with different principal planes. Between microlenses the ray arrives where the array is
  /// clear.
  /// @param points gets the points where the ray met each surface, and the sensor point of its
  ///        first arrival. With status missed, the last point is meaningless
  /// @return why the ray ended if it does not arrive; surfaces are numbered from the scene
  TraceStatus trace_from_scene(const Ray& ray, std::vector<Arrival>& arrivals,
                               std::vector<Vec3>* points = nullptr) const;

  /// True if a straight line through the array's plane meets no microlens. @param ray camera frame
  bool passes_between(const Ray& ray) const;

  /// Sensor point of continuous upright image coordinates (pixel (0,0) has its centre at 0.5, 0.5).
  Vec2 sensor_point(double column, double row) const {
    const Vec2 p = spec_.sensor.pixel();
    return {(0.5 * spec_.sensor.columns - column) * p.x, (0.5 * spec_.sensor.rows - row) * p.y};
  }
  /// Continuous upright image coordinates of a sensor point: the inverse of sensor_point().
  Vec2 image_point(Vec2 sensor_point) const {
    const Vec2 p = spec_.sensor.pixel();
    return {0.5 * spec_.sensor.columns - sensor_point.x / p.x,
            0.5 * spec_.sensor.rows - sensor_point.y / p.y};
  }

 private:
  void place_distortion();
  Path trace_inside(Vec2 sensor_point, std::optional<LensIndex> lens, Vec2 aim,
                    bool with_points) const;
  void place_lens();
  void place_array();
  void mount();
  void solve_focus(std::vector<std::string>* warnings);
  TraceStatus trace_ideal(Ray& ray, std::vector<Vec3>* points, int& pupil_part) const;
  TraceStatus trace_surfaces(Ray& ray, bool to_scene, std::vector<Vec3>* points,
                             PassedLight* passed, int& pupil_part) const;
  PassedLight light_of_lens() const;
  double through_cover(Vec3 direction) const;
  TraceStatus trace_main_lens_inwards(Ray& ray, Arrival& arrival, std::vector<Vec3>* points) const;
  TraceStatus trace_aligned_lens_inwards(Ray& ray, Arrival& arrival,
                                         std::vector<Vec3>* points) const;
  TraceStatus pass_microlens(LensIndex lens, Ray ray, Arrival arrival,
                             std::vector<Arrival>& arrivals, std::vector<Vec3>* points) const;
  TraceStatus trace_main_lens(Ray& ray, std::vector<Vec3>* points, Path& path) const;
  const LensSystem& microlens_system(LensIndex lens, LensSystem& own) const;
  double microlens_power(LensIndex lens) const;
  TraceStatus pass_faces(LensIndex lens, bool to_scene, Ray& ray, std::vector<Vec3>* points,
                         double& passed) const;
  Ray to_array(const Ray& ray) const;
  Ray from_array(const Ray& ray) const;
  bool meet_microlenses(const Ray& ray, const Arrival& arrival, std::vector<Arrival>& arrivals,
                        TraceStatus& status, std::vector<Vec3>* points) const;

  CameraSpec spec_;
  RigidTransform to_world_;
  FirstOrder lens_first_order_;
  LensSystem lens_;
  IdealLens ideal_;
  double rear_vertex_ = 0, lens_distance_ = 0;
  double array_front_ = 0, array_back_ = 0, sensor_ = 0;
  std::vector<Microlens> microlenses_;
  std::vector<LensSystem> microlens_systems_;
  MicrolensLattice lattice_;
  MicrolensAperture aperture_;
  PupilFilters pupil_filters_;
  LensDistortion distortion_;
  RigidTransform lens_pose_, array_pose_;
  bool lens_moved_ = false, array_tilted_ = false, lens_is_round_ = true;
  Vec2 foot_;
};

/// Distance of the main lens' rear vertex from the plane of least RMS spot, by real rays [m]. The
/// object is the axial point at `object_distance` in front of the first vertex (may be infinite).
/// @throws InputError when no ray gets through.
double best_image_distance(const MainLensSpec& lens, double object_distance);

}  // namespace plenoflame
