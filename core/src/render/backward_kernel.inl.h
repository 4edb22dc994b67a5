// Vector kernels of the backward estimator; compiled once per instruction set.
#include "render/backward_kernel.h"

#include "optics/surface_kernel.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

PLENOFLAME_INLINE float to_unit(std::uint32_t fraction, float) {
  // 23 bits and half a step: inside (0, 1), never its ends.
  return static_cast<float>(static_cast<std::int32_t>(fraction >> 9)) * 0x1p-23f + 0x1p-24f;
}
PLENOFLAME_INLINE double to_unit(std::uint32_t fraction, double) {
  return static_cast<double>(fraction) * 0x1p-32 + 0x1p-33;
}

/// sin(2 pi b) for |b| <= 1/4, by its Taylor series to b^13: 6e-10 at the end.
template <class Real>
PLENOFLAME_INLINE Real sin_turn(Real b) {
  const Real x = Real(6.283185307179586477) * b, x2 = x * x;
  return x * (Real(1) +
              x2 * (Real(-1.0 / 6) +
                    x2 * (Real(1.0 / 120) +
                          x2 * (Real(-1.0 / 5040) +
                                x2 * (Real(1.0 / 362880) +
                                      x2 * (Real(-1.0 / 39916800) + x2 * Real(1.0 / 6227020800.0)))))));
}

/// How far the sensor point (sx, sy) lies outside of the stop's image seen through the aim point
/// (ux, uy): |s - centre(u)| - radius(u).
template <class Real>
PLENOFLAME_INLINE Real outside_stop(const KernelPatch<Real>& c, Real sx, Real sy, Real ux, Real uy) {
  const Real t = (ux * ux + uy * uy) * c.inverse_aim2;
  const Real u_field = ux * c.field_x + uy * c.field_y;
  const Real k = c.coupling[0] + t * (c.coupling[1] + t * c.coupling[2]) - c.coma * u_field;
  const Real odd = c.radius_odd * u_field;
  const Real radius = c.radius[0] + t * (c.radius[1] + t * c.radius[2] + odd);
  const Real along = c.centre + c.centre2 * t;
  const Real vx = sx - along * c.field_x + k * ux;
  const Real vy = sy - along * c.field_y + k * uy;
  return square_root(vx * vx + vy * vy) - radius;
}

/// One step of false position on [a, b] with f(a) > 0 > f(b).
template <class Real>
PLENOFLAME_INLINE Real false_position(Real a, Real fa, Real b, Real fb) {
  return a + (b - a) * (fa / (fa - fb));
}

/// Where on the axis the stop begins to cut, between `a` (outside, fa > 0) and `b` (inside, fb < 0):
/// three steps of false position, each keeping the bracket. `error` is what the last one moved.
template <class Real>
PLENOFLAME_INLINE Real find_cut(const KernelPatch<Real>& c, Real sx, Real sy, Real ax, Real ay,
                                Real ex, Real ey, Real a, Real fa, Real b, Real fb, Real& error) {
  const Real p1 = false_position(a, fa, b, fb);
  const Real f1 = outside_stop(c, sx, sy, ax + p1 * ex, ay + p1 * ey);
  const bool outside1 = f1 > Real(0);
  const Real a1 = outside1 ? p1 : a, fa1 = outside1 ? f1 : fa;
  const Real b1 = outside1 ? b : p1, fb1 = outside1 ? fb : f1;
  const Real p2 = false_position(a1, fa1, b1, fb1);
  const Real f2 = outside_stop(c, sx, sy, ax + p2 * ex, ay + p2 * ey);
  const bool outside2 = f2 > Real(0);
  const Real p3 = false_position(outside2 ? p2 : a1, outside2 ? f2 : fa1, outside2 ? b1 : p2,
                                 outside2 ? fb1 : f2);
  error = Real(0.25) * magnitude(p3 - p2);
  return p3;
}

/// Twice the radius of a circle that bounds the open part of the aperture at a cut of its axis at p
/// (`side` +1: the part lies above, -1: below), from the implicit curve |s - centre(u)| = radius(u);
/// a quarter wider than the circle of curvature, for what the two terms leave out.
template <class Real>
PLENOFLAME_INLINE Real cut_diameter(const KernelPatch<Real>& c, Real p, Real side, Real& bulge) {
  const Real t = p * p * c.inverse_aim2;
  const Real k = c.coupling_sign * (c.coupling[0] + t * (c.coupling[1] + t * c.coupling[2]));
  const Real k_t = c.coupling_sign * (c.coupling[1] + Real(2) * t * c.coupling[2]) * c.inverse_aim2;
  const Real r_t = (c.radius[1] + Real(2) * t * c.radius[2]) * c.inverse_aim2;
  const Real radius = c.radius[0] + t * (c.radius[1] + t * c.radius[2]);
  // Off the axis the direction of u turns against that of s - centre(u), where the image is flatter.
  const Real turn = Real(1) + side * p * k / radius;
  const Real flatter = (c.flattening[0] + t * c.flattening[1]) * c.inverse_aim2 * (turn * turn);
  const Real bend = k * k / (Real(2) * radius) - side * p * k_t - r_t + flatter;
  const Real slope = k + Real(2) * p * p * k_t + side * Real(2) * p * r_t;
  const Real diameter = c.cut_margin * slope / bend;
  // A curve that bends outwards leaves open what lies beyond its cut of the axis; `bulge` covers
  // what plain rays have shown to be in use (tests/statistical/no_light_lost_test.cpp).
  const Real chord2 = Real(0.35) * greatest(c.aim_radius * c.aim_radius - p * p, Real(0));
  bulge = slope > Real(0) ? greatest(-bend * chord2, Real(0)) / slope : Real(2) * c.aim_radius;
  const bool curved = (bend > Real(0)) & (slope > Real(0));
  return curved ? diameter : Real(1e6) * c.aim_radius;
}

/// The same diameter, or none when that circle would cut off what is open: near a microlens' focus
/// the curve is far from a circle. Looked at where the circle crosses the middle of the open part of
/// the axis, `half` from its ends.
template <class Real>
PLENOFLAME_INLINE Real checked_diameter(const KernelPatch<Real>& c, Real sx, Real sy, Real middle_x,
                                        Real middle_y, Real ex, Real ey, Real half, Real diameter) {
  const Real q = square_root(greatest(half * (diameter - half), Real(0)));
  const Real f1 = outside_stop(c, sx, sy, middle_x - q * ey, middle_y + q * ex);
  const Real f2 = outside_stop(c, sx, sy, middle_x + q * ey, middle_y - q * ex);
  const bool bounds = (diameter > Real(2) * half) & (f1 > Real(0)) & (f2 > Real(0));
  return bounds ? diameter : Real(1e6) * c.aim_radius;
}

/// The part of the aperture that is sampled, along an axis through the middle of its disc.
template <class Real>
struct Cut {
  Real ex, ey;        ///< the axis
  Real low, high;     ///< ends along it
  Real low_diameter, high_diameter;  ///< of the circles that bound it there
  Real axis_p, bound2;  ///< the disc around the microlens' own axis: place along the axis, radius^2
};

/// The disc around the microlens' own axis, in coordinates along and across the cut's.
template <class Real>
PLENOFLAME_INLINE void set_bound_disc(const KernelPatch<Real>& c, Real ax, Real ay, Cut<Real>& cut) {
  cut.axis_p = -(ax * cut.ex + ay * cut.ey);
  const Real bound = c.bound_radius + magnitude(ax * cut.ey - ay * cut.ex);
  cut.bound2 = bound * bound;
  cut.high = least(c.aim_radius, cut.axis_p + bound);
}

/// The axis points from the aperture disc's centre away from where the far face's edge cuts least.
template <class Real>
PLENOFLAME_INLINE Cut<Real> whole_aperture(const KernelPatch<Real>& c, Real ax, Real ay) {
  Cut<Real> cut;
  const Real length2 = ax * ax + ay * ay;
  const Real inverse = Real(1) / square_root(greatest(length2, Real(1e-30)));
  cut.ex = length2 > Real(1e-30) ? ax * inverse : Real(1);
  cut.ey = length2 > Real(1e-30) ? ay * inverse : Real(0);
  set_bound_disc(c, ax, ay, cut);
  cut.low = -c.aim_radius;
  return cut;
}

template <class Real>
PLENOFLAME_INLINE Cut<Real> find_cuts(const KernelPatch<Real>& c, Real sx, Real sy, Real ax, Real ay) {
  // The axis: moving the aim point along it brings the stop's image over the sensor point.
  const Real t0 = (ax * ax + ay * ay) * c.inverse_aim2;
  const Real k0 = c.coupling[0] + t0 * (c.coupling[1] + t0 * c.coupling[2]) -
                  c.coma * (ax * c.field_x + ay * c.field_y);
  const Real along0 = c.centre + c.centre2 * t0;
  const Real wx = sx - along0 * c.field_x + k0 * ax, wy = sy - along0 * c.field_y + k0 * ay;
  const Real sigma = square_root(wx * wx + wy * wy);
  const Real direction = -c.coupling_sign / greatest(sigma, Real(1e-30));
  Cut<Real> cut;
  cut.ex = sigma > Real(0) ? direction * wx : Real(1);
  cut.ey = sigma > Real(0) ? direction * wy : Real(0);
  const Real ex = cut.ex, ey = cut.ey, a = c.aim_radius;
  set_bound_disc(c, ax, ay, cut);

  // Where it is nearest to the sensor point, and the cuts to both sides of there.
  const Real tiny = Real(1e-6) * c.radius[0] / a;
  const Real p0 = least(sigma / greatest(c.coupling_sign * k0, tiny), a);
  const Real t1 = p0 * p0 * c.inverse_aim2;
  const Real k1 = c.coupling_sign * (c.coupling[0] + t1 * (c.coupling[1] + t1 * c.coupling[2]));
  const Real pc = least(sigma / greatest(k1, tiny), a);
  const Real f_low = outside_stop(c, sx, sy, ax - a * ex, ay - a * ey);
  const Real f_high = outside_stop(c, sx, sy, ax + a * ex, ay + a * ey);
  // With strong coma even the nearest point may lie outside, and what is open elsewhere: then the
  // whole aperture is taken, which costs rays but no light.
  const Real nearest = outside_stop(c, sx, sy, ax + pc * ex, ay + pc * ey);
  const bool bracketed = nearest < Real(0);
  const Real fc = least(nearest, -tiny * a);
  Real low_error = 0, high_error = 0;
  const Real at_low = find_cut(c, sx, sy, ax, ay, ex, ey, -a, f_low, pc, fc, low_error);
  const Real at_high = find_cut(c, sx, sy, ax, ay, ex, ey, a, f_high, pc, fc, high_error);
  const Real slack = Real(0.001) * a;
  const bool cut_low = bracketed & (f_low > Real(0)), cut_high = bracketed & (f_high > Real(0));
  Real low_bulge = 0, high_bulge = 0;  // nothing was seen to be lost at the high end
  const Real entry = greatest(at_low - slack - low_error, -a);
  const Real low_diameter = cut_diameter(c, entry, Real(1), low_bulge);
  cut.low = cut_low ? greatest(entry - low_bulge, -a) : -a;
  cut.high = cut_high ? least(at_high + slack + high_error, cut.high) : cut.high;
  const Real high_diameter = cut_diameter(c, cut.high, Real(-1), high_bulge);
  const Real half = Real(0.5) * (cut.high - cut.low);
  const Real mx = ax + (cut.low + half) * ex, my = ay + (cut.low + half) * ey;
  const Real low_bound = checked_diameter(c, sx, sy, mx, my, ex, ey, half, low_diameter);
  const Real high_bound = checked_diameter(c, sx, sy, mx, my, ex, ey, half, high_diameter);
  cut.low_diameter = cut_low ? low_bound : Real(1e6) * a;
  cut.high_diameter = cut_high ? high_bound : Real(1e6) * a;
  return cut;
}

/// Uniform points of the pixel, and of that part of the aperture that sees the scene from there, as
/// rays at the aim plane.
///
/// The sensor point is drawn from the pixel inside the micro-image: first its column, then its row
/// in the chord. For a sensor point the open part of the aperture is close to the intersection of
/// two discs; along the line through their centres it reaches from `low` to `high`. A uniform point
/// of the unit disc is stretched to it: linearly along that axis, by the ratio of the chords across.
/// All weights are exact Jacobians: a bound that is too wide costs rays, never light.
///
/// kOpen: the stop is known to cut nothing, so that the whole aperture disc is sampled.
template <bool kOpen, class Real>
PLENOFLAME_INLINE void generate_rays(const KernelPatch<Real>& c, const KernelPixel<Real>& pixel,
                                     Real distance, const KernelBlock<Real>& block) {
  const std::uint32_t* f0 = pixel.fractions[0];
  const std::uint32_t* f1 = pixel.fractions[1];
  const std::uint32_t* f2 = pixel.fractions[2];
  const std::uint32_t* f3 = pixel.fractions[3];
  const std::uint32_t h0 = pixel.shift[0], h1 = pixel.shift[1], h2 = pixel.shift[2],
                      h3 = pixel.shift[3];
  const Real x_low = pixel.x_low, x_width = pixel.x_width, y0 = pixel.y0, y1 = pixel.y1;
  const Real g2 = distance * distance;
  const int first = pixel.first;
  Real* __restrict x = block.x + first;
  Real* __restrict y = block.y + first;
  Real* __restrict z = block.z + first;
  Real* __restrict dx = block.dx + first;
  Real* __restrict dy = block.dy + first;
  Real* __restrict dz = block.dz + first;
  Real* __restrict weight = block.weight + first;
  int* __restrict code = block.code + first;
  const int padded = (pixel.count + 15) & ~15;
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real v0 = to_unit(f0[i] ^ h0, Real());
    const Real v1 = to_unit(f1[i] ^ h1, Real());
    const Real v2 = to_unit(f2[i] ^ h2, Real());
    const Real turn = to_unit(f3[i] ^ h3, Real()) - Real(0.5);

    const Real sx = x_low + x_width * v0;
    const Real chord = square_root(
        greatest(c.outer_radius2 - (sx - c.outer_x) * (sx - c.outer_x), Real(0)));
    const Real top = greatest(y0, c.outer_y - chord);
    const Real height = greatest(least(y1, c.outer_y + chord) - top, Real(0));
    const Real sy = top + height * v1;

    const Real ax = c.aim_x + c.aim_shift * sx, ay = c.aim_y + c.aim_shift * sy;
    const Real a = c.aim_radius;
    Cut<Real> cut;
    if constexpr (kOpen)
      cut = whole_aperture(c, ax, ay);
    else
      cut = find_cuts(c, sx, sy, ax, ay);

    const Real folded = turn > Real(0.25) ? Real(0.5) - turn
                                          : (turn < Real(-0.25) ? Real(-0.5) - turn : turn);
    const Real sine = sin_turn(folded);
    const Real cosine = sin_turn(Real(0.25) - magnitude(turn));
    const Real r = square_root(v2);
    const Real across = r * sine;
    const Real half = Real(0.5) * (cut.high - cut.low);
    const Real p = Real(0.5) * (cut.low + cut.high) + half * (r * cosine);
    const Real unit_chord2 = (Real(1) - v2) + across * across;  // 1 - (r cosine)^2
    Real chord2 = least(a * a - p * p, cut.bound2 - (p - cut.axis_p) * (p - cut.axis_p));
    if constexpr (!kOpen) {
      const Real above = p - cut.low, below = cut.high - p;
      chord2 = least(chord2, least(above * (cut.low_diameter - above),
                                   below * (cut.high_diameter - below)));
    }
    const Real stretch = square_root(greatest(chord2, Real(0)) / unit_chord2);
    const Real q = across * stretch;
    const Real ux = ax + cut.ex * p - cut.ey * q;
    const Real uy = ay + cut.ey * p + cut.ex * q;

    const Real vx = ux - sx, vy = uy - sy;
    const Real inverse = Real(1) / square_root(vx * vx + vy * vy + g2);
    x[i] = ux;
    y[i] = uy;
    z[i] = Real(0);
    dx[i] = vx * inverse;
    dy[i] = vy * inverse;
    dz[i] = distance * inverse;
    // cos(theta) dOmega = cos^2 / r^2 dA' on parallel planes.
    const Real inverse2 = inverse * inverse;
    weight[i] = Real(3.141592653589793238) * half * stretch * (x_width * height) *
                (g2 * inverse2 * inverse2);
    code[i] = 0;
  }
}

template <class Real>
PLENOFLAME_INLINE void pass_microlens(const KernelMicrolens<Real>& lens, Real lens_x, Real lens_y,
                                      int first, int count, const KernelBlock<Real>& block) {
  Real* __restrict x = block.x + first;
  Real* __restrict y = block.y + first;
  Real* __restrict z = block.z + first;
  Real* __restrict dx = block.dx + first;
  Real* __restrict dy = block.dy + first;
  Real* __restrict dz = block.dz + first;
  int* __restrict code = block.code + first;
  const int padded = (count + 15) & ~15;
  const KernelMicrolens<Real> c = lens;
  if (c.kind == 1) {
    const int back = 4 * c.surface_number[0], front = 4 * c.surface_number[1];
#pragma omp simd
    for (int i = 0; i < padded; ++i) {
      Real px = x[i], py = y[i], pz = z[i], vx = dx[i], vy = dy[i], vz = dz[i];
      int status = code[i];
      refract_at(c.surfaces[0], back, px, py, pz, vx, vy, vz, status);
      refract_at(c.surfaces[1], front, px, py, pz, vx, vy, vz, status);
      x[i] = px + lens_x;
      y[i] = py + lens_y;
      z[i] = pz;
      dx[i] = vx;
      dy[i] = vy;
      dz[i] = vz;
      code[i] = status;
    }
  } else if (c.kind == 2) {
    const int number = 4 * c.surface_number[0];
#pragma omp simd
    for (int i = 0; i < padded; ++i) {
      Real px = x[i], py = y[i], pz = z[i], vx = dx[i], vy = dy[i], vz = dz[i];
      int status = code[i];
      pass_ideal(c.ideal, number, px, py, pz, vx, vy, vz, status);
      x[i] = px + lens_x;
      y[i] = py + lens_y;
      z[i] = pz;
      dx[i] = vx;
      dy[i] = vy;
      dz[i] = vz;
      code[i] = status;
    }
  }
}

template <class Real>
PLENOFLAME_INLINE void generate_all(const KernelPatch<Real>& patch, const KernelPixel<Real>* pixels,
                                    int count, const KernelMicrolens<Real>& lens,
                                    const KernelBlock<Real>& block) {
  const KernelPatch<Real> c = patch;
  for (int i = 0; i < count; ++i) {
    if (pixels[i].open)
      generate_rays<true>(c, pixels[i], lens.distance, block);
    else
      generate_rays<false>(c, pixels[i], lens.distance, block);
  }
  const int first = pixels[0].first;
  pass_microlens(lens, c.lens_x, c.lens_y, first,
                 pixels[count - 1].first + pixels[count - 1].count - first, block);
}

template <class Real, bool kRefracts>
PLENOFLAME_INLINE void pass_surface(const KernelSurface<Real>& surface, int number, int count,
                                    const KernelBlock<Real>& block) {
  Real* __restrict x = block.x;
  Real* __restrict y = block.y;
  Real* __restrict z = block.z;
  Real* __restrict dx = block.dx;
  Real* __restrict dy = block.dy;
  Real* __restrict dz = block.dz;
  int* __restrict code = block.code;
  const KernelSurface<Real> c = surface;
  const int base = 4 * number;
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    Real px = x[i], py = y[i], pz = z[i], vx = dx[i], vy = dy[i], vz = dz[i];
    int status = code[i];
    if constexpr (kRefracts) {
      refract_at(c, base, px, py, pz, vx, vy, vz, status);
      dx[i] = vx;
      dy[i] = vy;
      dz[i] = vz;
    } else {
      pass_plane(c, base, px, py, pz, vx, vy, vz, status);
    }
    x[i] = px;
    y[i] = py;
    z[i] = pz;
    code[i] = status;
  }
}

template <class Real>
PLENOFLAME_INLINE void trace(const KernelCamera<Real>& camera, int count,
                             const KernelBlock<Real>& block) {
  Real* __restrict x = block.x;
  Real* __restrict y = block.y;
  Real* __restrict z = block.z;
  Real* __restrict dx = block.dx;
  Real* __restrict dy = block.dy;
  Real* __restrict dz = block.dz;
  Real* __restrict weight = block.weight;
  int* __restrict code = block.code;
  if (camera.ideal_lens) {
    const KernelIdealLens<Real> c = camera.ideal;
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      Real px = x[i], py = y[i], pz = z[i], vx = dx[i], vy = dy[i], vz = dz[i];
      int status = code[i];
      pass_ideal(c, 0, px, py, pz, vx, vy, vz, status);
      x[i] = px;
      y[i] = py;
      z[i] = pz;
      dx[i] = vx;
      dy[i] = vy;
      dz[i] = vz;
      code[i] = status;
    }
  } else {
    for (int s = 0; s < camera.surface_count; ++s) {
      if (camera.refracts[s])
        pass_surface<Real, true>(camera.surfaces[s], camera.surface_number[s], count, block);
      else
        pass_surface<Real, false>(camera.surfaces[s], camera.surface_number[s], count, block);
    }
  }
  const Real gap = camera.exit_gap, ax = camera.anchor_x, ay = camera.anchor_y;
  const Real r0 = camera.rotation[0], r1 = camera.rotation[1], r2 = camera.rotation[2],
             r3 = camera.rotation[3], r4 = camera.rotation[4], r5 = camera.rotation[5],
             r6 = camera.rotation[6], r7 = camera.rotation[7], r8 = camera.rotation[8];
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    // A ray that ended in the camera goes on along the axis, with no weight: always a valid ray.
    const bool alive = code[i] == 0;
    const Real vx = alive ? dx[i] : Real(0), vy = alive ? dy[i] : Real(0),
               vz = alive ? dz[i] : Real(1);
    const Real distance = (gap - (alive ? z[i] : Real(0))) / vz;
    const Real px = (alive ? x[i] : Real(0)) + distance * vx - ax;
    const Real py = (alive ? y[i] : Real(0)) + distance * vy - ay;
    weight[i] = alive ? weight[i] : Real(0);
    x[i] = r0 * px + r1 * py;
    y[i] = r3 * px + r4 * py;
    z[i] = r6 * px + r7 * py;
    dx[i] = r0 * vx + r1 * vy + r2 * vz;
    dy[i] = r3 * vx + r4 * vy + r5 * vz;
    dz[i] = r6 * vx + r7 * vy + r8 * vz;
  }
}

template <class Real>
PLENOFLAME_INLINE double sum_products(const Real* __restrict weight,
                                      const Real* __restrict radiance, int count) {
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (int i = 0; i < count; ++i)
    sum += static_cast<double>(weight[i]) * static_cast<double>(radiance[i]);
  return sum;
}

}  // namespace

void generate(const KernelPatch<float>& patch, const KernelPixel<float>* pixels, int count,
              const KernelMicrolens<float>& lens, const KernelBlock<float>& block) {
  generate_all(patch, pixels, count, lens, block);
}

void generate(const KernelPatch<double>& patch, const KernelPixel<double>* pixels, int count,
              const KernelMicrolens<double>& lens, const KernelBlock<double>& block) {
  generate_all(patch, pixels, count, lens, block);
}

void trace_lens(const KernelCamera<float>& camera, int count, const KernelBlock<float>& block) {
  trace(camera, count, block);
}

void trace_lens(const KernelCamera<double>& camera, int count, const KernelBlock<double>& block) {
  trace(camera, count, block);
}

double accumulate(const float* weight, const float* radiance, int count) {
  return sum_products(weight, radiance, count);
}

double accumulate(const double* weight, const double* radiance, int count) {
  return sum_products(weight, radiance, count);
}

int count_alive(const int* __restrict code, int count) {
  int alive = 0;
#pragma omp simd reduction(+ : alive)
  for (int i = 0; i < count; ++i) alive += code[i] == 0 ? 1 : 0;
  return alive;
}

}  // namespace plenoflame::PLENOFLAME_ISA
