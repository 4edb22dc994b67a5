/// Cameras of libpleno and COMPOTE: intrinsics.js, camera.js, params.js. Lengths are in
/// millimetres. Matrices are stored by columns. The origin is the thin main lens, and light travels
/// towards -z.
#include <algorithm>
#include <array>
#include <cmath>

#include "camera/import/found_camera.h"
#include "plenoflame/base/units.h"
#include "plenoflame/camera/microlens_lattice.h"

namespace plenoflame {
namespace {

using Json = nlohmann::json;
constexpr double kMillimetre = 1e-3;

const Json* member(const Json& object, std::initializer_list<const char*> path) {
  const Json* here = &object;
  for (const char* name : path) {
    if (!here->is_object() || !here->contains(name)) return nullptr;
    here = &(*here)[name];
  }
  return here;
}

std::string joined(std::initializer_list<const char*> path) {
  std::string text;
  for (const char* name : path) {
    if (!text.empty()) text.push_back('.');
    text.append(name);
  }
  return text;
}

class LibplenoReader {
 public:
  LibplenoReader(const CalibrationFile& file, FoundCamera& found)
      : file_(file), json_(read_json(file)), found_(found) {}

  void read() {
    sensor();
    lens();
    array();
    distortion();
  }

 private:
  double number(std::initializer_list<const char*> path) const {
    const Json* value = member(json_, path);
    if (!value) refuse_calibration(file_, "lacks " + joined(path));
    return json_number(file_, *value, joined(path));
  }
  double number_or(std::initializer_list<const char*> path, double otherwise) const {
    const Json* value = member(json_, path);
    return value ? json_number(file_, *value, joined(path)) : otherwise;
  }
  /// A vector, stored as a matrix of one column.
  std::vector<double> numbers(std::initializer_list<const char*> path, std::size_t count) const {
    const Json* value = member(json_, path);
    if (!value) return {};
    if (value->is_array() && value->size() == 1 && value->front().is_array())
      value = &value->front();
    if (!value->is_array() || value->size() < count)
      refuse_calibration(file_,
                         joined(path) + " has fewer than " + std::to_string(count) + " numbers");
    std::vector<double> result;
    for (const Json& item : *value) result.push_back(json_number(file_, item, joined(path)));
    return result;
  }
  RigidTransform pose(std::initializer_list<const char*> of) const {
    RigidTransform result;
    const Json* pose = member(json_, of);
    if (!pose || !pose->is_object()) return result;
    const std::string name = joined(of);
    if (const Json* rotation = member(*pose, {"rotation"})) {
      double values[3][3];
      for (std::size_t column = 0; column < 3; ++column)
        for (std::size_t row = 0; row < 3; ++row) {
          if (!rotation->is_array() || rotation->size() != 3 || !(*rotation)[column].is_array() ||
              (*rotation)[column].size() != 3)
            refuse_calibration(file_, name + ".rotation is no matrix of 3 x 3 numbers");
          values[row][column] = json_number(file_, (*rotation)[column][row], name + ".rotation");
        }
      for (std::size_t row = 0; row < 3; ++row)
        result.rotation.rows[row] = {values[row][0], values[row][1], values[row][2]};
      const Mat3 product = result.rotation * transpose(result.rotation);
      constexpr double kSkew = 1e-3;
      if (std::fabs(product.rows[0].x - 1) > kSkew || std::fabs(product.rows[1].y - 1) > kSkew ||
          std::fabs(product.rows[2].z - 1) > kSkew || std::fabs(product.rows[0].y) > kSkew ||
          std::fabs(product.rows[0].z) > kSkew || std::fabs(product.rows[1].z) > kSkew)
        refuse_calibration(file_, name + ".rotation is no rotation");
    }
    if (const Json* place = member(*pose, {"translation"})) {
      const Json* list = place->is_array() && place->size() == 1 ? &place->front() : place;
      if (!list->is_array() || list->size() != 3)
        refuse_calibration(file_, name + ".translation has not three numbers");
      std::array<double, 3> t{};
      for (std::size_t i = 0; i < 3; ++i)
        t[i] = kMillimetre * json_number(file_, (*list)[i], name + ".translation");
      result.translation = {t[0], t[1], t[2]};
    }
    return result;
  }

  /// The camera's axes are those of the sensor, about its middle; z still counts from the main
  /// lens.
  void sensor() {
    SensorSpec& s = found_.camera.sensor;
    const auto count = [&](const char* name) {
      const double value = number({"sensor", name});
      if (!(value >= 1 && value <= 65536) || value != std::floor(value))
        refuse_calibration(file_, std::string("sensor.") + name + " is no number of pixels");
      return static_cast<int>(value);
    };
    s.columns = count("width");
    s.rows = count("height");
    s.pixel_pitch = kMillimetre * number({"sensor", "scale"});
    if (!(s.pixel_pitch > 0)) refuse_calibration(file_, "sensor.scale is not above 0");
    const RigidTransform sensor = pose({"sensor", "pose"});
    // Pixels are numbered from the corner with the smallest x and y, which is the origin of the
    // pose.
    const Vec3 middle{0.5 * (s.columns - 1) * s.pixel_pitch, 0.5 * (s.rows - 1) * s.pixel_pitch, 0};
    to_camera_.rotation = transpose(sensor.rotation);
    to_camera_.translation = -(to_camera_.rotation * sensor.point(middle));
    const double lens_z = to_camera_.point(pose({"main_lens", "pose"}).translation).z;
    to_camera_.translation.z -= lens_z;
    sensor_z_ = -lens_z;
  }

  RigidTransform in_camera(const RigidTransform& pose) const {
    return {to_camera_.rotation * pose.rotation, to_camera_.point(pose.translation)};
  }

  void lens() {
    MainLensSpec& lens = found_.camera.lens;
    lens.focal_length = kMillimetre * number({"main_lens", "f"});
    lens.diameter = kMillimetre * number_or({"main_lens", "diameter"}, 0);
    const double f_number = number_or({"main_lens", "aperture"}, 0);
    if (!(lens.diameter > 0) && f_number > 0) lens.diameter = lens.focal_length / f_number;
    lens_pose_ = in_camera(pose({"main_lens", "pose"}));
    lens.decentre = {lens_pose_.translation.x, lens_pose_.translation.y};
    lens.tilt = tilt_of(lens_pose_.rotation);
  }

  /// Angles about x, then y, that turn the axis as `rotation` does.
  static Vec2 tilt_of(const Mat3& rotation) {
    const Vec3 axis{rotation.rows[0].z, rotation.rows[1].z, rotation.rows[2].z};
    return {-std::asin(std::clamp(axis.y, -1.0, 1.0)), std::atan2(axis.x, axis.z)};
  }

  void array() {
    ArraySpec& array = found_.camera.array;
    const auto geometry = static_cast<int>(number({"mla", "mesh", "geometry"}));
    if (geometry < 0 || geometry > 2)
      refuse_calibration(file_, "mla.mesh.geometry is none of 0, 1 and 2");
    const std::vector<double> pitch = numbers({"mla", "mesh", "pitch"}, 1);
    if (pitch.empty() || !(pitch[0] > 0)) refuse_calibration(file_, "lacks mla.mesh.pitch");
    const double across = pitch.size() > 1 ? pitch[1] : pitch[0];
    array.lattice = geometry == 0 ? Lattice::square : Lattice::hexagonal;
    array.pitch = kMillimetre * pitch[0];
    if (across != pitch[0]) {
      if (geometry == 0)
        array.pitch_y = kMillimetre * across;
      else
        found_.note(
            "the array's pitches along x and y differ, which a hexagonal one cannot have: "
            "their mean was taken");
      if (geometry != 0) array.pitch = kMillimetre * 0.5 * (pitch[0] + across);
    }
    const RigidTransform given = in_camera(pose({"mla", "mesh", "pose"}));
    array.tilt = tilt_of(given.rotation);
    const Mat3 turn = rotation_xyz({array.tilt.x, array.tilt.y, 0});
    const Mat3 spin = transpose(turn) * given.rotation;
    const double about = std::atan2(spin.rows[1].x, spin.rows[0].x);
    // Aligned columns are a lattice of aligned rows, turned by 90 degrees.
    array.rotation = about + (geometry == 2 ? 1.5707963267948966 : 0.0);
    // Node (0, 0) = (0, 0, front) + turn * (x, y, 0); the pivot is the front on the axis.
    const auto in_plane = [&](Vec3 point) {
      const double a = turn.rows[0].x, b = turn.rows[0].y, c = turn.rows[1].x, d = turn.rows[1].y;
      const double determinant = a * d - b * c;
      return Vec2{(d * point.x - b * point.y) / determinant,
                  (a * point.y - c * point.x) / determinant};
    };
    const Vec2 origin = in_plane(given.translation);
    const double front =
        given.translation.z - (turn.rows[2].x * origin.x + turn.rows[2].y * origin.y);
    found_.camera.focus.mode = FocusMode::distance;
    found_.camera.focus.lens_distance = -front;
    array.sensor_distance = front - sensor_z_;
    if (!(front < 0))
      refuse_calibration(file_, "the array does not stand behind the main lens (mla.mesh.pose)");
    if (!(array.sensor_distance > 0))
      refuse_calibration(file_, "the sensor does not stand behind the array (sensor.pose)");
    focal_lengths();
    place_lattice(geometry, origin, about);
    found_.placed = true;
  }

  void focal_lengths() {
    const double types = number_or({"I"}, 1);
    const std::vector<double> given = numbers({"mla", "focal_lengths"}, 0);
    const auto count = static_cast<std::size_t>(types < 1 ? 1 : types);
    if (given.size() < count && types >= 1)
      refuse_calibration(file_, "mla.focal_lengths has fewer numbers than there are types (I)");
    focal_ = std::vector<double>(
        given.begin(), given.begin() + static_cast<std::ptrdiff_t>(std::min(count, given.size())));
    if (focal_.size() > 3) refuse_calibration(file_, "more than three types of microlenses");
    for (double& f : focal_) f *= kMillimetre;
    if (types == 0)
      found_.note("the file takes microlenses for pinholes: give a focal length for each type");
  }

  /// The position of a node of the file's numbering relative to node (0, 0), in pitches along the
  /// array's axes. Even rows (or odd columns) are shifted by half a step.
  static Vec2 node(int geometry, int k, int l) {
    constexpr double kRow = 0.8660254037844386;
    if (geometry == 0) return {static_cast<double>(k), static_cast<double>(l)};
    if (geometry == 1) return {k + (l % 2 == 0 ? 0.5 : 0.0), kRow * l};
    return {kRow * k, l - (k % 2 == 0 ? 0.0 : 0.5)};
  }

  /// The lens nearest to the middle of the file's array becomes lens (0, 0).
  void place_lattice(int geometry, Vec2 origin, double about) {
    ArraySpec& array = found_.camera.array;
    const int columns = std::max(1, static_cast<int>(number_or({"mla", "mesh", "width"}, 1)));
    const int rows = std::max(1, static_cast<int>(number_or({"mla", "mesh", "height"}, 1)));
    const double c = std::cos(about), s = std::sin(about);
    const double step_y = array.pitch_y > 0 ? array.pitch_y : array.pitch;
    const auto place = [&](int k, int l) {
      const Vec2 n = node(geometry, k, l);
      const double x = array.pitch * n.x, y = step_y * n.y;
      return origin + Vec2{c * x - s * y, s * x + c * y};
    };
    const int k0 = columns / 2, l0 = rows / 2;
    array.offset = place(k0, l0);
    array.types.resize(std::max<std::size_t>(1, focal_.size()));
    if (focal_.size() == 1) array.types[0].focal_length = focal_[0];
    if (focal_.size() == 2)
      refuse_calibration(file_, "two types of microlenses, which libpleno itself does not know");
    if (focal_.size() == 3) give_types(geometry, k0, l0, columns, rows, place);
    check_extent(columns, rows, place);
  }

  /// Numbers of micro-images start at the corner opposite to that of their microlenses.
  template <class Place>
  void give_types(int geometry, int k0, int l0, int columns, int rows, const Place& place) {
    ArraySpec& array = found_.camera.array;
    if (geometry == 0) refuse_calibration(file_, "three types of microlenses in a square array");
    const MicrolensLattice lattice(array);
    for (int l = l0 - 1; l <= l0; ++l)
      for (int k = k0 - 1; k <= k0 + 1; ++k) {
        const int image_k = columns - 1 - k, image_l = rows - 1 - l;
        if (k < 0 || l < 0 || image_k < 0 || image_l < 0) continue;
        const int theirs =
            geometry == 1 ? (image_l % 2 + image_k) % 3 : (image_k % 2 + image_l) % 3;
        const auto ours = static_cast<std::size_t>(lattice.type(lattice.nearest(place(k, l))));
        array.types[ours].focal_length = focal_[static_cast<std::size_t>(theirs)];
      }
    if (geometry == 1 && rows % 2 != 0)
      found_.note(
          "the array has an odd number of rows, and its numbering does not fit that of the "
          "micro-images: which type a lens has may be wrong");
  }

  template <class Place>
  void check_extent(int columns, int rows, const Place& place) {
    const SensorSpec& sensor = found_.camera.sensor;
    const double margin = 1.5 * found_.camera.array.pitch;
    const Vec2 half = 0.5 * sensor.size();
    const Vec2 low = place(0, 0), high = place(columns - 1, rows - 1);
    if (low.x > margin - half.x || low.y > margin - half.y || high.x < half.x - margin ||
        high.y < half.y - margin)
      found_.note("the file's array (" + std::to_string(columns) + " x " + std::to_string(rows) +
                  " microlenses) does not cover the sensor; the camera's has no end: give "
                  "camera.array.columns and rows");
  }

  /// The file displaces image points, in mm, for every depth. The scene's map applies to one plane.
  /// This plane is at the given distance, at dist_focus, or at the distance that is sharp on the
  /// array.
  void distortion() {
    const auto is_given = [](const std::vector<double>& values) {
      return std::any_of(values.begin(), values.end(), [](double value) { return value != 0; });
    };
    const std::vector<double> radial = numbers({"distortions", "radial"}, 3),
                              tangential = numbers({"distortions", "tangential"}, 2);
    if (is_given(radial) || is_given(tangential)) {
      MainLensSpec& lens = found_.camera.lens;
      const double f = lens.focal_length;
      const double given = std::isfinite(lens.distortion.distance)
                               ? lens.distortion.distance
                               : kMillimetre * number_or({"dist_focus"}, 0);
      if (std::isfinite(lens.distortion.distance) && !(given > f))
        refuse_calibration(file_,
                           "camera.lens.distortion.distance is within the focal length, where its "
                           "distortion of images has no meaning");
      const double behind = found_.camera.focus.lens_distance;
      double image = f;
      if (given > f) {
        image = 1 / (1 / f - 1 / given);
        lens.distortion.distance = given;
      } else if (behind > f) {
        image = behind;
        lens.distortion.distance = 1 / (1 / f - 1 / behind);
      }
      // An image point lies at -image * (direction of the object).
      const double a = image / kMillimetre;
      if (!radial.empty()) {
        lens.distortion.k1 = radial[0] * a * a;
        lens.distortion.k2 = radial[1] * a * a * a * a;
        lens.distortion.k3 = radial[2] * a * a * a * a * a * a;
      }
      if (!tangential.empty()) {
        lens.distortion.p1 = -a * tangential[1];
        lens.distortion.p2 = -a * tangential[0];
      }
      found_.note("the distortion of the main lens is exact for objects at " +
                  readable_quantity(lens.distortion.distance, Dimension::length) +
                  "; libpleno moves images of all depths by the same lengths. Where boards or "
                  "flames stand elsewhere, give camera.lens.distortion.distance");
    }
    if (is_given(numbers({"distortions", "depth"}, 0)))
      found_.note(
          "distortions.depth moves images along the axis, which the scene has no key for: "
          "left out");
  }

  const CalibrationFile& file_;
  Json json_;
  FoundCamera& found_;
  RigidTransform to_camera_, lens_pose_;
  double sensor_z_ = 0;
  std::vector<double> focal_;
};

bool has_key(const CalibrationFile& file, const char* key) {
  std::string quoted = "\"";
  quoted.append(key).append("\"");
  return file.text.find(quoted) != std::string::npos;
}

}  // namespace

bool is_libpleno(const CalibrationFile& file) {
  return has_key(file, "main_lens") && has_key(file, "mla");
}

void read_libpleno(const CalibrationFile& file, FoundCamera& found) {
  if (found.placed)
    refuse_calibration(file, "another file before it has described the whole camera already");
  LibplenoReader(file, found).read();
}

bool is_libpleno_parameters(const CalibrationFile& file) {
  return has_key(file, "q_prime") && has_key(file, "dC");
}

/// Reads micro-image parameters: what they add to intrinsics.js about the camera.
void read_libpleno_parameters(const CalibrationFile& file, FoundCamera& found) {
  const Json json = read_json(file);
  const auto number = [&](const char* key) {
    return json.is_object() && json.contains(key) ? json_number(file, json[key], key) : 0.0;
  };
  set_new(found.camera.sensor.pixel_pitch, kMillimetre * number("scale"));
  const double f_number = number("N"), m = number("m");
  if (found.camera.lens.focal_length > 0 && f_number > 0)
    set_new(found.camera.lens.diameter, found.camera.lens.focal_length / f_number);
  set_new(found.camera.array.pitch, kMillimetre * number("dC"));
  // m = B f / (2 D): half the diameter of the stop's image at f-number 1.
  const CameraSpec& c = found.camera;
  if (m != 0 && c.array.sensor_distance > 0 && c.focus.lens_distance > 0 &&
      c.lens.focal_length > 0) {
    const double traced =
        0.5 * c.array.sensor_distance * c.lens.focal_length / c.focus.lens_distance / kMillimetre;
    const double percent = 100 * (traced / std::fabs(m) - 1);
    char text[160];
    std::snprintf(text, sizeof text,
                  "micro-images of the camera grow with the aperture by %+.1f %% against params.js",
                  percent);
    found.note(text);
  }
}

}  // namespace plenoflame
