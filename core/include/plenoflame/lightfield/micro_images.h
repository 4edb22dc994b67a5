#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/base/isa.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/optics/window_set.h"

namespace plenoflame {

/// Makes sure that a light field can be a raw image of this camera, usually that of its scene text.
/// @param what names the light field in messages
/// @throws InputError: it is something derived from a raw image, its sensor is another one, or the
///         camera has no microlens array
void check_raw_image(const LightField& light_field, const CameraSpec& camera,
                     const std::string& what = "the light field");

/// The place of every micro-image on the sensor, the chief ray of each of its points, and the white
/// light there. Values are traced with the exact optics at some distances from the axis and
/// interpolated between. Nothing is rounded to whole pixels. Sensor points are camera x, y [m].
class MicroImages {
 public:
  /// @param white whether white() will be called: costs most of the time
  /// @throws InputError without array, or when no light gets through
  explicit MicroImages(const Camera& camera, bool white = true, const Execution& execution = {});

  /// From now on planes and chief rays are those that the camera sees through these windows: each
  /// ray is refracted by them on its way. Places on the sensor and white light stay as they are.
  /// @param windows of the scene, with their indices set
  void look_through(const std::vector<WindowSpec>& windows);

  const Camera& camera() const { return camera_; }
  /// Least distance between the centres of neighbouring micro-images near the axis [m].
  double spacing() const { return spacing_; }

  /// One micro-image.
  struct Place {
    bool dark = true;     ///< no light gets here
    Vec2 centre;          ///< [m] where the ray through the middles of microlens and stop arrives
    double radius = 0;    ///< [m] of the stop's image
    Vec2 outwards{1, 0};  ///< unit vector away from the optical axis: first axis of the tables
    double node = 0;      ///< place in the tables
    int type = 0;
    LensIndex lens;
  };
  Place place(LensIndex lens) const;

  /// A straight line in object space: (x, y) = position + z * slope, camera frame.
  struct Line {
    Vec2 position;  ///< [m] at the front vertex, z = 0
    Vec2 slope;
  };
  /// The ray that arrives at `sensor_point` through the middle of the microlens. Exact within the
  /// fit's error for points in the disc of place.radius. Seen through windows it is the stretch of
  /// its way that crosses the plane in focus.
  Line chief_ray(const Place& place, Vec2 sensor_point) const;

  /// chief_ray's intersection with the plane z = depth, prepared for many points of one
  /// micro-image.
  class ToPlane {
   public:
    Vec2 operator()(Vec2 sensor_point) const;

   private:
    friend class MicroImages;
    Ray ray_at(Vec2 sensor_point) const;
    Place place_;
    std::array<double, 21> x_{}, y_{};
    // With windows, or a main lens that is decentred, tilted or distorts: its lines at z = 0 and 1
    // of its own frame.
    double depth_ = 0;
    LensDistortion distortion_;
    RigidTransform pose_, to_world_;
    std::shared_ptr<const WindowSet> windows_;
    std::vector<ToPlane> second_;  ///< one, or none
  };
  ToPlane to_plane(const Place& place, double depth) const;

  /// Etendue [m^2 sr] of the pixel centred at a sensor point, through this microlens alone. It is
  /// the pixel's flux [W] in a scene of radiance 1 W/(m^2 sr).
  double white(const Place& place, Vec2 sensor_point) const;

  /// The light of a pixel from a uniform scene of radiance 1 W/(m^2 sr), in its parts [W].
  struct White {
    double own = 0;    ///< through one microlens
    double total = 0;  ///< through all of them: what the sensor records
  };

  /// The pixels whose centres lie in a disc around the middle of a micro-image, row by row, and
  /// their white light. To be used again for the next micro-image: memory is kept.
  struct Pixels {
    struct Row {
      int row = 0, column = 0;  ///< on the sensor; of the first pixel
      std::size_t begin = 0, count = 0;
    };
    std::vector<Row> rows;
    std::vector<float> x, y;        ///< [pixel] from the middle, upright: to the right, down
    std::vector<float> own, total;  ///< as in White; LocalWhite::fill
    /// @param middle [m] sensor point; @param radius [m]; pixels outside of the window are left out
    void set(const SensorSpec& sensor, const PixelWindow& window, Vec2 middle, double radius);

   private:
    friend class MicroImages;
    Vec2 pitch;
    Vec2 centre;
    struct Some {
      std::vector<int> at;
      std::vector<float> x, y, value;
    } some;
  };

 private:
  struct Node;
  static constexpr int kWhiteSide = 81;  ///< points along the side of a table of white light

 public:
  /// white() of one microlens, prepared for many points.
  class WhiteTable {
   public:
    WhiteTable(const MicroImages& micro_images, const Place& place);
    double operator()(Vec2 sensor_point) const;
    /// The values of pixels at origin - (pitch.x x, pitch.y y). Single precision.
    void values(Vec2 origin, Vec2 pitch, const std::vector<float>& x, const std::vector<float>& y,
                Isa isa, std::vector<float>& out) const;
    double reach() const { return reach_; }  ///< [m] no light farther from the centre
    Vec2 centre() const { return centre_; }

   private:
    struct Part {
      const float* table = nullptr;
      double weight = 0;
      double half = 0, scale = 0;  ///< [m] half the table's side; its steps per metre
    };
    static constexpr std::size_t kMostParts = 18;  ///< two nodes, each for up to nine angles
    std::array<Part, kMostParts> parts_{};
    std::size_t count_ = 0;
    Vec2 centre_, outwards_;
    double reach_ = 0;
  };

  /// The white light of the pixels around one micro-image. If micro-images touch or overlap, a
  /// pixel gets light through several microlenses. The edge of the stop is out of focus on the
  /// sensor, so the overlap begins well inside the geometric rim.
  class LocalWhite {
   public:
    /// @param radius [m] largest distance from the centre of the micro-image that will be evaluated
    LocalWhite(const MicroImages& micro_images, LensIndex lens, double radius);
    White operator()(Vec2 sensor_point) const;
    /// Fills pixels.own and pixels.total: what the operator says, to single precision, and much
    /// faster.
    void fill(Pixels& pixels, Isa isa = best_isa()) const;

   private:
    WhiteTable own_;
    std::vector<WhiteTable> others_;
    double clear_ = 0;  ///< [m] from the own centre, within which no other one reaches
  };

 private:
  using Lines = std::array<std::array<double, 21>, 4>;
  struct Node {
    bool dark = true;
    double centre = 0, radius = 0;  ///< [m]
    double stop = 0;  ///< [m] from its middle, where the ray of the centre meets the stop
    /// Coefficients of the chief ray at z = 0 (x, y and slopes), over the monomials of degree up to
    /// 5 in (s - centre) / radius.
    Lines line{};
    double white_half = 0;  ///< [m] half the side of the tables
    double reach = 0;       ///< [m] no light farther from the centre
    /// kWhiteSide x kWhiteSide, first axis fastest; one, or one for each angle of the pixels'
    /// sides.
    std::vector<std::vector<float>> white;
  };
  /// Centres of a misaligned camera, by lens; NaN: dark.
  struct Centres {
    LensIndex low;
    int columns = 0, rows = 0;
    std::vector<Vec2> values;
    bool holds(LensIndex lens) const {
      return lens.q >= low.q && lens.r >= low.r && lens.q < low.q + columns &&
             lens.r < low.r + rows;
    }
    std::size_t index(LensIndex lens) const {
      return static_cast<std::size_t>(lens.r - low.r) * static_cast<std::size_t>(columns) +
             static_cast<std::size_t>(lens.q - low.q);
    }
  };
  void find_centres(const Execution& execution);
  Vec2 find_centre(LensIndex lens, double accuracy) const;
  Place aligned_place(LensIndex lens) const;
  static void set_plane(const Place& place, const Lines& lines, double depth, ToPlane& plane);
  static std::optional<Lines> fit_lines(const Camera& open, LensIndex lens, Vec2 aim, Vec2 centre,
                                        double radius, Vec2 outwards);
  Lines lines_of(const Place& place) const;
  void fill_white(const Camera& own, Node& node, double outer_radius) const;

  Camera camera_;
  /// With wider apertures, where its main lens is not round; nullptr: it is.
  std::shared_ptr<const Camera> open_;
  std::shared_ptr<const WindowSet> windows_;  ///< nullptr: none
  Centres centres_;
  double spacing_ = 0, reach_ = 0;
  std::vector<double> step_;              ///< [m] between nodes, per type
  std::vector<std::vector<Node>> nodes_;  ///< per type, over the distance from the axis
};

}  // namespace plenoflame
