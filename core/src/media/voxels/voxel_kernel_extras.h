// Fields beside temperature and absorption, for the voxel kernels: emission lines, and the share of
// the extinction that is absorption (docs/theory/emission.md). Included once per instruction
// set.
#pragma once

#include "media/voxels/voxel_kernel_cells.h"
#include "media/voxels/voxel_kernel_transfer.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

// A single field at a place of a cell whose lowest corner is at `corner`.
template <class Real>
PLENOFLAME_INLINE Real interpolate_one(const float* corner, const Triple<Real>& at, int l) {
  Real across[2][2];
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      const float* p = corner + (i * kApronSide + j) * kApronSide;
      across[i][j] = p[0] + at.z[l] * (static_cast<Real>(p[1]) - p[0]);
    }
  const Real low = across[0][0] + at.y[l] * (across[0][1] - across[0][0]);
  const Real high = across[1][0] + at.y[l] * (across[1][1] - across[1][0]);
  return low + at.x[l] * (high - low);
}

// The extra fields at both nodes of every lane's interval: node n of lane l at [n * kLanes + l].
// @param extras of the brick that each lane is in
template <class Real>
void interpolate_extras(const LatticeView& cells, const float* const (&extras)[kLanes],
                        const Intervals<Real>& now, Real (&out)[voxel::kMaxExtras][2 * kLanes]) {
  for (int e = 0; e < cells.extra_fields; ++e)
    for (int l = 0; l < kLanes; ++l) {
      const float* corner = extras[l] + e * kBrickPairs + now.pair[l] / 2;
      for (int n = 0; n < 2; ++n)
        out[e][n * kLanes + l] = cells.one_value_per_cell ? static_cast<Real>(corner[0])
                                                          : interpolate_one(corner, now.at[n], l);
    }
}

// The light that emission lines send out of a constant brick into a channel.
template <class Real>
Real constant_line(const voxel::MediumView<Real>& medium, int channel, int constant, Real length) {
  const Real tau = (medium.factors ? medium.factors[channel] : Real(1)) *
                   medium.constant_absorption[constant] * length;
  return length * mean_transmittance(tau) *
         medium.constant_lines[static_cast<long>(channel) * medium.constants + constant];
}

// Adds one interval of every lane behind what was already passed, grey or not.
// @param fields of interpolate_extras()
template <class Real>
void compose_with_extras(const voxel::MediumView<Real>& medium, int first_channel, int channels,
                         const Intervals<Real>& now,
                         const Real (&fields)[voxel::kMaxExtras][2 * kLanes],
                         Real (&radiance)[kMaxChannels][kLanes],
                         Real (&passed_each)[kMaxChannels][kLanes], Real (&passed_all)[kLanes]) {
  const LatticeView& cells = medium.cells;
  alignas(64) Real tau[2][kLanes];
  alignas(64) Real temperature[2 * kLanes], above[2 * kLanes], source[2 * kLanes],
      lines[2 * kLanes];
  alignas(64) Real near[kLanes], far[kLanes], line_near[kLanes], line_far[kLanes];
  alignas(64) Real transmittance[kLanes];
  split_at_nodes(now, Real(0), temperature, tau);
  inverse_above(medium.hottest, temperature, above);
  for (int c = 0; c < channels; ++c) {
    const int channel = first_channel + c;
    Real* const passed = medium.factors ? passed_each[c] : passed_all;
    if (c == 0 || medium.factors) {
      const Real factor = medium.factors ? medium.factors[channel] : Real(1);
#pragma omp simd
      for (int l = 0; l < kLanes; ++l) {
        const auto w = interval_weights(factor * tau[0][l], factor * tau[1][l]);
        const auto line = line_weights(factor * tau[0][l], factor * tau[1][l]);
        near[l] = passed[l] * w.near;
        far[l] = passed[l] * w.far;
        line_near[l] = passed[l] * now.length[l] * line.near;
        line_far[l] = passed[l] * now.length[l] * line.far;
        transmittance[l] = w.transmittance;
      }
    }
    source_of(medium.sources[channel], temperature, above, source);
    if (medium.share_fields) {
#pragma omp simd
      for (int l = 0; l < 2 * kLanes; ++l) source[l] *= fields[0][l];
    }
    for (int l = 0; l < 2 * kLanes; ++l) lines[l] = 0;
    const Real* const weights =
        medium.line_weights + static_cast<long>(channel) * cells.extra_fields;
    for (int e = medium.share_fields; e < cells.extra_fields; ++e) {
      const Real weight = weights[e];
      if (!(weight > 0)) continue;
        // Below 0 where rounding has led a node out of its cell.
#pragma omp simd
      for (int l = 0; l < 2 * kLanes; ++l) lines[l] += weight * greatest(fields[e][l], Real(0));
    }
#pragma omp simd
    for (int l = 0; l < kLanes; ++l)
      radiance[c][l] += near[l] * source[l] + far[l] * source[kLanes + l] +
                        line_near[l] * lines[l] + line_far[l] * lines[kLanes + l];
    if (medium.factors)
      for (int l = 0; l < kLanes; ++l) passed_each[c][l] *= transmittance[l];
  }
  if (!medium.factors)
    for (int l = 0; l < kLanes; ++l) passed_all[l] *= transmittance[l];
}

}  // namespace
}  // namespace plenoflame::PLENOFLAME_ISA
