#pragma once
#include <array>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/calibration/lattice_guess.h"
#include "plenoflame/image/image.h"
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// A micro-image of a white picture: a disc with a soft edge and a slope of brightness, fitted to
/// the pixels of its cell. All lengths in pixels.
struct MicroImageFit {
  int i = 0, j = 0;   ///< of the lattice (LatticeGuess)
  Vec2 centre;        ///< as measured
  double radius = 0;  ///< at which the light has fallen to a half: the geometric image of the stop
  double blur = 0;    ///< half the width of the edge: how far the stop's image is out of focus
  double even_radius = 0;  ///< of the even disc with the second moment of the light in the cell
  double light = 0;        ///< in the middle
  double rms = 0;          ///< of the fit's residuals, in units of `light`
  bool good = false;       ///< takes part in the model
  Vec2 model;              ///< centre by the global model
  int type = 0;
};

/// The places of micro-images. The plane of the array is seen from the exit pupil (a homography,
/// because the array may be tilted), then distorted about the picture's middle.
struct LatticeModel {
  bool hexagonal = false;
  /// x = (h0 u + h1 v + h2) / (1 + h6 u + h7 v), y = (h3 u + h4 v + h5) / (...). Here (u, v) is (i
  /// + j/2, j sin 60) / scale (hexagonal) or (i, j) / scale.
  std::array<double, 8> homography{};
  double scale = 1;
  Vec2 middle;       ///< [pixel] of the picture
  double reach = 1;  ///< [pixel] from there to the corners
  /// x' = x + (x - middle) (k1 s^2 + k2 s^4), s = |x - middle| / reach
  double k1 = 0, k2 = 0;

  Vec2 point(double i, double j) const;
};

/// The looks by which one type of microlens differs.
struct TypeLooks {
  double radius = 0, blur = 0;              ///< [pixel] mean over its micro-images
  double radius_error = 0, blur_error = 0;  ///< standard errors of the means
  double even_radius = 0, even_error = 0;   ///< the same, of micro-images in the picture's middle
  std::size_t count = 0;
};

/// A white picture, measured.
struct WhiteLattice {
  LatticeGuess guess;
  LatticeModel model;
  std::vector<MicroImageFit> images;  ///< all whose cell lies in the picture, by j, then i
  std::size_t good = 0;               ///< that take part in the model
  double rms = 0;  ///< [pixel] of measured centres of good ones from the model, in x and y together
  double worst = 0;  ///< [pixel] of these
  /// [pixel] near the middle, along i and j, and the angle of step i from x towards y [rad]
  double pitch_i = 0, pitch_j = 0, rotation = 0;
  std::vector<TypeLooks> types;  ///< one, or the number of types that can be distinguished
};

/// Measures all micro-images and fits the model. The result does not depend on threads.
/// @param white light alone (dark subtracted), colours of a mosaic made equal
/// @throws InputError if there is no lattice, with a description of what was seen; Cancelled
WhiteLattice measure_white(const Image& white, const Execution& execution = {});

/// The model of centres that another program found, in any order. All count as one type.
/// @throws InputError: too few, outside of the picture, or no lattice
WhiteLattice lattice_of_centres(const std::vector<Vec2>& centres, int width, int height);

/// Radius and blur of each micro-image of another white picture of the same camera, taken with
/// another aperture: the same places. Types are those of `lattice`.
std::vector<TypeLooks> looks_at(const Image& white, const WhiteLattice& lattice,
                                const Execution& execution = {});

}  // namespace plenoflame
