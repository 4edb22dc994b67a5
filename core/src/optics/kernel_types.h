// Plain data that the vector kernels read; shared by all instruction sets, so without functions.
#pragma once

namespace plenoflame {

/// Ray codes: 0 alive, otherwise 4 * surface + cause of the first failure.
enum : int { kCauseVignetted = 1, kCauseTotalReflection = 2, kCauseMissed = 3 };

template <class Real>
struct KernelSurface {
  Real gap;            ///< from the previous reference plane to this vertex
  Real curvature;      ///< > 0: centre ahead in the direction of propagation
  Real aperture2;      ///< clear radius squared
  Real mu;             ///< index before / index behind
  Real one_minus_mu2;  ///< (n' - n)(n' + n) / n'^2: exact for the smallest index steps
};

/// The coating by which a surface reflects: a single layer between the two media.
template <class Real>
struct KernelCoating {
  Real before, layer, behind;  ///< indices; layer = before: no layer
  Real phase;                  ///< 4 thickness layer / wavelength: twice the phase over pi
};

/// The paraxial transform (camera/camera.h, IdealLens) as the kernels use it.
template <class Real>
struct KernelIdealLens {
  Real gap;         ///< from the previous reference plane to the rear principal plane
  Real separation;  ///< from the rear to the front principal plane
  Real power;       ///< 1 / focal length
  Real stop_height;
  Real stop_slope;
  Real stop_radius2;
};

inline constexpr int kMostSidePairs = 3;

/// An aperture between pairs of parallel sides; no pairs: what is not looked at.
template <class Real>
struct KernelPolygon {
  int pairs;
  Real normal_x[kMostSidePairs], normal_y[kMostSidePairs], half_width[kMostSidePairs];
};

}  // namespace plenoflame
