#pragma once
#include <Eigen/Dense>
#include <array>
#include <vector>

#include "plenoflame/camera/microlens_aperture.h"
#include "plenoflame/image/image.h"
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// A corner between four squares, or a dot, within a micro-image.
struct BoardMark {
  Vec2 pixel;        ///< seen through the middle of the microlens
  Vec2 diagonal;     ///< corners: (cos 2 a, sin 2 a) of the angle a of the bright squares' diagonal
  double error = 0;  ///< [pixel] standard deviation of the place
  double blur = 0;   ///< MicroView::plane by the mark's own pixels
  double blur_error = 0;  ///< standard deviation; 0: the pixels do not tell the blur
  /// Corners: angles of both edges. Dots: radius [pixel], and nothing.
  std::array<double, 2> shape{};
};

/// How a micro-image sees a plane of the scene. A point q of the microlens, [pixel] from its
/// middle, displaces the stop's image by stop * q and that of the plane by plane * q.
struct MicroView {
  Vec2 centre;          ///< [pixel] of the stop's image
  Vec2 lens;            ///< [pixel] of the microlens' middle
  double distance = 0;  ///< [pixel] of the microlens from the sensor
  double radius = 0;    ///< [pixel] of the stop's image; 0: the stop cuts nothing off
  double stop = 0;
  double plane = 0;
  double visible = 0;  ///< [pixel] about the centre, within which pixels are used
};

/// Information of fits about the value of MicroView::plane: terms of a sum of squares.
struct BlurInformation {
  double gradient = 0, curvature = 0;  ///< half the derivatives, in units of the noise
};

/// Finds the marks of a picture in its micro-images. The model of a pixel is the mean of the
/// pattern over the points of the microlens whose rays pass the stop.
class MarkFinder {
 public:
  /// @param light over that of a white picture; NaN where a pixel says nothing
  /// @param aperture of the microlenses @param pixel [m]
  MarkFinder(const Image& light, bool dots, const MicrolensAperture& aperture, Vec2 pixel);

  /// All marks, by fits that know neither blur nor stop.
  std::vector<BoardMark> marks_in(const MicroView& view) const;

  /// The steps of the board [pixel] from one mark to its neighbours.
  struct Grid {
    Vec2 column, row;
  };
  /// Fits a mark that is expected at a place. @return false: there is none
  bool fit_expected(const MicroView& view, const Grid& grid, BoardMark& mark,
                    BlurInformation& blur) const;

  /// Light of a pixel from an even scene, over that through all of the microlens along the axis.
  double white(const MicroView& view, Vec2 pixel) const;
  double lens_radius() const { return lens_radius_; }  ///< [pixel]

 private:
  struct Patch;
  struct Fit;
  template <class Takes>
  Patch patch(Vec2 about, double reach, const MicroView& view, const Takes& takes) const;
  bool fit_corner(const MicroView& view, BoardMark& mark) const;
  bool fit_dot(const MicroView& view, double size, BoardMark& mark) const;
  bool accept(const Fit& fit, const MicroView& view, BoardMark& mark) const;
  bool solve(const Patch& patch, bool free_blur, Fit& fit) const;

  const Image& light_;
  bool dots_;
  std::vector<Vec2> aperture_;  ///< points of equal area
  double lens_radius_ = 0;
  Image smooth_;
  Image strength_;  ///< how much each pixel looks like a mark
};

}  // namespace plenoflame
