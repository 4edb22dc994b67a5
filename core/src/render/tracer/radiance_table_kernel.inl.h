// Vector kernels of the table of radiance; compiled once per instruction set.
#include "render/tracer/radiance_table_kernel.h"

#include "math/kernel_math.h"

namespace plenoflame::PLENOFLAME_ISA {

void locate(const KernelRadianceTable& table, int count, const float* __restrict x,
            const float* __restrict y, const float* __restrict z, const float* __restrict dx,
            const float* __restrict dy, const float* __restrict dz, const int* __restrict code,
            const KernelTablePlaces& places) {
  const KernelRadianceTable c = table;
  int* __restrict block = places.block;
  int* __restrict corner = places.corner;
  float* __restrict pa = places.a;
  float* __restrict pb = places.b;
  float* __restrict pu = places.u;
  float* __restrict pv = places.v;
  const float side_a = static_cast<float>(c.cells_a), side_b = static_cast<float>(c.cells_b),
              side_u = static_cast<float>(c.cells_u);
#pragma omp simd
  for (int i = 0; i < count; ++i) {
    // To camera axes; the ray's point may lie outside of the anchor's plane.
    const float px = c.rotation[0] * x[i] + c.rotation[3] * y[i] + c.rotation[6] * z[i];
    const float py = c.rotation[1] * x[i] + c.rotation[4] * y[i] + c.rotation[7] * z[i];
    const float pz = c.rotation[2] * x[i] + c.rotation[5] * y[i] + c.rotation[8] * z[i];
    const float vx = c.rotation[0] * dx[i] + c.rotation[3] * dy[i] + c.rotation[6] * dz[i];
    const float vy = c.rotation[1] * dx[i] + c.rotation[4] * dy[i] + c.rotation[7] * dz[i];
    const float vz = c.rotation[2] * dx[i] + c.rotation[5] * dy[i] + c.rotation[8] * dz[i];
    const float sx = vx / vz, sy = vy / vz;
    const float ax = px - pz * sx, ay = py - pz * sy;
    const float a = (ax - c.a0) * c.per_step, b = (ay - c.b0) * c.per_step;
    const float u = (ax + c.to_pupil * sx - c.u0) * c.per_pupil_step;
    const float v = (ay + c.to_pupil * sy - c.v0) * c.per_pupil_step;
    // NaN counts as outside, too.
    const bool inside = (a >= 0.f) & (a < side_a) & (b >= 0.f) & (b < side_b) & (u >= 0.f) &
                        (u < side_u) & (v >= 0.f) & (v < side_u) & (code[i] == 0);
    const float ca = inside ? a : 0.f, cb = inside ? b : 0.f, cu = inside ? u : 0.f,
                cv = inside ? v : 0.f;
    const int ia = static_cast<int>(ca), ib = static_cast<int>(cb), iu = static_cast<int>(cu),
              iv = static_cast<int>(cv);
    pa[i] = ca - static_cast<float>(ia);
    pb[i] = cb - static_cast<float>(ib);
    pu[i] = cu - static_cast<float>(iu);
    pv[i] = cv - static_cast<float>(iv);
    block[i] = inside ? (ib >> 3) * c.blocks_a + (ia >> 3) : -1;
    corner[i] = (((ib & 7) * 9 + (ia & 7)) * c.side + iv) * c.side + iu;
  }
}

void look_up(const KernelRadianceTable& table, const float* __restrict nodes, int count,
             const KernelTablePlaces& places, float* __restrict radiance, int stride,
             int* __restrict quality) {
  const KernelRadianceTable c = table;
  const int* __restrict block = places.block;
  const int* __restrict corner = places.corner;
  const float* __restrict pa = places.a;
  const float* __restrict pb = places.b;
  const float* __restrict pu = places.u;
  const float* __restrict pv = places.v;
  const int step_a = c.side * c.side, step_b = 9 * step_a, step_v = c.side;
  for (int channel = 0; channel < c.channels; ++channel) {
    float* __restrict out = radiance + channel * static_cast<long>(stride);
    const bool first = channel == 0;
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      const bool inside = block[i] >= 0;
      const int at =
          (inside ? block[i] : c.blank) * c.block_stride + channel * c.channel_stride + corner[i];
      const float u = pu[i], v = pv[i], a = pa[i], b = pb[i];
      float least_of_all = 3e38f, greatest_of_all = 0;
      const auto plane = [&](int place) {
        const float n0 = nodes[place], n1 = nodes[place + 1], n2 = nodes[place + step_v],
                    n3 = nodes[place + step_v + 1];
        least_of_all = least(least_of_all, least(least(n0, n1), least(n2, n3)));
        greatest_of_all = greatest(greatest_of_all, greatest(greatest(n0, n1), greatest(n2, n3)));
        const float low = n0 + u * (n1 - n0), high = n2 + u * (n3 - n2);
        return low + v * (high - low);
      };
      const float p0 = plane(at), p1 = plane(at + step_a), p2 = plane(at + step_b),
                  p3 = plane(at + step_b + step_a);
      const float low = p0 + a * (p1 - p0), high = p2 + a * (p3 - p2);
      out[i] = inside ? low + b * (high - low) : 0.f;
      const float rise = greatest_of_all - least_of_all;
      const int fair = inside & (rise <= c.fair * least_of_all) ? 1 : 0;
      const int grade = fair + (inside & (rise <= c.smooth * least_of_all) ? 1 : 0);
      const int before = first ? 2 : quality[i];
      quality[i] = grade < before ? grade : before;
    }
  }
}

}  // namespace plenoflame::PLENOFLAME_ISA
