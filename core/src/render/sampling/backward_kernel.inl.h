// Vector kernels of the backward estimator; compiled once per instruction set.
#include "render/sampling/backward_kernel.h"

#include "math/kernel_math.h"
#include "render/sampling/aim_edges_kernel.inl.h"
#include "render/sampling/sided_aperture_kernel.inl.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

PLENOFLAME_INLINE float to_unit(std::uint32_t fraction, float) {
  // 23 bits and half a step give numbers in (0, 1) without its ends.
  return static_cast<float>(static_cast<std::int32_t>(fraction >> 9)) * 0x1p-23f + 0x1p-24f;
}
PLENOFLAME_INLINE double to_unit(std::uint32_t fraction, double) {
  return static_cast<double>(fraction) * 0x1p-32 + 0x1p-33;
}

/// sin(2 pi b) for |b| <= 1/4, by its Taylor series to b^13; the error at the end is 6e-10.
template <class Real>
PLENOFLAME_INLINE Real sin_turn(Real b) {
  const Real x = Real(6.283185307179586477) * b, x2 = x * x;
  return x * (Real(1) +
              x2 * (Real(-1.0 / 6) +
                    x2 * (Real(1.0 / 120) +
                          x2 * (Real(-1.0 / 5040) + x2 * (Real(1.0 / 362880) +
                                                          x2 * (Real(-1.0 / 39916800) +
                                                                x2 * Real(1.0 / 6227020800.0)))))));
}

constexpr int kBlockOfLookups = 16;

/// Cuts (-low, high, low_far, -high_far) of several rays.
template <class Real>
PLENOFLAME_INLINE void look_up_cuts(const CutColumn& c, const int* __restrict step,
                                    const Real* __restrict part, Real* __restrict low,
                                    Real* __restrict high, Real* __restrict low_far,
                                    Real* __restrict high_far) {
#pragma omp simd
  for (int i = 0; i < kBlockOfLookups; ++i) {
    const int k = step[i];
    low[i] = -(Real(c.value[0][k]) + Real(c.rise[0][k]) * part[i]);
    high[i] = Real(c.value[1][k]) + Real(c.rise[1][k]) * part[i];
    low_far[i] = Real(c.value[2][k]) + Real(c.rise[2][k]) * part[i];
    high_far[i] = -(Real(c.value[3][k]) + Real(c.rise[3][k]) * part[i]);
  }
}

#if defined(__GNUC__) && !defined(__clang__) && defined(__AVX2__)
// Tables are in registers: gathering from memory would take longer than the rest of the kernel.
#ifdef __AVX512F__
typedef float Lanes __attribute__((vector_size(64)));
typedef int LaneNumbers __attribute__((vector_size(64)));
#else
typedef float Lanes __attribute__((vector_size(32)));
typedef int LaneNumbers __attribute__((vector_size(32)));
#endif
constexpr int kLanes = sizeof(Lanes) / sizeof(float);
// Vectors in arrays of floats, aligned or not.
typedef Lanes LooseLanes __attribute__((aligned(4), may_alias));
typedef LaneNumbers LooseLaneNumbers __attribute__((aligned(4), may_alias));

PLENOFLAME_INLINE Lanes look_up(const float* table, LaneNumbers number) {
  const LooseLanes* parts = reinterpret_cast<const LooseLanes*>(table);
  if constexpr (kLanes == CutColumn::kSteps) return __builtin_shuffle(Lanes(parts[0]), number);
  const Lanes first = __builtin_shuffle(Lanes(parts[0]), number),
              second = __builtin_shuffle(Lanes(parts[1]), number);
  return number < kLanes ? first : second;
}

PLENOFLAME_INLINE void look_up_cuts(const CutColumn& c, const int* step, const float* part,
                                    float* low, float* high, float* low_far, float* high_far) {
  for (int i = 0; i < kBlockOfLookups; i += kLanes) {
    const LaneNumbers k = *reinterpret_cast<const LooseLaneNumbers*>(step + i);
    const Lanes t = *reinterpret_cast<const LooseLanes*>(part + i);
    const auto side = [&](int j) __attribute__((always_inline)) {
      return look_up(c.value[j], k) + look_up(c.rise[j], k) * t;
    };
    *reinterpret_cast<LooseLanes*>(low + i) = -side(0);
    *reinterpret_cast<LooseLanes*>(high + i) = side(1);
    *reinterpret_cast<LooseLanes*>(low_far + i) = side(2);
    *reinterpret_cast<LooseLanes*>(high_far + i) = -side(3);
  }
}
#endif

/// Makes the SensorSamples of one pixel.
///
/// The sensor point is drawn in the lit part of the pixel, inside a disc about the micro-image's
/// centre. Its column is drawn first, then its row in the chord. The larger part of the work,
/// aim_rays(), runs over all pixels at once, so that its vectors are full.
/// @param steps position of the point in the pixel's cuts
template <class Real>
PLENOFLAME_INLINE void place_rays(const KernelFrame<Real>& c, const KernelPixel<Real>& pixel,
                                  const KernelBlock<Real>& block, Real* __restrict steps) {
  const std::uint32_t* f0 = pixel.fractions[0];
  const std::uint32_t* f1 = pixel.fractions[1];
  const std::uint32_t* f2 = pixel.fractions[2];
  const std::uint32_t* f3 = pixel.fractions[3];
  const std::uint32_t h0 = pixel.shift[0], h1 = pixel.shift[1], h2 = pixel.shift[2],
                      h3 = pixel.shift[3];
  const std::uint32_t* numbers = pixel.replicate_numbers;
  const std::uint32_t g0 = pixel.second_shift[0], g1 = pixel.second_shift[1],
                      g2 = pixel.second_shift[2], g3 = pixel.second_shift[3];
  const Real x_low = pixel.x_low, x_width = pixel.x_width, y0 = pixel.y0, y1 = pixel.y1;
  const Real radius2 = pixel.radius2;
  const Real centre_x = c.centre_x, centre_y = c.centre_y;
  const Real opens = Real(pixel.cuts->opens), per_metre = Real(pixel.cuts->steps_per_metre);
  const int first = pixel.first;
  const SensorSamples<Real> samples = sensor_samples(block, first);
  Real* __restrict x = samples.x;
  Real* __restrict y = samples.y;
  Real* __restrict area = samples.area;
  Real* __restrict radius = samples.pupil_radius;
  Real* __restrict turn = samples.pupil_turn;
  Real* __restrict step = steps + first;
  const auto place = [&](int begin) __attribute__((always_inline)) {
#pragma omp simd
    for (int i = begin; i < begin + kBlockOfLookups; ++i) {
      const std::uint32_t number = numbers[i];
      const Real sx = x_low + x_width * to_unit(f0[i] ^ h0 ^ g0 * number, Real());
      const Real wx = sx - centre_x;
      const Real chord = square_root(magnitude(radius2 - wx * wx));
      const Real top = greatest(y0, centre_y - chord);
      const Real height = greatest(least(y1, centre_y + chord) - top, Real(0));
      const Real sy = top + height * to_unit(f1[i] ^ h1 ^ g1 * number, Real());
      const Real wy = sy - centre_y;
      x[i] = sx;
      y[i] = sy;
      area[i] = x_width * height;
      radius[i] = to_unit(f2[i] ^ h2 ^ g2 * number, Real());
      turn[i] = to_unit(f3[i] ^ h3 ^ g3 * number, Real()) - Real(0.5);
      step[i] = (square_root(wx * wx + wy * wy) - opens) * per_metre;
    }
  };
  if (pixel.count <= kBlockOfLookups) {
    place(0);  // without the loop, whose set-up takes as long as its body
  } else {
    for (int begin = 0; begin < pixel.count; begin += kBlockOfLookups) place(begin);
  }
}

/// Makes the SensorSamples of one pixel that also records light from beside it. The blur spreads
/// the points in both directions. Points without light have the weight 0.
/// @param steps position of the point in the pixel's cuts
template <class Real>
PLENOFLAME_INLINE void place_blurred_rays(const KernelFrame<Real>& c,
                                          const KernelPixel<Real>& pixel,
                                          const KernelBlock<Real>& block, Real* __restrict steps) {
  using Blur = KernelBlur<Real>;
  const Blur& blur = *c.blur;
  const std::uint32_t* numbers = pixel.replicate_numbers;
  const Real radius2 = pixel.radius2;
  const Real opens = Real(pixel.cuts->opens), per_metre = Real(pixel.cuts->steps_per_metre);
  const Real scale = c.pitch_x * pixel.x_width * c.pitch_y * (pixel.y1 - pixel.y0);
  const SensorSamples<Real> samples = sensor_samples(block, pixel.first);
  const auto number = [&](int d, int i) __attribute__((always_inline)) {
    const std::uint32_t shift = pixel.shift[d] ^ pixel.second_shift[d] * numbers[i];
    return to_unit(pixel.fractions[d][i] ^ shift, Real());
  };
  const auto spread = [&](Real share, Real & weight) __attribute__((always_inline)) {
    const Real at = clamp(share, Real(0), Real(1)) * Real(Blur::kCells);
    const int cell = least(static_cast<int>(at), Blur::kCells - 1);
    const Real part = at - static_cast<Real>(cell);
    weight = blur.low[cell] + part * (blur.high[cell] - blur.low[cell]);
    return blur.at[cell] + part * (blur.at[cell + 1] - blur.at[cell]);
  };
  const int padded = (pixel.count + kBlockOfLookups - 1) / kBlockOfLookups * kBlockOfLookups;
  for (int i = 0; i < padded; ++i) {
    Real along, across;
    const Real sx = pixel.x + c.pitch_x * spread(pixel.x_low + pixel.x_width * number(0, i), along);
    const Real sy =
        pixel.y + c.pitch_y * spread(pixel.y0 + (pixel.y1 - pixel.y0) * number(1, i), across);
    const Real wx = sx - c.centre_x, wy = sy - c.centre_y, distance2 = wx * wx + wy * wy;
    const bool lit = distance2 <= radius2;
    // Dark points, too, are moved to a place from which rays can be aimed.
    const Real pull = lit ? Real(1) : square_root(radius2 / distance2);
    samples.x[i] = c.centre_x + pull * wx;
    samples.y[i] = c.centre_y + pull * wy;
    samples.area[i] = lit ? scale * along * across : Real(0);
    samples.pupil_radius[i] = number(2, i);
    samples.pupil_turn[i] = number(3, i) - Real(0.5);
    steps[pixel.first + i] = (pull * square_root(distance2) - opens) * per_metre;
  }
}

/// Makes the PupilExtents of the samples.
template <class Real>
PLENOFLAME_INLINE void cut_rays(const KernelPixel<Real>& pixel, const KernelBlock<Real>& block,
                                const Real* __restrict steps) {
  const int first = pixel.first;
  const PupilExtents<Real> extents = pupil_extents(block, first);
  Real* __restrict low = extents.low;
  Real* __restrict high = extents.high;
  Real* __restrict low_far = extents.low_far;
  Real* __restrict high_far = extents.high_far;
  const Real* __restrict at = steps + first;
  const CutColumn& cuts = *pixel.cuts;
  alignas(64) int step[kBlockOfLookups];
  alignas(64) Real part[kBlockOfLookups];
  for (int begin = 0; begin < pixel.count; begin += kBlockOfLookups) {
#pragma omp simd
    for (int k = 0; k < kBlockOfLookups; ++k) {
      const Real d = clamp(at[begin + k], Real(0), Real(CutColumn::kSteps));
      step[k] = least(static_cast<int>(d), CutColumn::kSteps - 1);
      part[k] = d - static_cast<Real>(step[k]);
    }
    look_up_cuts(cuts, step, part, low + begin, high + begin, low_far + begin, high_far + begin);
  }
}

/// Keeps the nearer one of two bounds. An inner point is at (p, q) from the middle of a disc. In
/// the direction v the disc reaches as far as the positive solution r of v^2 r^2 + 2 product r =
/// room.
///
/// The arguments `product` and `squares` = product^2 + v^2 room describe the nearest disc so far.
/// Roots are accurate to 6.5e-4. The kept bound is never nearer than the nearest disc. It is
/// farther by about the accuracy of the roots. For a very large disc, root and product nearly
/// cancel, and the bound is farther by up to some percent.
template <class Real>
PLENOFLAME_INLINE void keep_nearest(Real of_this, Real room, Real v2, Real& product, Real& squares,
                                    Real& rough_reach) {
  const Real these = of_this * of_this + v2 * room;
  const Real rough = near_square_root(these) - of_this;
  const bool nearer = rough < rough_reach;
  product = nearer ? of_this : product;
  squares = nearer ? these : squares;
  rough_reach = nearer ? rough : rough_reach;
}

/// The discs of the microlens' own apertures, seen from s, along a direction e and across it.
template <class Real>
PLENOFLAME_INLINE void place_own_discs(const KernelFrame<Real>& c, Real sx, Real sy, Real ex,
                                       Real ey, Real& near_p, Real& near_q, Real& far, Real& far_p,
                                       Real& far_q) {
  const Real along = sx * ex + sy * ey, beside = sy * ex - sx * ey, s2 = sx * sx + sy * sy;
  const Real shift = c.far_shift + c.far_bend * s2;
  near_p = c.near_shift * along;
  near_q = c.near_shift * beside;
  far = c.far_radius + c.far_growth * s2;
  far_p = shift * along;
  far_q = shift * beside;
}

/// Makes PupilAims of SensorSamples and PupilExtents, mostly in the same memory. The inner
/// point is inside the part of the aperture that sees the scene. Aim points are in all directions
/// from it, as far as the bounds of this part.
///
/// The bounds are four discs. Two are the apertures of the microlens. The part's extent along the
/// line through the frame's centre ends at `low` and `high`. The other two discs pass through these
/// ends and are centred on that line. Directions are those of a unit disc that is stretched to the
/// part's length and width. Sides of apertures bound the part, too. If nothing else cuts them,
/// directions follow the edge of the polygon, evenly in the area that they sweep. Directions of a
/// disc would have larger weights, and more noise, towards its corners.
///
/// The code uses two loops: a single one is too long for the processor to look ahead to the next
/// rays.
/// @tparam kPairs of sides; 0: apertures are circles
template <int kPairs, class Real>
PLENOFLAME_INLINE void aim_rays(const KernelFrame<Real>& c, int first, int count,
                                const KernelBlock<Real>& block) {
  const SensorSamples<Real> samples = sensor_samples(block, first);
  const PupilExtents<Real> extents = pupil_extents(block, first);
  const PupilAims<Real> aims = pupil_aims(block, first);
  const Real centre_x = c.centre_x, centre_y = c.centre_y;
  const Real origin_x = c.origin_x, origin_y = c.origin_y, origin_shift = c.origin_shift;
  const Real near = c.near_radius, least_room = Real(1e-4) * near * near;
  const int padded = (count + 15) & ~15;
  alignas(64) Real away_x[kBlockRays + kBlockSlack], away_y[kBlockRays + kBlockSlack];
  alignas(64) Real inner_p[kBlockRays + kBlockSlack], inner_q[kBlockRays + kBlockSlack];
  alignas(64) Real half_length[kBlockRays + kBlockSlack], half_width[kBlockRays + kBlockSlack];
  constexpr int kKept = kPairs > 0 ? kPairs : 1;
  [[maybe_unused]] alignas(64) Real uncut[kPairs > 0 ? kBlockRays + kBlockSlack : 1];
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real sx = samples.x[i], sy = samples.y[i];
    // The centre itself needs some direction, too.
    const Real wx = sx - centre_x + Real(1e-15), wy = sy - centre_y;
    const Real inverse_w = inverse_square_root(wx * wx + wy * wy);
    const Real ex = wx * inverse_w, ey = wy * inverse_w;

    Real near_p, near_q, far, far_p, far_q;
    place_own_discs(c, sx, sy, ex, ey, near_p, near_q, far, far_p, far_q);
    const Real cut_low = extents.low[i], cut_high = extents.high[i];
    const Real cut_low_far = extents.low_far[i], cut_high_far = extents.high_far[i];
    Real low = greatest(cut_low, greatest(near_p - near, far_p - far)),
         high = least(cut_high, least(near_p + near, far_p + far));
    [[maybe_unused]] bool between = false;
    [[maybe_unused]] SidedAperture<Real, kKept> sided{};
    if constexpr (kPairs > 0) {
      sided = sided_aperture<kPairs>(c, sx, sy, ex, ey);
      Real side_low = low, side_high = high;
      for (int k = 0; k < kPairs; ++k) {
        keep_between(c.near_half[k], sided.of_e[k], -sided.of_q[k] * near_q, near_p, side_low,
                     side_high);
        keep_between(c.far_half[k], sided.of_e[k], -sided.of_q[k] * far_q, far_p, side_low,
                     side_high);
      }
      // If the visible part of the aperture is beside the line, in a corner, discs bound it.
      between = side_high - side_low > Real(0.02) * near;
      low = between ? side_low : low;
      high = between ? side_high : high;
    }

    // The inner point (p, q), and half the length and width there. Bounds that exclude the point
    // are extended to it: all of them lie near the line.
    const Real half = greatest(Real(0.5) * (high - low), Real(0));
    const Real p = Real(0.5) * (low + high);
    const Real from_near = p - near_p, from_far = p - far_p;
    const Real cut2 = least((p - cut_low) * (cut_low_far - p), (cut_high - p) * (p - cut_high_far));
    const Real cut_half = rough_square_root(greatest(cut2, least_room));
    const Real near_half =
        rough_square_root(greatest(near * near - from_near * from_near, least_room));
    const Real far_half = rough_square_root(greatest(far * far - from_far * from_far, least_room));
    Real top = least(cut_half, least(near_q + near_half, far_q + far_half));
    Real bottom = greatest(-cut_half, greatest(near_q - near_half, far_q - far_half));
    if constexpr (kPairs > 0) {
      Real side_bottom = bottom, side_top = top;
      for (int k = 0; k < kPairs; ++k) {
        keep_between(c.near_half[k], sided.of_q[k], sided.of_e[k] * from_near, near_q, side_bottom,
                     side_top);
        keep_between(c.far_half[k], sided.of_q[k], sided.of_e[k] * from_far, far_q, side_bottom,
                     side_top);
      }
      top = between ? side_top : top;
      bottom = between ? side_bottom : bottom;
    }
    away_x[i] = ex;
    away_y[i] = ey;
    inner_p[i] = p;
    inner_q[i] = Real(0.5) * (top + bottom);
    half_length[i] = half;
    half_width[i] = greatest(Real(0.5) * (top - bottom), Real(0.01) * near);
    if constexpr (kPairs > 0) {
      const bool is_all =
          is_uncut<kPairs>(sided, cut_low, cut_high, cut_low_far, cut_high_far, Real(0.01) * near);
      inner_p[i] = is_all ? sided.p : inner_p[i];
      inner_q[i] = is_all ? sided.q : inner_q[i];
      uncut[i] = is_all ? Real(1) : Real(0);
    }
  }
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real sx = samples.x[i], sy = samples.y[i], ex = away_x[i], ey = away_y[i];
    Real near_p, near_q, far, far_p, far_q;
    place_own_discs(c, sx, sy, ex, ey, near_p, near_q, far, far_p, far_q);
    const Real cut_low = extents.low[i], cut_high = extents.high[i];
    const Real cut_low_far = extents.low_far[i], cut_high_far = extents.high_far[i];
    const Real p = inner_p[i], q = inner_q[i], half = half_length[i], width = half_width[i];
    const Real from_near = p - near_p, from_far = p - far_p;
    const Real t = samples.pupil_turn[i], share = samples.pupil_radius[i];
    const Real folded = least(greatest(t, Real(-0.5) - t), Real(0.5) - t);
    Real vp = half * sin_turn(Real(0.25) - magnitude(t)), vq = width * sin_turn(folded);
    Real area = Real(3.141592653589793238) * half * width;
    if constexpr (kPairs > 0) {
      const auto sided = sided_aperture<kPairs>(c, sx, sy, ex, ey);
      Real edge_p, edge_q;
      way_to_edge<kPairs>(sided, t, edge_p, edge_q);
      const bool is_all = uncut[i] > Real(0);
      vp = is_all ? edge_p : vp;
      vq = is_all ? edge_q : vq;
      area = is_all ? sided.area() : area;
    }
    const Real v2 = vp * vp + vq * vq;
    const Real near_dq = q - near_q, far_dq = q - far_q;
    const Real low_middle = p - Real(0.5) * (cut_low + cut_low_far),
               high_middle = p - Real(0.5) * (cut_high + cut_high_far);
    const Real inverse_v2 = Real(1) / (v2 + Real(1e-30));
    const Real of_near = from_near * vp + near_dq * vq;
    const Real near_squares =
        of_near * of_near +
        v2 * greatest(near * near - from_near * from_near - near_dq * near_dq, least_room);
    Real product = from_far * vp + far_dq * vq;
    Real squares = product * product +
                   v2 * greatest(far * far - from_far * from_far - far_dq * far_dq, least_room);
    Real rough_reach = near_square_root(squares) - product;
    keep_nearest(low_middle * vp + q * vq,
                 greatest((p - cut_low) * (cut_low_far - p) - q * q, least_room), v2, product,
                 squares, rough_reach);
    keep_nearest(high_middle * vp + q * vq,
                 greatest((cut_high - p) * (p - cut_high_far) - q * q, least_room), v2, product,
                 squares, rough_reach);

    aims.area[i] = area * samples.area[i];
    aims.inner_x[i] = origin_x + origin_shift * sx + ex * p - ey * q;
    aims.inner_y[i] = origin_y + origin_shift * sy + ey * p + ex * q;
    aims.way_x[i] = ex * vp - ey * vq;
    aims.way_y[i] = ey * vp + ex * vq;
    aims.bound[i] =
        least(square_root(squares) - product, square_root(near_squares) - of_near) * inverse_v2;
    aims.root_share[i] = square_root(share);
  }
}

/// Makes rays of PupilAims, in the memory of all columns. All weights are exact Jacobians: a bound
/// that is too wide costs time and loses no light.
template <class Real>
PLENOFLAME_INLINE void finish_rays(int first, int count, Real distance,
                                   const KernelBlock<Real>& block) {
  const PupilAims<Real> aims = pupil_aims(block, first);
  Real* x = block.x + first;
  Real* y = block.y + first;
  Real* z = block.z + first;
  Real* dx = block.dx + first;
  Real* dy = block.dy + first;
  Real* dz = block.dz + first;
  Real* weight = block.weight + first;
  int* __restrict code = block.code + first;
  const Real g2 = distance * distance;
  const int padded = (count + 15) & ~15;
#pragma omp simd
  for (int i = 0; i < padded; ++i) {
    const Real r = aims.bound[i], along = r * aims.root_share[i];
    const Real ux = aims.inner_x[i] + along * aims.way_x[i],
               uy = aims.inner_y[i] + along * aims.way_y[i];
    const Real vx = ux - x[i], vy = uy - y[i];
    const Real inverse = inverse_square_root(vx * vx + vy * vy + g2);
    const Real inverse2 = inverse * inverse;
    // cos(theta) dOmega = cos^2 / r^2 dA' on parallel planes.
    weight[i] = r * r * aims.area[i] * (g2 * inverse2 * inverse2);
    x[i] = ux;
    y[i] = uy;
    z[i] = Real(0);
    dx[i] = vx * inverse;
    dy[i] = vy * inverse;
    dz[i] = distance * inverse;
    code[i] = 0;
  }
}

template <class Real>
PLENOFLAME_INLINE void generate_all(const KernelFrame<Real>& frame, const KernelPixel<Real>* pixels,
                                    int count, Real distance, const KernelBlock<Real>& block) {
  const KernelFrame<Real> c = frame;  // a copy, which writes to the block cannot change
  alignas(64) Real steps[kBlockRays + kBlockSlack];
  for (int i = 0; i < count; ++i)
    if (c.blur)
      place_blurred_rays(c, pixels[i], block, steps);
    else
      place_rays(c, pixels[i], block, steps);
  for (int i = 0; i < count; ++i) cut_rays(pixels[i], block, steps);
  const int first = pixels[0].first;
  const int rays = pixels[count - 1].first + pixels[count - 1].count - first;
  switch (c.side_pairs) {
    case 2:
      aim_rays<2>(c, first, rays, block);
      break;
    case 3:
      aim_rays<3>(c, first, rays, block);
      break;
    default:
      aim_rays<0>(c, first, rays, block);
  }
  if (c.side_pairs > 0) find_sides(c, first, rays, distance, block);
  if (c.finds_far) find_far_rim(c, first, rays, block);
  if (c.finds_stop) find_stop(c, first, rays, block);
  finish_rays(first, rays, distance, block);
}

template <class Real>
PLENOFLAME_INLINE void multiply_all(const Real* __restrict weight, const Real* __restrict radiance,
                                    int count, Real* __restrict products) {
#pragma omp simd
  for (int i = 0; i < count; ++i) products[i] = weight[i] * radiance[i];
}

template <class Real>
PLENOFLAME_INLINE void add_all_neighbours(const Real* __restrict near, const Real* __restrict far,
                                          int count, Real* __restrict sums) {
#pragma omp simd
  for (int i = 0; i < count; ++i) sums[i] = near[i] + far[i];
}

template <class Real>
PLENOFLAME_INLINE double sum_all(const Real* weight, const Real* radiance, int count) {
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (int i = 0; i < count; ++i)
    sum += static_cast<double>(weight[i]) * static_cast<double>(radiance[i]);
  return sum;
}

}  // namespace

void generate(const KernelFrame<float>& frame, const KernelPixel<float>* pixels, int count,
              float distance, const KernelBlock<float>& block) {
  generate_all(frame, pixels, count, distance, block);
}

void generate(const KernelFrame<double>& frame, const KernelPixel<double>* pixels, int count,
              double distance, const KernelBlock<double>& block) {
  generate_all(frame, pixels, count, distance, block);
}

void multiply(const float* weight, const float* radiance, int count, float* products) {
  multiply_all(weight, radiance, count, products);
}

void multiply(const double* weight, const double* radiance, int count, double* products) {
  multiply_all(weight, radiance, count, products);
}

void add_neighbours(const float* values, int distance, int count, float* sums) {
  add_all_neighbours(values, values + distance, count, sums);
}

void add_neighbours(const double* values, int distance, int count, double* sums) {
  add_all_neighbours(values, values + distance, count, sums);
}

double sum(const float* weight, const float* radiance, int count) {
  return sum_all(weight, radiance, count);
}

double sum(const double* weight, const double* radiance, int count) {
  return sum_all(weight, radiance, count);
}

}  // namespace plenoflame::PLENOFLAME_ISA
