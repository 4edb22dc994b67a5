// Intersection with, and refraction at, one surface: shared by the vector kernels and the double
// path. Spheres and planes are met in closed form, other shapes by Newton's method. Coordinates are
// relative to the surface's vertex, z along the propagation.
#pragma once
#include "math/kernel_math.h"
#include "optics/kernel_types.h"
#include "optics/shape_kernel.h"

namespace plenoflame::PLENOFLAME_ISA {

/// Moves the ray from the previous reference plane (z = 0 there) to the surface and tests the
/// aperture. Afterwards z is relative to this surface's vertex.
///
/// Closest-approach form (Feder 1951; Welford, Aberrations of Optical Systems, 1986, ch. 4). From
/// the vertex plane t = F / (G + sqrt(G^2 - c F)), which is exact for planes (c = 0) and keeps its
/// digits for every radius.
/// @param cos_in sqrt(G^2 - c F), the cosine of incidence; meaningless if the sphere is missed
template <class Real>
PLENOFLAME_INLINE void go_to_surface(const KernelSurface<Real>& surface, int code_base, Real& x,
                                     Real& y, Real& z, Real dx, Real dy, Real dz, Real& cos_in,
                                     int& code) {
  const Real c = surface.curvature;
  const Real to_plane = (surface.gap - z) / dz;
  x += to_plane * dx;
  y += to_plane * dy;
  const Real f = c * (x * x + y * y);
  const Real g = dz - c * (x * dx + y * dy);
  const Real discriminant = g * g - c * f;
  cos_in = square_root(magnitude(discriminant));
  const Real t = f / (g + cos_in);
  x += t * dx;
  y += t * dy;
  z = t * dz;
  int failure = x * x + y * y <= surface.aperture2 ? 0 : code_base + kCauseVignetted;
  failure = discriminant > Real(0) ? failure : code_base + kCauseMissed;
  code = code != 0 ? code : failure;
}

/// Refracts a ray that has arrived. cos t' - mu cos t = (1 - mu^2) / (cos t' + mu cos t) keeps its
/// digits for small index steps. The geometric cause of a failure comes first: a ray that misses
/// the sphere has no angle of incidence.
template <class Real>
PLENOFLAME_INLINE void refract(const KernelSurface<Real>& surface, int code_base, Real x, Real y,
                               Real z, Real cos_in, Real& dx, Real& dy, Real& dz, int& code) {
  const Real c = surface.curvature;
  const Real cos_out2 = surface.one_minus_mu2 + surface.mu * surface.mu * (cos_in * cos_in);
  const Real cos_out = square_root(magnitude(cos_out2));
  const Real along_normal = surface.one_minus_mu2 / (cos_out + surface.mu * cos_in);
  dx = surface.mu * dx - along_normal * (c * x);
  dy = surface.mu * dy - along_normal * (c * y);
  dz = surface.mu * dz + along_normal * (Real(1) - c * z);
  const int failure = cos_out2 > Real(0) ? 0 : code_base + kCauseTotalReflection;
  code = code != 0 ? code : failure;
}

/// Both of them.
template <class Real>
PLENOFLAME_INLINE void refract_at(const KernelSurface<Real>& surface, int code_base, Real& x,
                                  Real& y, Real& z, Real& dx, Real& dy, Real& dz, int& code) {
  Real cos_in;
  go_to_surface(surface, code_base, x, y, z, dx, dy, dz, cos_in, code);
  refract(surface, code_base, x, y, z, cos_in, dx, dy, dz, code);
}

/// Moves the ray from the previous reference plane to the vertex plane.
template <class Real>
PLENOFLAME_INLINE void go_to_vertex(Real gap, Real& x, Real& y, Real& z, Real dx, Real dy,
                                    Real dz) {
  const Real to_plane = (gap - z) / dz;
  x += to_plane * dx;
  y += to_plane * dy;
  z = Real(0);
}

/// A step of Newton's method along the ray towards the surface.
template <class Shape, class Real>
PLENOFLAME_INLINE void approach_shape(const Shape& shape, Real& x, Real& y, Real& z, Real dx,
                                      Real dy, Real dz) {
  const auto place = place_on(shape, x, y);
  const Real t = (place.sag - z) / (dz - place.rise(dx, dy));
  x += t * dx;
  y += t * dy;
  z += t * dz;
}

/// Tests aperture and refracts a ray that has arrived.
template <class Shape, class Real>
PLENOFLAME_INLINE void leave_shape(const KernelSurface<Real>& surface, const Shape& shape,
                                   int code_base, Real x, Real y, Real z, Real& dx, Real& dy,
                                   Real& dz, int& code) {
  const auto place = place_on(shape, x, y);
  const Real nx = -place.slope_x(), ny = -place.slope_y();
  const Real normal = Real(1) / square_root(nx * nx + ny * ny + Real(1));
  const Real cos_in = (nx * dx + ny * dy + dz) * normal;
  const Real cos_out2 = surface.one_minus_mu2 + surface.mu * surface.mu * (cos_in * cos_in);
  const Real cos_out = square_root(magnitude(cos_out2));
  const Real along_normal = surface.one_minus_mu2 / (cos_out + surface.mu * cos_in) * normal;
  dx = surface.mu * dx + along_normal * nx;
  dy = surface.mu * dy + along_normal * ny;
  dz = surface.mu * dz + along_normal;
  int failure = cos_out2 > Real(0) ? 0 : code_base + kCauseTotalReflection;
  failure = x * x + y * y <= surface.aperture2 ? failure : code_base + kCauseVignetted;
  // Without a crossing, the steps have led anywhere.
  const Real off2 = (place.sag - z) * (place.sag - z) * shape.inverse_height2;
  failure = (place.inside > Real(1e-6)) & (cos_in > Real(0)) & (off2 < Real(1e-8))
                ? failure
                : code_base + kCauseMissed;
  code = code != 0 ? code : failure;
}

/// refract_at() for another shape than a sphere. Newton's method finds the intersection along the
/// ray from the vertex plane, with a fixed number of steps. The error squares with each step. A
/// surface whose slope at the ray is below one reaches the rounding of `double` in six steps.
template <class Real>
PLENOFLAME_INLINE void refract_at_shape(const KernelSurface<Real>& surface,
                                        const KernelShape<Real>& any_shape, int code_base, Real& x,
                                        Real& y, Real& z, Real& dx, Real& dy, Real& dz, int& code) {
  with_shape(any_shape, [&](const auto& shape) {
    go_to_vertex(surface.gap, x, y, z, dx, dy, dz);
    for (int step = 0; step < kShapeSteps; ++step) approach_shape(shape, x, y, z, dx, dy, dz);
    leave_shape(surface, shape, code_base, x, y, z, dx, dy, dz, code);
  });
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
