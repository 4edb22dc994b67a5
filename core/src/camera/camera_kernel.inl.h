// Vector kernels that trace blocks of rays through the camera; compiled once per instruction set.
#include "camera/camera_kernel.h"

#include "optics/reflection_kernel.h"
#include "optics/surface_kernel.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

/// Rotates positions and directions by a matrix, then shifts the positions.
template <class Real>
PLENOFLAME_INLINE void turn_rays(const Real* matrix, bool back, Real sx, Real sy, Real sz,
                                 int count, const KernelBlock<Real>& block, int first) {
  Real* __restrict x = block.x + first;
  Real* __restrict y = block.y + first;
  Real* __restrict z = block.z + first;
  Real* __restrict dx = block.dx + first;
  Real* __restrict dy = block.dy + first;
  Real* __restrict dz = block.dz + first;
  const Real a = matrix[0], b = matrix[back ? 3 : 1], c = matrix[back ? 6 : 2];
  const Real d = matrix[back ? 1 : 3], e = matrix[4], f = matrix[back ? 7 : 5];
  const Real g = matrix[back ? 2 : 6], h = matrix[back ? 5 : 7], k = matrix[8];
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const Real px = x[i], py = y[i], pz = z[i], vx = dx[i], vy = dy[i], vz = dz[i];
    x[i] = a * px + b * py + c * pz + sx;
    y[i] = d * px + e * py + f * pz + sy;
    z[i] = g * px + h * py + k * pz + sz;
    dx[i] = a * vx + b * vy + c * vz;
    dy[i] = d * vx + e * vy + f * vz;
    dz[i] = g * vx + h * vy + k * vz;
  }
}

/// Keeps the directions of a block in front of a reflecting surface.
template <class Real>
struct Directions {
  Real x[kBlockRays + kBlockSlack], y[kBlockRays + kBlockSlack], z[kBlockRays + kBlockSlack];
  void keep(int first, int count, const KernelBlock<Real>& block) {
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      x[i] = block.dx[first + i];
      y[i] = block.dy[first + i];
      z[i] = block.dz[first + i];
    }
  }
};

/// Reduces the weights by the reflected light, from the directions on both sides. By Snell's law,
/// before * d_before - behind * d_behind is along the normal, for any shape of the surface.
template <class Real>
PLENOFLAME_INLINE void lose_reflected(const KernelCoating<Real>& coating,
                                      const Directions<Real>& before, int first, int count,
                                      const KernelBlock<Real>& block) {
  const KernelCoating<Real> c = coating;
  if (c.before == c.behind) return;
  const Real* __restrict dx = block.dx + first;
  const Real* __restrict dy = block.dy + first;
  const Real* __restrict dz = block.dz + first;
  Real* __restrict weight = block.weight + first;
  const int* __restrict code = block.code + first;
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const Real ux = before.x[i], uy = before.y[i], uz = before.z[i];
    const Real nx = c.before * ux - c.behind * dx[i], ny = c.before * uy - c.behind * dy[i],
               nz = c.before * uz - c.behind * dz[i];
    const Real inverse = Real(1) / square_root(nx * nx + ny * ny + nz * nz);
    const Real passed = transmission(c, magnitude(ux * nx + uy * ny + uz * nz) * inverse,
                                     magnitude(dx[i] * nx + dy[i] * ny + dz[i] * nz) * inverse);
    weight[i] *= code[i] == 0 ? passed : Real(1);
  }
}

/// The sensor's cover glass: a plane plate, both of whose faces reflect.
template <class Real>
PLENOFLAME_INLINE void pass_cover(Real index, int first, int count,
                                  const KernelBlock<Real>& block) {
  const Real* __restrict dz = block.dz + first;
  Real* __restrict weight = block.weight + first;
  const KernelCoating<Real> in{Real(1), Real(1), index, Real(0)};
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const Real cosine = dz[i];
    const Real inside =
        square_root(greatest(Real(1) - (Real(1) - cosine * cosine) / (index * index), Real(0)));
    const Real once = transmission(in, cosine, inside);
    weight[i] *= once * once;
  }
}

/// Uses two loops: a single one is too long for the processor to look ahead to the next rays.
template <class Real>
PLENOFLAME_INLINE void pass_sphere(const KernelSurface<Real>& surface, int number, int first,
                                   int count, const KernelBlock<Real>& block) {
  Real* __restrict x = block.x + first;
  Real* __restrict y = block.y + first;
  Real* __restrict z = block.z + first;
  Real* __restrict dx = block.dx + first;
  Real* __restrict dy = block.dy + first;
  Real* __restrict dz = block.dz + first;
  int* __restrict code = block.code + first;
  const KernelSurface<Real> c = surface;
  const int base = 4 * number;
  alignas(64) Real cosines[kBlockRays + kBlockSlack];
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    Real px = x[i], py = y[i], pz = z[i], cos_in;
    int status = code[i];
    go_to_surface(c, base, px, py, pz, dx[i], dy[i], dz[i], cos_in, status);
    x[i] = px;
    y[i] = py;
    z[i] = pz;
    cosines[i] = cos_in;
    code[i] = status;
  }
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    Real vx = dx[i], vy = dy[i], vz = dz[i];
    int status = code[i];
    refract(c, base, x[i], y[i], z[i], cosines[i], vx, vy, vz, status);
    dx[i] = vx;
    dy[i] = vy;
    dz[i] = vz;
    code[i] = status;
  }
}

template <class Real>
PLENOFLAME_INLINE void pass_stop(const KernelSurface<Real>& surface, int number, int count,
                                 const KernelBlock<Real>& block) {
  Real* __restrict x = block.x;
  Real* __restrict y = block.y;
  Real* __restrict z = block.z;
  const Real* __restrict dx = block.dx;
  const Real* __restrict dy = block.dy;
  const Real* __restrict dz = block.dz;
  int* __restrict code = block.code;
  const KernelSurface<Real> c = surface;
  const int base = 4 * number;
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    Real px = x[i], py = y[i], pz = z[i];
    int status = code[i];
    pass_plane(c, base, px, py, pz, dx[i], dy[i], dz[i], status);
    x[i] = px;
    y[i] = py;
    z[i] = pz;
    code[i] = status;
  }
}

/// Ends rays of the block outside of an aperture with sides. @param surface number for the status
template <class Real>
[[gnu::noinline]] void clip(const KernelPolygon<Real>& aperture, int surface, int first, int count,
                            const KernelBlock<Real>& block) {
  const Real* __restrict x = block.x + first;
  const Real* __restrict y = block.y + first;
  int* __restrict code = block.code + first;
  const int vignetted = 4 * surface + kCauseVignetted;
  for (int pair = 0; pair < aperture.pairs; ++pair) {
    const Real nx = aperture.normal_x[pair], ny = aperture.normal_y[pair];
    const Real half = aperture.half_width[pair];
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      const int failure = magnitude(nx * x[i] + ny * y[i]) <= half ? 0 : vignetted;
      code[i] = code[i] != 0 ? code[i] : failure;
    }
  }
}

/// The same in the aim plane of ideal microlenses, to which tilted rays are moved first.
template <class Real>
[[gnu::noinline]] void clip_in_plane(const KernelPolygon<Real>& aperture, int surface, int first,
                                     int count, const KernelBlock<Real>& block) {
  const Real* __restrict x = block.x + first;
  const Real* __restrict y = block.y + first;
  const Real* __restrict z = block.z + first;
  const Real* __restrict dx = block.dx + first;
  const Real* __restrict dy = block.dy + first;
  const Real* __restrict dz = block.dz + first;
  int* __restrict code = block.code + first;
  const int vignetted = 4 * surface + kCauseVignetted;
  for (int pair = 0; pair < aperture.pairs; ++pair) {
    const Real nx = aperture.normal_x[pair], ny = aperture.normal_y[pair];
    const Real half = aperture.half_width[pair];
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      const Real px = x[i] - z[i] * (dx[i] / dz[i]), py = y[i] - z[i] * (dy[i] / dz[i]);
      const int failure = magnitude(nx * px + ny * py) <= half ? 0 : vignetted;
      code[i] = code[i] != 0 ? code[i] : failure;
    }
  }
}

template <class Real>
PLENOFLAME_INLINE void pass(const KernelMicrolens<Real>& lens, Real lens_x, Real lens_y, int first,
                            int count, const KernelBlock<Real>& block) {
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
    Directions<Real> before;
    for (int s = 0; s < 2; ++s) {
      if (c.fresnel) before.keep(first, padded, block);
      pass_sphere(c.surfaces[s], c.surface_number[s], first, padded, block);
      if (c.aperture.pairs > 0) clip(c.aperture, c.surface_number[s], first, padded, block);
      if (c.fresnel) lose_reflected(c.coatings[s], before, first, padded, block);
    }
#pragma omp simd
    for (int i = 0; i < padded; ++i) {
      x[i] += lens_x;
      y[i] += lens_y;
    }
  } else if (c.kind == 2) {
    const int number = 4 * c.surface_number[0];
    if (c.aperture.pairs > 0) clip_in_plane(c.aperture, c.surface_number[0], first, padded, block);
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

/// The same for a lens of an array that may be tilted. It works in the axes of the array, about the
/// middle of the lens in its aim plane.
template <class Real>
PLENOFLAME_INLINE void pass_turned(const KernelMicrolens<Real>& lens, Real lens_x, Real lens_y,
                                   int first, int count, const KernelBlock<Real>& block) {
  if (lens.cover_index > Real(0)) pass_cover(lens.cover_index, first, (count + 15) & ~15, block);
  if (!lens.tilted) {
    pass(lens, lens_x, lens_y, first, count, block);
    return;
  }
  const int padded = (count + 15) & ~15;
  turn_rays(lens.turn, false, Real(0), Real(0), Real(0), padded, block, first);
  pass(lens, Real(0), Real(0), first, count, block);
  Real* __restrict z = block.z + first;
  const Real front = lens.front;
  for (int i = 0; i < padded; ++i) z[i] += front;
  turn_rays(lens.turn, true, lens_x, lens_y, lens.depth, padded, block, first);
}

/// Traces rays through an aspheric surface; all rays do each step of Newton's method together.
template <class Shape, class Real>
PLENOFLAME_INLINE void pass_shape(const KernelSurface<Real>& surface, const Shape& shape,
                                  int number, int count, const KernelBlock<Real>& block) {
  Real* __restrict x = block.x;
  Real* __restrict y = block.y;
  Real* __restrict z = block.z;
  Real* __restrict dx = block.dx;
  Real* __restrict dy = block.dy;
  Real* __restrict dz = block.dz;
  int* __restrict code = block.code;
  const KernelSurface<Real> c = surface;
  const Shape s = shape;
#pragma omp simd
  for (int i = 0; i < count; ++i) go_to_vertex(c.gap, x[i], y[i], z[i], dx[i], dy[i], dz[i]);
  for (int step = 0; step < kShapeSteps; ++step) {
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      Real px = x[i], py = y[i], pz = z[i];
      approach_shape(s, px, py, pz, dx[i], dy[i], dz[i]);
      x[i] = px;
      y[i] = py;
      z[i] = pz;
    }
  }
  const int base = 4 * number;
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    Real vx = dx[i], vy = dy[i], vz = dz[i];
    int status = code[i];
    leave_shape(c, s, base, x[i], y[i], z[i], vx, vy, vz, status);
    dx[i] = vx;
    dy[i] = vy;
    dz[i] = vz;
    code[i] = status;
  }
}

/// Stores where rays have just passed the stop.
template <class Real>
[[gnu::noinline]] void keep_stop_crossing(const KernelCamera<Real>& camera, int count,
                                          const KernelBlock<Real>& block) {
  const Real per_radius = camera.per_stop_radius;
  for (int i = 0; i < count; ++i) {
    block.stop_x[i] = per_radius * block.x[i];
    block.stop_y[i] = per_radius * block.y[i];
  }
}

/// Stores where rays that reach an ideal lens cross the substitute of its stop (pass_ideal()).
template <class Real>
[[gnu::noinline]] void keep_pupil_crossing(const KernelCamera<Real>& camera, int count,
                                           const KernelBlock<Real>& block) {
  const KernelIdealLens<Real> c = camera.ideal;
  for (int i = 0; i < count; ++i) {
    const Real sx = block.dx[i] / block.dz[i], sy = block.dy[i] / block.dz[i];
    const Real x = block.x[i] + (c.gap - block.z[i]) * sx,
               y = block.y[i] + (c.gap - block.z[i]) * sy;
    block.stop_x[i] = camera.per_stop_radius * (c.stop_height * x + c.stop_slope * sx);
    block.stop_y[i] = camera.per_stop_radius * (c.stop_height * y + c.stop_slope * sy);
  }
}

/// Bends rays that have left the lens by its distortion (LensDistortion::to_scene()). Their
/// positions then refer to the plane of the entrance pupil.
template <class Real>
[[gnu::noinline]] void distort(const KernelDistortion<Real>& distortion, int count,
                               const KernelBlock<Real>& block) {
  Real* __restrict x = block.x;
  Real* __restrict y = block.y;
  Real* __restrict z = block.z;
  Real* __restrict dx = block.dx;
  Real* __restrict dy = block.dy;
  Real* __restrict dz = block.dz;
  int* __restrict code = block.code;
  const KernelDistortion<Real> c = distortion;
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const Real sx = dx[i] / dz[i], sy = dy[i] / dz[i], way = c.pupil_gap - z[i];
    const Real px = x[i] + way * sx, py = y[i] + way * sy;
    const Real goal_x = sx + c.per_distance * px, goal_y = sy + c.per_distance * py;
    Real ux = goal_x, uy = goal_y;
    for (int step = 0; step < kDistortionSteps; ++step) {
      const Real xx = ux * ux, yy = uy * uy, xy = ux * uy, r2 = xx + yy;
      const Real factor = Real(1) + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
      const Real slope = Real(2) * (c.k1 + r2 * (Real(2) * c.k2 + r2 * (Real(3) * c.k3)));
      const Real miss_x = goal_x - factor * ux - Real(2) * c.p1 * xy - c.p2 * (r2 + Real(2) * xx);
      const Real miss_y = goal_y - factor * uy - Real(2) * c.p2 * xy - c.p1 * (r2 + Real(2) * yy);
      const Real a = factor + xx * slope + Real(2) * c.p1 * uy + Real(6) * c.p2 * ux;
      const Real b = xy * slope + Real(2) * c.p1 * ux + Real(2) * c.p2 * uy;
      const Real d = factor + yy * slope + Real(6) * c.p1 * uy + Real(2) * c.p2 * ux;
      const Real inverse = Real(1) / (a * d - b * b);
      ux += inverse * (d * miss_x - b * miss_y);
      uy += inverse * (a * miss_y - b * miss_x);
    }
    const Real tx = ux - c.per_distance * px, ty = uy - c.per_distance * py;
    const Real cosine = Real(1) / square_root(Real(1) + tx * tx + ty * ty);
    const bool beyond = !(goal_x * goal_x + goal_y * goal_y <= c.limit2);
    x[i] = px;
    y[i] = py;
    z[i] = c.pupil_gap;
    dx[i] = tx * cosine;
    dy[i] = ty * cosine;
    dz[i] = cosine;
    code[i] = code[i] == 0 && beyond ? kCauseVignetted : code[i];
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
  if (camera.moved)
    turn_rays(camera.lens_turn, false, camera.lens_shift[0], camera.lens_shift[1],
              camera.lens_shift[2], count, block, 0);
  if (camera.ideal_lens) {
    if (block.stop_x) keep_pupil_crossing(camera, count, block);
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
    Directions<Real> before;
    for (int s = 0; s < camera.surface_count; ++s) {
      if (camera.fresnel) before.keep(0, count, block);
      if (camera.shapes[s].kind != ShapeKind::sphere)
        with_shape(camera.shapes[s], [&](const auto& shape) {
          pass_shape(camera.surfaces[s], shape, camera.surface_number[s], count, block);
        });
      else if (camera.refracts[s])
        pass_sphere(camera.surfaces[s], camera.surface_number[s], 0, count, block);
      else
        pass_stop(camera.surfaces[s], camera.surface_number[s], count, block);
      if (block.stop_x && s == camera.stop) keep_stop_crossing(camera, count, block);
      if (camera.fresnel) lose_reflected(camera.coatings[s], before, 0, count, block);
    }
  }
  if (camera.distortion.present) distort(camera.distortion, count, block);
  const Real gap = camera.exit_gap, ax = camera.anchor_x, ay = camera.anchor_y;
  const Real r0 = camera.rotation[0], r1 = camera.rotation[1], r2 = camera.rotation[2],
             r3 = camera.rotation[3], r4 = camera.rotation[4], r5 = camera.rotation[5],
             r6 = camera.rotation[6], r7 = camera.rotation[7], r8 = camera.rotation[8];
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    // A ray that ended in the camera continues along the axis with weight 0, so that it stays
    // valid.
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
PLENOFLAME_INLINE int count_rays(const int* __restrict code, const Real* __restrict weight,
                                 int count) {
  int alive = 0;
#pragma omp simd reduction(+ : alive)
  for (int i = 0; i < count; ++i) alive += (code[i] == 0) & (weight[i] > Real(0)) ? 1 : 0;
  return alive;
}

}  // namespace

void pass_microlens(const KernelMicrolens<float>& lens, float lens_x, float lens_y, int first,
                    int count, const KernelBlock<float>& block) {
  pass_turned(lens, lens_x, lens_y, first, count, block);
}

void pass_microlens(const KernelMicrolens<double>& lens, double lens_x, double lens_y, int first,
                    int count, const KernelBlock<double>& block) {
  pass_turned(lens, lens_x, lens_y, first, count, block);
}

void trace_lens(const KernelCamera<float>& camera, int count, const KernelBlock<float>& block) {
  trace(camera, count, block);
}

void trace_lens(const KernelCamera<double>& camera, int count, const KernelBlock<double>& block) {
  trace(camera, count, block);
}

int count_alive(const int* code, const float* weight, int count) {
  return count_rays(code, weight, count);
}

int count_alive(const int* code, const double* weight, int count) {
  return count_rays(code, weight, count);
}

}  // namespace plenoflame::PLENOFLAME_ISA
