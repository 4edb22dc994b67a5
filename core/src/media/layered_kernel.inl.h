// Radiance through homogeneous ellipsoids. Each step is a plain loop over a block of independent
// rays, which the compiler turns into vector code.
#include "math/kernel_exp.h"
#include "media/layered_kernel.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

constexpr double kLog2E = 1.44269504088896340736;

/// Views into the scratch memory: arrays of kLayeredBlock values.
template <class Real>
struct LayeredScratch {
  Real *px, *py, *pz, *dx, *dy, *dz, *near, *far;
  Real* entry;   // layers arrays
  Real* exit;    // layers arrays
  Real* weight;  // layers arrays: transmittance in front times emissivity, summed over a layer
  Real* ends;    // 2 * layers arrays, sorted (overlapping layers only)
  Real *shift, *kappa, *winner;
  Real* passed;  // transmittance of a channel that is not requested
};

template <class Real>
PLENOFLAME_INLINE LayeredScratch<Real> make_scratch(Real* p, int layers) {
  constexpr int n = kLayeredBlock;
  LayeredScratch<Real> s;
  s.px = p, s.py = p + n, s.pz = p + 2 * n, s.dx = p + 3 * n, s.dy = p + 4 * n, s.dz = p + 5 * n;
  s.near = p + 6 * n, s.far = p + 7 * n;
  p += 8 * n;
  s.entry = p, s.exit = p + layers * n, s.weight = p + 2 * layers * n, s.ends = p + 3 * layers * n;
  p += 5 * layers * n;
  s.shift = p, s.kappa = p + n, s.winner = p + 2 * n, s.passed = p + 3 * n;
  return s;
}

/// Transforms rays into the local frame. Each ray's point moves to where the ray passes the
/// medium's origin, so every later t has the medium's size and keeps its digits.
template <class Real>
PLENOFLAME_INLINE void localise(const LayeredTask<Real>& task, int first, int count,
                                const LayeredScratch<Real>& s) {
  const Real* __restrict x = task.position[0] + first;
  const Real* __restrict y = task.position[1] + first;
  const Real* __restrict z = task.position[2] + first;
  const Real* __restrict u = task.direction[0] + first;
  const Real* __restrict v = task.direction[1] + first;
  const Real* __restrict w = task.direction[2] + first;
  Real* __restrict px = s.px, * __restrict py = s.py, * __restrict pz = s.pz;
  Real* __restrict dx = s.dx, * __restrict dy = s.dy, * __restrict dz = s.dz;
  Real* __restrict shift = s.shift;
  const Real r0 = task.rotation[0], r1 = task.rotation[1], r2 = task.rotation[2];
  const Real r3 = task.rotation[3], r4 = task.rotation[4], r5 = task.rotation[5];
  const Real r6 = task.rotation[6], r7 = task.rotation[7], r8 = task.rotation[8];
  const Real ax = task.anchor[0], ay = task.anchor[1], az = task.anchor[2];
  const auto nearest = [&](int i, Real lx, Real ly, Real lz, Real a, Real b, Real c)
      __attribute__((always_inline)) {
    const Real t = -(lx * a + ly * b + lz * c);
    px[i] = lx + t * a;
    py[i] = ly + t * b;
    pz[i] = lz + t * c;
    dx[i] = a;
    dy[i] = b;
    dz[i] = c;
    shift[i] = t;
  };
  if (task.rotated) {
#pragma omp simd
    for (int i = 0; i < count; ++i)
      nearest(i, r0 * x[i] + r1 * y[i] + r2 * z[i] + ax, r3 * x[i] + r4 * y[i] + r5 * z[i] + ay,
              r6 * x[i] + r7 * y[i] + r8 * z[i] + az, r0 * u[i] + r1 * v[i] + r2 * w[i],
              r3 * u[i] + r4 * v[i] + r5 * w[i], r6 * u[i] + r7 * v[i] + r8 * w[i]);
  } else {
#pragma omp simd
    for (int i = 0; i < count; ++i) nearest(i, x[i] + ax, y[i] + ay, z[i] + az, u[i], v[i], w[i]);
  }
  if (!task.t_near && !task.t_far) return;
  Real* __restrict near = s.near, * __restrict far = s.far;
  const Real infinity = Real(__builtin_inff());
  if (task.t_near) {
    const Real* __restrict t = task.t_near + first;
#pragma omp simd
    for (int i = 0; i < count; ++i) near[i] = t[i] - shift[i];
  } else {
#pragma omp simd
    for (int i = 0; i < count; ++i) near[i] = -infinity;
  }
  if (task.t_far) {
    const Real* __restrict t = task.t_far + first;
#pragma omp simd
    for (int i = 0; i < count; ++i) far[i] = t[i] - shift[i];
  } else {
#pragma omp simd
    for (int i = 0; i < count; ++i) far[i] = infinity;
  }
}

/// The interval in which the rays are inside of one layer. In the space where the ellipsoid is the
/// unit sphere, q is the ray's point nearest to the centre. Half the chord is sqrt((1 - q.q) /
/// (v.v)), which loses no digits to the distance. A miss gives an empty interval.
/// @param low, high what the interval is clamped to, if kClamped
template <bool kClamped, class Real>
PLENOFLAME_INLINE void intersect(const LayeredTask<Real>& task, int layer, int count,
                                 const LayeredScratch<Real>& s, const Real* __restrict low,
                                 const Real* __restrict high) {
  const Real* g = task.geometry + 6 * layer;
  const Real cx = g[0], cy = g[1], cz = g[2], ix = g[3], iy = g[4], iz = g[5];
  const Real* __restrict px = s.px, * __restrict py = s.py, * __restrict pz = s.pz;
  const Real* __restrict dx = s.dx, * __restrict dy = s.dy, * __restrict dz = s.dz;
  Real* __restrict entry = s.entry + layer * kLayeredBlock;
  Real* __restrict exit = s.exit + layer * kLayeredBlock;
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const Real ux = px[i] * ix - cx, uy = py[i] * iy - cy, uz = pz[i] * iz - cz;
    const Real vx = dx[i] * ix, vy = dy[i] * iy, vz = dz[i] * iz;
    const Real inverse = Real(1) / (vx * vx + vy * vy + vz * vz);
    const Real t = -(ux * vx + uy * vy + uz * vz) * inverse;
    const Real qx = ux + t * vx, qy = uy + t * vy, qz = uz + t * vz;
    const Real inside = Real(1) - (qx * qx + qy * qy + qz * qz);
    const Real half = square_root(greatest(inside, Real(0)) * inverse);
    entry[i] = kClamped ? clamp(t - half, low[i], high[i]) : t - half;
    exit[i] = kClamped ? clamp(t + half, low[i], high[i]) : t + half;
  }
}

/// Longest chord so far, which tells the rays that meet any layer.
template <class Real>
PLENOFLAME_INLINE void lengthen(int count, const Real* __restrict entry,
                                const Real* __restrict exit, Real* __restrict longest) {
#pragma omp simd
  for (int i = 0; i < count; ++i) longest[i] = greatest(exit[i] - entry[i], longest[i]);
}

template <class Real>
PLENOFLAME_INLINE int count_positive(int count, const Real* __restrict values) {
  int positive = 0;
#pragma omp simd reduction(+ : positive)
  for (int i = 0; i < count; ++i) positive += values[i] > Real(0) ? 1 : 0;
  return positive;
}

/// One homogeneous interval [from, to] of a layer, behind the intervals passed so far (none, if
/// kFirst). Its emission is added to `weight`, or replaces it if kNew.
template <bool kFirst, bool kNew, class Real>
PLENOFLAME_INLINE void pass(int count, Real kappa, const Real* __restrict from,
                            const Real* __restrict to, Real* __restrict transmittance,
                            Real* __restrict weight) {
  const Real halvings = kappa * Real(kLog2E);
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const Attenuation<Real> a = attenuation_of_halvings(halvings * (to[i] - from[i]));
    const Real arrives = kFirst ? a.emissivity : transmittance[i] * a.emissivity;
    weight[i] = kNew ? arrives : weight[i] + arrives;
    transmittance[i] = kFirst ? a.transmittance : transmittance[i] * a.transmittance;
  }
}

/// Layers of which each lies inside the next: from the outermost inwards, and out again.
template <class Real>
PLENOFLAME_INLINE void pass_nested(const LayeredTask<Real>& task, const Real* absorption, int count,
                                   const LayeredScratch<Real>& s, Real* transmittance) {
  constexpr int n = kLayeredBlock;
  const int last = task.layers - 1;
  if (last == 0) {
    pass<true, true>(count, absorption[0], s.entry, s.exit, transmittance, s.weight);
    return;
  }
  pass<true, true>(count, absorption[last], s.entry + last * n, s.entry + (last - 1) * n,
                   transmittance, s.weight + last * n);
  for (int k = last - 1; k > 0; --k)
    pass<false, true>(count, absorption[k], s.entry + k * n, s.entry + (k - 1) * n, transmittance,
                      s.weight + k * n);
  pass<false, true>(count, absorption[0], s.entry, s.exit, transmittance, s.weight);
  for (int k = 1; k <= last; ++k)
    pass<false, false>(count, absorption[k], s.exit + (k - 1) * n, s.exit + k * n, transmittance,
                       s.weight + k * n);
}

template <class Real>
PLENOFLAME_INLINE void order(int count, Real* __restrict a, Real* __restrict b) {
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    const Real low = least(a[i], b[i]), high = greatest(a[i], b[i]);
    a[i] = low;
    b[i] = high;
  }
}

/// Sorts the ends of all intervals per ray: Batcher's odd-even merge sort for any count (Knuth, The
/// Art of Computer Programming 3, 5.2.2 M). Pairs (entry, exit) are in order already.
template <class Real>
PLENOFLAME_INLINE void sort_ends(int layers, int count, const LayeredScratch<Real>& s) {
  constexpr int n = kLayeredBlock;
  for (int k = 0; k < layers; ++k) {
    const Real* __restrict entry = s.entry + k * n, * __restrict exit = s.exit + k * n;
    Real* __restrict a = s.ends + 2 * k * n, * __restrict b = s.ends + (2 * k + 1) * n;
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      a[i] = entry[i];
      b[i] = exit[i];
    }
  }
  const int ends = 2 * layers;
  for (int p = 2; p < ends; p *= 2)
    for (int k = p; k >= 1; k /= 2)
      for (int j = k % p; j <= ends - 1 - k; j += 2 * k)
        for (int i = 0; i < k && i + j + k < ends; ++i)
          if ((i + j) / (2 * p) == (i + j + k) / (2 * p))
            order(count, s.ends + (i + j) * n, s.ends + (i + j + k) * n);
}

/// Layer `k` into the running choice for the interval between two ends: it counts when it holds the
/// middle. Layers come last to first, so that the first listed wins.
template <bool kFirstChoice, class Real>
PLENOFLAME_INLINE void choose(const Real* absorptions, int k, int count,
                              const LayeredScratch<Real>& s, const Real* __restrict from,
                              const Real* __restrict to) {
  Real* __restrict kappa = s.kappa, * __restrict winner = s.winner;
  const Real* __restrict entry = s.entry + k * kLayeredBlock;
  const Real* __restrict exit = s.exit + k * kLayeredBlock;
  const Real absorption = absorptions[k], number = Real(k);
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    // Loads before the choices: a conditional load would be a branch where there are no masks.
    const Real old_kappa = kFirstChoice ? Real(0) : kappa[i];
    const Real old_winner = kFirstChoice ? Real(-1) : winner[i];
    const Real middle = Real(0.5) * (from[i] + to[i]);
    const bool inside = (entry[i] <= middle) & (middle < exit[i]);
    kappa[i] = inside ? absorption : old_kappa;
    winner[i] = inside ? number : old_winner;
  }
}

/// Any layers: between neighbouring ends the first listed layer that holds the middle counts.
template <class Real>
PLENOFLAME_INLINE void pass_overlapping(const LayeredTask<Real>& task, const Real* absorption,
                                        int count, const LayeredScratch<Real>& s,
                                        Real* __restrict transmittance) {
  constexpr int n = kLayeredBlock;
  Real* __restrict kappa = s.kappa, * __restrict winner = s.winner;
  for (int segment = 0; segment + 1 < 2 * task.layers; ++segment) {
    const Real* __restrict from = s.ends + segment * n;
    const Real* __restrict to = from + n;
    choose<true>(absorption, task.layers - 1, count, s, from, to);
    for (int k = task.layers - 2; k >= 0; --k) choose<false>(absorption, k, count, s, from, to);
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      const Attenuation<Real> a =
          attenuation_of_halvings(kappa[i] * Real(kLog2E) * (to[i] - from[i]));
      kappa[i] = transmittance[i] * a.emissivity;
      transmittance[i] *= a.transmittance;
    }
    for (int k = 0; k < task.layers; ++k) {
      Real* __restrict weight = s.weight + k * n;
      const Real number = Real(k);
#pragma omp simd
      for (int i = 0; i < count; ++i) {
        const Real passed = kappa[i];
        weight[i] += winner[i] == number ? passed : Real(0);
      }
    }
  }
}

/// Channels with the same absorption differ in what the layers emit only: they share the weights.
template <class Real>
PLENOFLAME_INLINE void emit(const LayeredTask<Real>& task, int from, int until, int first,
                            int count, const LayeredScratch<Real>& s) {
  for (int channel = from; channel < until; ++channel) {
    Real* __restrict radiance = task.radiance + channel * task.stride + first;
    const Real* sources = task.sources + channel * task.layers;
    const Real source = sources[0];
    const Real* __restrict weight = s.weight;
#pragma omp simd
    for (int i = 0; i < count; ++i) radiance[i] = source * weight[i];
    for (int k = 1; k < task.layers; ++k) {
      const Real next_source = sources[k];
      const Real* __restrict next_weight = s.weight + k * kLayeredBlock;
#pragma omp simd
      for (int i = 0; i < count; ++i) radiance[i] += next_source * next_weight[i];
    }
  }
}

template <class Real>
PLENOFLAME_INLINE void fill(Real* __restrict out, int count, Real value) {
#pragma omp simd
  for (int i = 0; i < count; ++i) out[i] = value;
}

/// Intersects all layers. @return number of rays that meet one; 0 before all have been tested
template <class Real>
PLENOFLAME_INLINE int intersect_all(const LayeredTask<Real>& task, int count,
                                    const LayeredScratch<Real>& s) {
  constexpr int n = kLayeredBlock;
  const bool clamped = task.t_near || task.t_far;
  const int last = task.layers - 1;
  Real* longest = s.kappa;
  fill(longest, count, Real(0));
  int hits = 0;
  for (int k = last; k >= 0; --k) {
    const bool within_next = task.nested && k < last;
    if (within_next) {
      intersect<true>(task, k, count, s, s.entry + (k + 1) * n, s.exit + (k + 1) * n);
      continue;
    }
    if (clamped)
      intersect<true>(task, k, count, s, s.near, s.far);
    else
      intersect<false>(task, k, count, s, s.near, s.far);
    lengthen(count, s.entry + k * n, s.exit + k * n, longest);
    if (!task.nested && k > 0) continue;
    hits = count_positive(count, longest);
    if (hits == 0 && task.skip) return 0;  // what misses the outermost layer misses those within
  }
  return hits;
}

template <class Real>
PLENOFLAME_INLINE void integrate_block(LayeredTask<Real>& task, int first, int count) {
  constexpr int n = kLayeredBlock;
  const LayeredScratch<Real> s = make_scratch(task.scratch, task.layers);
  Real* transmittance = task.transmittance + first;
  localise(task, first, count, s);
  const int hits = intersect_all(task, count, s);
  if (hits == 0 && task.skip) {
    fill(transmittance, count, Real(1));
    for (int c = 0; c < task.channels; ++c) {
      fill(task.radiance + c * task.stride + first, count, Real(0));
      if (task.transmittance_stride)
        fill(transmittance + c * task.transmittance_stride, count, Real(1));
    }
    return;
  }
  if (!task.nested) sort_ends(task.layers, count, s);
  const int passes = task.grey ? 1 : task.channels;
  for (int c = 0; c < passes; ++c) {
    Real* passed = transmittance;
    if (c > 0)
      passed = task.transmittance_stride ? transmittance + c * task.transmittance_stride : s.passed;
    const Real* absorption = task.absorption + c * task.layers;
    if (task.nested) {
      pass_nested(task, absorption, count, s, passed);
    } else {
      fill(passed, count, Real(1));
      for (int k = 0; k < task.layers; ++k) fill(s.weight + k * n, count, Real(0));
      pass_overlapping(task, absorption, count, s, passed);
    }
    emit(task, c, task.grey ? task.channels : c + 1, first, count, s);
  }
  if (task.grey && task.transmittance_stride)
    for (int c = 1; c < task.channels; ++c)
      for (int i = 0; i < count; ++i)
        transmittance[c * task.transmittance_stride + i] = transmittance[i];
  task.hits += hits;
  task.intervals += static_cast<long>(count) * (2 * task.layers - 1);
}

template <class Real>
PLENOFLAME_INLINE void integrate_all(LayeredTask<Real>& task) {
  for (int first = 0; first < task.size; first += kLayeredBlock)
    integrate_block(task, first,
                    task.size - first < kLayeredBlock ? task.size - first : kLayeredBlock);
}

}  // namespace

void integrate_layers(LayeredTask<float>& task) {
  integrate_all(task);
}
void integrate_layers(LayeredTask<double>& task) {
  integrate_all(task);
}

}  // namespace plenoflame::PLENOFLAME_ISA
