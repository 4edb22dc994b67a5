#pragma once
#include <optional>
#include <string>
#include <vector>

#include "calibration/board_marks.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame {

/// The point of a line at a distance z [m].
inline Vec2 at_depth(const MicroImages::Line& line, double z) {
  return line.position + z * line.slope;
}

/// A microlens with its micro-image.
struct LensView {
  LensIndex lens;
  MicroImages::Place place;
  Vec2 at_lens;  ///< place of the microlens [m]
  MicroView see;
  MicroImages::Line middle;  ///< seen at the centre of the micro-image
  MicroImages::Line beside;  ///< one pixel beside it along x, as a difference
  MicroImages::Line
      beside_lens;  ///< at its centre, through a point one pixel beside the microlens' middle

  /// MicroView::plane of a plane at a distance.
  double blur_at(double z) const { return -at_depth(beside_lens, z).x / at_depth(beside, z).x; }
};

/// The line that a mark is seen on, and a point one pixel beside it, as a difference.
struct SeenMark {
  std::size_t view;
  LensIndex lens;
  BoardMark mark;
  MicroImages::Line line, beside;

  Vec2 at(double z) const { return at_depth(line, z); }
  /// [m] that a pixel is wide at a distance
  double pixel_at(double z) const { return length(at_depth(beside, z)); }
};

/// A raw picture of a board, microlens by microlens.
class BoardViews {
 public:
  /// @param white picture, or empty @throws InputError for a picture of another size
  BoardViews(const Image& light, const Image& white, const CameraSpec& spec, bool dots,
             const Execution& execution);

  const Camera& camera() const { return camera_; }
  const MarkFinder& finder() const { return *finder_; }
  const std::vector<LensView>& views() const { return views_; }
  /// Distance of the plane that is in focus on the array [m].
  double in_focus() const;
  /// Tells from where to where squares of this side [m] are large enough in micro-images.
  std::string where_seen(double cell) const;
  SeenMark seen_at(std::size_t view, const BoardMark& mark) const;
  /// The pixel at which a microlens sees a point.
  Vec2 pixel_of(const LensView& view, Vec3 point) const;

 private:
  bool look(LensView& view) const;
  void divide(const Image& light, const Image& white);

  Camera camera_;
  MicroImages micro_;
  Image even_;  ///< light over white light
  std::optional<MarkFinder> finder_;
  std::vector<LensView> views_;
};

}  // namespace plenoflame
