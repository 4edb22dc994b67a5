#pragma once
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/camera/microlens_lattice.h"
#include "plenoflame/image/image.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/scene/camera_spec.h"

namespace plenoflame {

/// A plane board with a pattern of points: the corners between the squares of a checkerboard, or
/// the middles of round dots.
struct BoardSpec {
  bool dots = false;
  int columns = 0, rows = 0;  ///< points along each side
  double cell = 0;            ///< [m] between neighbouring points
};

/// A point of the board, seen through one microlens.
struct BoardCorner {
  LensIndex lens;
  Vec2 pixel;               ///< column, row; pixel (0, 0) has its centre at (0.5, 0.5)
  int column = 0, row = 0;  ///< of the board's points
  double error = 0;         ///< [pixel] standard deviation by the fit to its pixels
  /// [pixel] CornerObservation::blur by its pixels, and its standard deviation. 0: not known.
  double blur = 0, blur_error = 0;
};

struct BoardCorners {
  std::vector<BoardCorner> corners;
  std::size_t marks = 0;   ///< saddles or dots in micro-images, with those of no board
  std::size_t points = 0;  ///< different points of the board
  /// True if every point of the board was found. The first point is then known: uniquely for a
  /// checkerboard with an odd sum of columns and rows, up to half a turn for others.
  bool whole = false;
  double distance = 0;  ///< [m] about, from the lens to the board, by this camera
};

/// Finds the points of a board in a raw picture. Each mark in a micro-image is a line in front of
/// the camera. The board is the plane on which lines through neighbouring microlenses meet; the
/// grid is found on it.
/// @param light of the raw picture without its dark level
/// @param camera with an array, so near to the real one that its micro-images lie at those of the
///        picture (calibrate white)
/// @param white a white picture of the same camera; empty: the camera's own vignetting
/// @throws InputError if no board is found, with a description of what was seen; Cancelled
BoardCorners find_board(const Image& light, const CameraSpec& camera, const BoardSpec& board,
                        const Image& white = {}, const Execution& execution = {});

}  // namespace plenoflame
