// Intersection with, and refraction at, one spherical or plane surface: shared by the vector
// kernels and the double path. Coordinates are relative to the surface's vertex, z along the
// propagation.
#pragma once
#include "math/kernel_math.h"
#include "optics/kernel_types.h"

namespace plenoflame::PLENOFLAME_ISA {

/// Moves the ray from the previous reference plane (z = 0 there) to the surface, tests aperture and
/// refracts. Afterwards z is relative to this surface's vertex.
///
/// Closest-approach form (Feder 1951; Welford, Aberrations of Optical Systems, 1986, ch. 4):
/// from the vertex plane t = F / (G + sqrt(G^2 - c F)), which is exact for planes (c = 0) and keeps
/// its digits for every radius. sqrt(G^2 - c F) is also the cosine of incidence, and
/// cos t' - mu cos t = (1 - mu^2) / (cos t' + mu cos t) keeps them for small index steps.
template <class Real>
PLENOFLAME_INLINE void refract_at(const KernelSurface<Real>& surface, int code_base, Real& x,
                                  Real& y, Real& z, Real& dx, Real& dy, Real& dz, int& code) {
  const Real c = surface.curvature;
  const Real to_plane = (surface.gap - z) / dz;
  x += to_plane * dx;
  y += to_plane * dy;
  const Real f = c * (x * x + y * y);
  const Real g = dz - c * (x * dx + y * dy);
  const Real discriminant = g * g - c * f;
  const Real cos_in = square_root(greatest(discriminant, Real(0)));
  const Real t = f / (g + cos_in);
  x += t * dx;
  y += t * dy;
  z = t * dz;
  const Real cos_out2 = surface.one_minus_mu2 + surface.mu * surface.mu * (cos_in * cos_in);
  const Real cos_out = square_root(greatest(cos_out2, Real(0)));
  const Real along_normal = surface.one_minus_mu2 / (cos_out + surface.mu * cos_in);
  dx = surface.mu * dx - along_normal * (c * x);
  dy = surface.mu * dy - along_normal * (c * y);
  dz = surface.mu * dz + along_normal * (Real(1) - c * z);
  // The geometric cause wins: a ray that misses the sphere has no angle of incidence.
  int failure = cos_out2 > Real(0) ? 0 : code_base + kCauseTotalReflection;
  failure = x * x + y * y <= surface.aperture2 ? failure : code_base + kCauseVignetted;
  failure = discriminant > Real(0) ? failure : code_base + kCauseMissed;
  code = code != 0 ? code : failure;
}

/// The same at a conic with even aspheric terms, rotationally symmetric:
///     sag(h^2) = c h^2 / (1 + sqrt(1 - (1 + k) c^2 h^2)) + sum of terms[i] h^(4 + 2 i)
/// The intersection is found by Newton's method along the ray from the vertex plane, with a fixed
/// number of steps: the error squares with each, so that a surface whose slope at the ray is below
/// one reaches the rounding of `double` in six.
template <class Real>
PLENOFLAME_INLINE void refract_at_asphere(const KernelSurface<Real>& surface,
                                          const KernelAsphere<Real>& asphere, int code_base,
                                          Real& x, Real& y, Real& z, Real& dx, Real& dy, Real& dz,
                                          int& code) {
  const Real c = surface.curvature;
  const Real kc2 = (Real(1) + asphere.conic) * c * c;
  const Real to_plane = (surface.gap - z) / dz;
  x += to_plane * dx;
  y += to_plane * dy;
  z = Real(0);
  Real slope = Real(0), inside = Real(1);  // d sag / d(h^2)
  for (int step = 0; step < 9; ++step) {
    const Real h2 = x * x + y * y;
    inside = Real(1) - kc2 * h2;
    const Real root = square_root(greatest(inside, Real(1e-6)));
    Real sag = Real(0);
    slope = Real(0);
#pragma GCC unroll 7
    for (int i = kAsphericTerms - 1; i >= 0; --i) {
      slope = slope * h2 + Real(i + 2) * asphere.terms[i];
      sag = sag * h2 + asphere.terms[i];
    }
    slope = slope * h2 + Real(0.5) * c / root;
    sag = (sag * h2 + c / (Real(1) + root)) * h2;
    const Real along = dz - Real(2) * slope * (x * dx + y * dy);
    const Real t = step < 8 ? (sag - z) / along : Real(0);
    x += t * dx;
    y += t * dy;
    z += t * dz;
  }
  const Real nx = Real(-2) * slope * x, ny = Real(-2) * slope * y;
  const Real normal = Real(1) / square_root(nx * nx + ny * ny + Real(1));
  const Real cos_in = (nx * dx + ny * dy + dz) * normal;
  const Real cos_out2 = surface.one_minus_mu2 + surface.mu * surface.mu * (cos_in * cos_in);
  const Real cos_out = square_root(greatest(cos_out2, Real(0)));
  const Real along_normal = surface.one_minus_mu2 / (cos_out + surface.mu * cos_in) * normal;
  dx = surface.mu * dx + along_normal * nx;
  dy = surface.mu * dy + along_normal * ny;
  dz = surface.mu * dz + along_normal;
  int failure = cos_out2 > Real(0) ? 0 : code_base + kCauseTotalReflection;
  failure = x * x + y * y <= surface.aperture2 ? failure : code_base + kCauseVignetted;
  failure = inside > Real(1e-6) && cos_in > Real(0) ? failure : code_base + kCauseMissed;
  code = code != 0 ? code : failure;
}

/// A plane without refraction (the stop): only the aperture is tested.
template <class Real>
PLENOFLAME_INLINE void pass_plane(const KernelSurface<Real>& surface, int code_base, Real& x,
                                  Real& y, Real& z, Real dx, Real dy, Real dz, int& code) {
  const Real to_plane = (surface.gap - z) / dz;
  x += to_plane * dx;
  y += to_plane * dy;
  z = Real(0);
  const int failure = x * x + y * y <= surface.aperture2 ? 0 : code_base + kCauseVignetted;
  code = code != 0 ? code : failure;
}

/// Paraxial transform: slope changes by -height * power, height stays.
template <class Real>
PLENOFLAME_INLINE void pass_ideal(const KernelIdealLens<Real>& lens, int code_base, Real& x,
                                  Real& y, Real& z, Real& dx, Real& dy, Real& dz, int& code) {
  const Real sx = dx / dz, sy = dy / dz;
  x += (lens.gap - z) * sx;
  y += (lens.gap - z) * sy;
  const Real at_stop_x = lens.stop_height * x + lens.stop_slope * sx;
  const Real at_stop_y = lens.stop_height * y + lens.stop_slope * sy;
  const int failure = at_stop_x * at_stop_x + at_stop_y * at_stop_y <= lens.stop_radius2
                          ? 0
                          : code_base + kCauseVignetted;
  code = code != 0 ? code : failure;
  const Real tx = sx - lens.power * x, ty = sy - lens.power * y;
  dz = Real(1) / square_root(Real(1) + tx * tx + ty * ty);
  dx = tx * dz;
  dy = ty * dz;
  z = lens.separation;  // relative to the rear principal plane
}

}  // namespace plenoflame::PLENOFLAME_ISA
