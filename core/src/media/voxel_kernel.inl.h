// Emission and absorption along rays through voxel bricks. Sixteen rays advance together: brick by
// brick over the table, then cell by cell within a brick, with the interval's two Gauss nodes
// interpolated from the cell's corners and its radiance composed front to back.
// The formulas are derived in docs/theory.md, "Voxel grids".
#include "math/kernel_exp.h"
#include "media/voxel_kernel.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

using voxel::kApronSide;
using voxel::kBrickPairs;
using voxel::kLanes;
using voxel::LatticeView;

constexpr int kMaxChannels = 16;  // processed together; more take another pass over the rays

template <class Real>
struct Limits;
template <>
struct Limits<float> {
  static constexpr float huge = 1e30f;   // beyond any t
  static constexpr float level = 1e-6f;  // cells: less than this is no movement along an axis
  static constexpr float tiny = 1e-37f;
};
template <>
struct Limits<double> {
  static constexpr double huge = 1e300;
  static constexpr double level = 1e-13;
  static constexpr double tiny = 1e-300;
};

// Sixteen rays in cell coordinates: origin + t * direction, 0 <= t <= end.
template <class Real>
struct Lines {
  alignas(64) Real origin[3][kLanes];
  alignas(64) Real direction[3][kLanes];
  // Plane p is crossed at t = p * inverse + offset; never, for an axis along which there is no
  // movement.
  alignas(64) Real inverse[3][kLanes];
  alignas(64) Real offset[3][kLanes];
};

// Four numbers of one precision; the two-field pair of a sample and of its neighbour along z.
typedef float Float4 __attribute__((vector_size(16)));
typedef double Double4 __attribute__((vector_size(32)));
typedef float Float4Unaligned __attribute__((vector_size(16), aligned(4), may_alias));
template <class Real>
struct Quad;
template <>
struct Quad<float> {
  using type = Float4;
};
template <>
struct Quad<double> {
  using type = Double4;
};

PLENOFLAME_INLINE void load(const float* p, Float4& out) {
  out = *reinterpret_cast<const Float4Unaligned*>(p);
}
PLENOFLAME_INLINE void load(const float* p, Double4& out) {
  out = Double4{p[0], p[1], p[2], p[3]};
}

// (temperature, absorption) at the two nodes, from the values of one cell.
template <class Real>
struct NodeFields {
  alignas(64) Real temperature[2][kLanes];
  alignas(64) Real absorption[2][kLanes];
};

template <class Real>
PLENOFLAME_INLINE void interpolate(const float* corner, const Real (&at)[2][3][kLanes], int lane,
                                   Real (&out)[2][2]) {
  using Q = typename Quad<Real>::type;
  Q v00, v01, v10, v11;
  load(corner, v00);
  load(corner + 2 * kApronSide, v01);
  load(corner + 2 * kApronSide * kApronSide, v10);
  load(corner + 2 * kApronSide * (kApronSide + 1), v11);
  const Q d0 = v10 - v00, d1 = v11 - v01;
  for (int n = 0; n < 2; ++n) {
    const Q b0 = v00 + at[n][0][lane] * d0;
    const Q b1 = v01 + at[n][0][lane] * d1;
    const Q c = b0 + at[n][1][lane] * (b1 - b0);
    const Real z = at[n][2][lane];
    out[n][0] = c[0] + z * (c[2] - c[0]);
    out[n][1] = c[1] + z * (c[3] - c[1]);
  }
}

// Entry of a brick's table, -1 outside.
PLENOFLAME_INLINE int find_brick(const LatticeView& cells, int x, int y, int z) {
  const bool inside = (x >= 0) & (x < cells.bricks[0]) & (y >= 0) & (y < cells.bricks[1]) &
                      (z >= 0) & (z < cells.bricks[2]);
  if (!inside) return -1;
  const int block = cells.top[((x >> 3) * cells.blocks[1] + (y >> 3)) * cells.blocks[2] + (z >> 3)];
  return block < 0 ? -1 : cells.table[block + ((x & 7) << 6 | (y & 7) << 3 | (z & 7))];
}

PLENOFLAME_INLINE const float* brick_values(const LatticeView& cells, int entry) {
  const int brick = entry & 1 ? cells.constant_data[entry >> 1] : entry >> 1;
  return cells.values + static_cast<long>(brick) * (2 * kBrickPairs);
}

template <class Real>
PLENOFLAME_INLINE Real floor_of(Real x) {
  const Real whole = static_cast<Real>(static_cast<int>(x));
  return whole - (whole > x ? Real(1) : Real(0));
}

template <class Real>
class Packet {
 public:
  Packet(const voxel::Call<Real>& call, voxel::Counters& counters, int first, int first_channel,
         int channels)
      : call_(call),
        medium_(*call.medium),
        cells_(call.medium->cells),
        counters_(counters),
        first_(first),
        first_channel_(first_channel),
        channels_(channels) {}

  void run() {
    start();
    while (next_bricks()) {
      if (medium_.temperature)
        cross_bricks<true>();
      else
        cross_bricks<false>();
      cut_opaque();
    }
    finish();
  }

 private:
  // World to cell coordinates, clipped to the medium's box. In double: the anchor may be far away.
  void start() {
    double begin[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      const int i = first_ + l;
      const double* m = call_.to_cells.linear;
      const double p[3] = {double(call_.x[i]), double(call_.y[i]), double(call_.z[i])};
      const double d[3] = {double(call_.dx[i]), double(call_.dy[i]), double(call_.dz[i])};
      double from = call_.t_near ? double(call_.t_near[i]) : -1e300;
      double to = call_.t_far ? double(call_.t_far[i]) : 1e300;
      double o[3], v[3];
      for (int a = 0; a < 3; ++a) {
        o[a] =
            call_.to_cells.origin[a] + m[3 * a] * p[0] + m[3 * a + 1] * p[1] + m[3 * a + 2] * p[2];
        v[a] = m[3 * a] * d[0] + m[3 * a + 1] * d[1] + m[3 * a + 2] * d[2];
        const bool moves = magnitude(v[a]) > 1e-200;
        const bool inside = (o[a] >= cells_.lower[a]) & (o[a] <= cells_.upper[a]);
        const double inverse = 1 / (moves ? v[a] : 1.0);
        const double t0 = (cells_.lower[a] - o[a]) * inverse;
        const double t1 = (cells_.upper[a] - o[a]) * inverse;
        from = greatest(from, moves ? least(t0, t1) : inside ? -1e300 : 1e300);
        to = least(to, moves ? greatest(t0, t1) : inside ? 1e300 : -1e300);
      }
      const bool meets = (to > from) & (to - from < 1e100);
      begin[l] = meets ? from : 0;
      end_[l] = static_cast<Real>(meets ? to - from : 0);
      for (int a = 0; a < 3; ++a) {
        const double limit = 8.0 * cells_.bricks[a];
        const double at = meets ? clamp(o[a] + begin[l] * v[a], 0.0, limit) : 0;
        line_.origin[a][l] = static_cast<Real>(at);
        line_.direction[a][l] = static_cast<Real>(meets ? v[a] : 0);
      }
      searching_[l] = meets;
      t_[l] = 0;
      transmittance_[l] = 1;
    }
    set_planes(line_);
    for (int l = 0; l < kLanes; ++l) {
      for (int a = 0; a < 3; ++a) {
        const int brick = static_cast<int>(line_.origin[a][l] * Real(0.125));
        brick_[a][l] = least(brick, cells_.bricks[a] - 1);
      }
      counters_.rays += searching_[l];
    }
    for (int c = 0; c < channels_; ++c)
      for (int l = 0; l < kLanes; ++l) radiance_[c][l] = 0;
    if (medium_.temperature) start_temperature(begin);
  }

  void start_temperature(const double (&begin)[kLanes]) {
    for (int l = 0; l < kLanes; ++l) {
      const int i = first_ + l;
      const double* m = call_.to_temperature.linear;
      const double p[3] = {double(call_.x[i]) + begin[l] * double(call_.dx[i]),
                           double(call_.y[i]) + begin[l] * double(call_.dy[i]),
                           double(call_.z[i]) + begin[l] * double(call_.dz[i])};
      const double d[3] = {double(call_.dx[i]), double(call_.dy[i]), double(call_.dz[i])};
      for (int a = 0; a < 3; ++a) {
        temperature_line_.origin[a][l] =
            static_cast<Real>(call_.to_temperature.origin[a] + m[3 * a] * p[0] +
                              m[3 * a + 1] * p[1] + m[3 * a + 2] * p[2]);
        temperature_line_.direction[a][l] =
            static_cast<Real>(m[3 * a] * d[0] + m[3 * a + 1] * d[1] + m[3 * a + 2] * d[2]);
      }
    }
    set_planes(temperature_line_);
  }

  void set_planes(Lines<Real>& line) {
    for (int a = 0; a < 3; ++a)
      for (int l = 0; l < kLanes; ++l) {
        const Real d = line.direction[a][l];
        const bool moves = magnitude(d) * end_[l] > Limits<Real>::level;
        const Real inverse = Real(1) / (moves ? d : Real(1));
        line.inverse[a][l] = moves ? inverse : Real(0);
        line.offset[a][l] = moves ? -line.origin[a][l] * inverse : Limits<Real>::huge;
      }
  }

  // Steps every searching ray to its next brick that must be crossed cell by cell; constant bricks
  // on the way in closed form. @return false when no ray has any left.
  bool next_bricks() {
    bool any = false;
    for (int l = 0; l < kLanes; ++l) {
      found_[l] = false;
      while (searching_[l]) {
        const int x = brick_[0][l], y = brick_[1][l], z = brick_[2][l];
        const bool inside = (x >= 0) & (x < cells_.bricks[0]) & (y >= 0) & (y < cells_.bricks[1]) &
                            (z >= 0) & (z < cells_.bricks[2]);
        if (!inside || !(t_[l] < end_[l])) {
          searching_[l] = false;
          break;
        }
        const int block =
            cells_.top[((x >> 3) * cells_.blocks[1] + (y >> 3)) * cells_.blocks[2] + (z >> 3)];
        const int entry =
            block < 0 ? -1 : cells_.table[block + ((x & 7) << 6 | (y & 7) << 3 | (z & 7))];
        const int level = block < 0 && call_.skip ? 3 : 0;
        const Real begin = t_[l];
        for (int a = 0; a < 3; ++a) segment_brick_[a][l] = brick_[a][l];
        leave_brick(l, level);
        segment_begin_[l] = begin;
        segment_end_[l] = t_[l];
        if (!(t_[l] > begin)) continue;
        if (entry < 0 && call_.skip) {
          counters_.skipped_empty += 1;
        } else if ((entry & 1) && entry >= 0 && call_.skip && !medium_.temperature) {
          counters_.skipped_constant += 1;
          add_constant(l, entry >> 1, t_[l] - begin);
        } else {
          segment_entry_[l] = entry;
          found_[l] = any = true;
          break;
        }
      }
    }
    return any;
  }

  // To the next brick (level 0) or out of the block of 8^3 bricks (level 3).
  void leave_brick(int l, int level) {
    Real exit = end_[l];
    int axis = -1;
    for (int a = 0; a < 3; ++a) {
      const int low = brick_[a][l] >> level << level;
      const int plane = low + (line_.direction[a][l] > 0 ? 1 << level : 0);
      const Real t = static_cast<Real>(8 * plane) * line_.inverse[a][l] + line_.offset[a][l];
      if (t < exit) {
        exit = t;
        axis = a;
      }
    }
    t_[l] = greatest(exit, t_[l]);
    if (axis < 0) {
      searching_[l] = false;
      return;
    }
    for (int a = 0; a < 3; ++a) {
      const int low = brick_[a][l] >> level << level, high = low + (1 << level) - 1;
      if (a == axis) {
        brick_[a][l] = line_.direction[a][l] > 0 ? high + 1 : low - 1;
      } else if (level > 0) {
        const Real p = line_.origin[a][l] + t_[l] * line_.direction[a][l];
        brick_[a][l] = clamp(static_cast<int>(floor_of(p * Real(0.125))), low, high);
      }
    }
  }

  void add_constant(int l, int n, Real length) {
    const auto a = attenuation(medium_.constant_absorption[n] * length);
    for (int c = 0; c < channels_; ++c)
      radiance_[c][l] +=
          transmittance_[l] * a.emissivity *
          medium_.constant_source[static_cast<long>(first_channel_ + c) * medium_.constants + n];
    transmittance_[l] *= a.transmittance;
    if (call_.skip && transmittance_[l] < Real(1e-7)) {
      searching_[l] = false;
      counters_.opaque_tails += 1;
    }
  }

  // Crosses the bricks that were found, all lanes in step.
  template <bool kOwnTemperature>
  void cross_bricks() {
    alignas(64) Real offset[3][kLanes], origin[3][kLanes], t[kLanes], last[kLanes];
    alignas(64) int cell[3][kLanes];
    alignas(64) int cell_t[3][kLanes];
    const float* values[kLanes];
    static const float kZeros[2 * kBrickPairs] = {};
    for (int l = 0; l < kLanes; ++l) {
      t[l] = found_[l] ? segment_begin_[l] : Real(0);
      last[l] = found_[l] ? segment_end_[l] : Real(0);
      values[l] =
          !found_[l] || segment_entry_[l] < 0 ? kZeros : brick_values(cells_, segment_entry_[l]);
    }
    for (int a = 0; a < 3; ++a)
      for (int l = 0; l < kLanes; ++l) {
        const Real low = static_cast<Real>(8 * segment_brick_[a][l]);
        offset[a][l] = line_.offset[a][l] + low * line_.inverse[a][l];
        origin[a][l] = line_.origin[a][l] - low;
        const Real p = origin[a][l] + t[l] * line_.direction[a][l];
        cell[a][l] = clamp(static_cast<int>(p), 0, 7);
        if (kOwnTemperature)
          cell_t[a][l] = static_cast<int>(
              floor_of(temperature_line_.origin[a][l] + t[l] * temperature_line_.direction[a][l]));
      }

    // Distance of the Gauss nodes from the middle, in interval lengths.
    const Real kNode = Real(0.28867513459481288225);
    alignas(64) Real at[2][3][kLanes], at_t[2][3][kLanes], length[kLanes];
    alignas(64) int pair[kLanes];
    alignas(64) int temperature_cell[3][kLanes];
    NodeFields<Real> fields;
    for (;;) {
      int active = 0;
      for (int l = 0; l < kLanes; ++l) active += t[l] < last[l];
      if (active == 0) break;
      counters_.cells += active;
      for (int l = 0; l < kLanes; ++l) {
        Real exit[3];
        for (int a = 0; a < 3; ++a) {
          const int plane = cell[a][l] + (line_.direction[a][l] > 0 ? 1 : 0);
          exit[a] = static_cast<Real>(plane) * line_.inverse[a][l] + offset[a][l];
        }
        Real exit_t[3] = {};
        Real first = least(exit[0], least(exit[1], exit[2]));
        if (kOwnTemperature) {
          for (int a = 0; a < 3; ++a) {
            const int plane = cell_t[a][l] + (temperature_line_.direction[a][l] > 0 ? 1 : 0);
            exit_t[a] = static_cast<Real>(plane) * temperature_line_.inverse[a][l] +
                        temperature_line_.offset[a][l];
          }
          first = least(first, least(exit_t[0], least(exit_t[1], exit_t[2])));
        }
        int next[3];
        bool leaves = false;
        for (int a = 0; a < 3; ++a) {
          const int step = line_.direction[a][l] > 0 ? 1 : -1;
          next[a] = cell[a][l] + (exit[a] <= first ? step : 0);
          leaves = leaves | (next[a] < 0) | (next[a] > 7);
        }
        // Out of the brick: whatever rounding left of the segment goes to its last cell.
        const Real until = leaves ? last[l] : clamp(first, t[l], last[l]);
        const Real h = until - t[l], middle = t[l] + Real(0.5) * h;
        length[l] = h;
        for (int n = 0; n < 2; ++n) {
          const Real tn = middle + (n ? kNode : -kNode) * h;
          for (int a = 0; a < 3; ++a) {
            at[n][a][l] =
                clamp(origin[a][l] + tn * line_.direction[a][l] - static_cast<Real>(cell[a][l]),
                      Real(0), Real(1));
            if (kOwnTemperature)
              at_t[n][a][l] =
                  clamp(temperature_line_.origin[a][l] + tn * temperature_line_.direction[a][l] -
                            static_cast<Real>(cell_t[a][l]),
                        Real(0), Real(1));
          }
        }
        pair[l] = 2 * ((cell[0][l] * kApronSide + cell[1][l]) * kApronSide + cell[2][l]);
        for (int a = 0; a < 3; ++a) {
          cell[a][l] = clamp(next[a], 0, 7);
          if (kOwnTemperature) {
            temperature_cell[a][l] = cell_t[a][l];
            const int step = temperature_line_.direction[a][l] > 0 ? 1 : -1;
            cell_t[a][l] += exit_t[a] <= first ? step : 0;
          }
        }
        t[l] = until;
      }
      gather_fields(cells_, values, pair, at, length, fields);
      if (kOwnTemperature) gather_temperature(temperature_cell, at_t, length, fields);
      compose(length, fields);
    }
  }

  void gather_fields(const LatticeView& lattice, const float* const (&values)[kLanes],
                     const int (&pair)[kLanes], const Real (&at)[2][3][kLanes],
                     const Real (&length)[kLanes], NodeFields<Real>& fields) {
    for (int l = 0; l < kLanes; ++l) {
      Real out[2][2] = {};
      const float* corner = values[l] + pair[l];
      if (length[l] > 0) {
        if (lattice.one_value_per_cell) {
          out[0][0] = out[1][0] = corner[0];
          out[0][1] = out[1][1] = corner[1];
        } else {
          interpolate(corner, at, l, out);
        }
      }
      for (int n = 0; n < 2; ++n) {
        fields.temperature[n][l] = out[n][0];
        fields.absorption[n][l] = out[n][1];
      }
    }
  }

  // Temperature from its own lattice.
  void gather_temperature(const int (&cell)[3][kLanes], const Real (&at)[2][3][kLanes],
                          const Real (&length)[kLanes], NodeFields<Real>& fields) {
    const LatticeView& lattice = *medium_.temperature;
    for (int l = 0; l < kLanes; ++l) {
      if (!(length[l] > 0)) continue;
      const int x = cell[0][l], y = cell[1][l], z = cell[2][l];
      const int entry = find_brick(lattice, x >> 3, y >> 3, z >> 3);
      Real out[2][2];
      out[0][0] = out[1][0] = lattice.background_temperature;
      if (entry >= 0) {
        const float* corner = brick_values(lattice, entry) +
                              2 * (((x & 7) * kApronSide + (y & 7)) * kApronSide + (z & 7));
        if (lattice.one_value_per_cell)
          out[0][0] = out[1][0] = corner[0];
        else
          interpolate(corner, at, l, out);
      }
      for (int n = 0; n < 2; ++n) fields.temperature[n][l] = out[n][0];
    }
  }

  // Adds one interval of every lane behind what was already passed.
  void compose(const Real (&length)[kLanes], const NodeFields<Real>& fields) {
    alignas(64) Real near[kLanes], far[kLanes], source[2][kLanes];
    for (int l = 0; l < kLanes; ++l) {
      const Real tau0 = Real(0.5) * length[l] * fields.absorption[0][l];
      const Real tau1 = Real(0.5) * length[l] * fields.absorption[1][l];
      const Real tau = tau0 + tau1;
      const auto transfer = linear_transfer(tau);
      const Real emissivity = transfer.near_weight + transfer.far_weight;
      const Real gradient =
          Real(0.86602540378443864676) * (transfer.near_weight - transfer.far_weight);
      const Real mean = emissivity * (tau1 / greatest(tau, Limits<Real>::tiny));
      const Real far_weight = clamp(mean - gradient, Real(0), emissivity);
      far[l] = transmittance_[l] * far_weight;
      near[l] = transmittance_[l] * (emissivity - far_weight);
      transmittance_[l] *= transfer.transmittance;
    }
    for (int c = 0; c < channels_; ++c) {
      for (int n = 0; n < 2; ++n) evaluate(c, fields.temperature[n], source[n]);
      for (int l = 0; l < kLanes; ++l)
        radiance_[c][l] += near[l] * source[0][l] + far[l] * source[1][l];
    }
  }

  void evaluate(int channel, const Real (&temperature)[kLanes], Real (&out)[kLanes]) {
    const voxel::SourceView<Real>& s = medium_.sources[first_channel_ + channel];
    const SourceTable<Real> table{s.exponents, s.weights, s.count};
    evaluate_source(table, temperature, out, kLanes);
  }

  void cut_opaque() {
    if (!call_.skip) return;
    for (int l = 0; l < kLanes; ++l) {
      const bool opaque = found_[l] && searching_[l] && transmittance_[l] < Real(1e-7);
      counters_.opaque_tails += opaque;
      searching_[l] = searching_[l] && !opaque;
    }
  }

  void finish() {
    for (int c = 0; c < channels_; ++c) {
      Real* out = call_.radiance + static_cast<long>(first_channel_ + c) * call_.stride + first_;
      for (int l = 0; l < kLanes; ++l) out[l] = radiance_[c][l];
    }
    for (int l = 0; l < kLanes; ++l) call_.transmittance[first_ + l] = transmittance_[l];
  }

  const voxel::Call<Real>& call_;
  const voxel::MediumView<Real>& medium_;
  const LatticeView cells_;
  voxel::Counters& counters_;
  const int first_, first_channel_, channels_;

  Lines<Real> line_, temperature_line_;
  alignas(64) Real t_[kLanes], end_[kLanes], transmittance_[kLanes];
  alignas(64) Real radiance_[kMaxChannels][kLanes];
  alignas(64) int brick_[3][kLanes];
  alignas(64) int searching_[kLanes], found_[kLanes];
  alignas(64) Real segment_begin_[kLanes], segment_end_[kLanes];
  alignas(64) int segment_brick_[3][kLanes], segment_entry_[kLanes];
};

template <class Real>
void integrate(const voxel::Call<Real>& call, voxel::Counters& counters) {
  for (int first = 0; first < call.size; first += kLanes)
    for (int c = 0; c < call.medium->channels; c += kMaxChannels) {
      voxel::Counters ignored{};
      Packet<Real> packet(call, c == 0 ? counters : ignored, first, c,
                          least(kMaxChannels, call.medium->channels - c));
      packet.run();
    }
}

}  // namespace

void integrate_voxels(const voxel::Call<float>& call, voxel::Counters& counters) {
  integrate(call, counters);
}
void integrate_voxels(const voxel::Call<double>& call, voxel::Counters& counters) {
  integrate(call, counters);
}

}  // namespace plenoflame::PLENOFLAME_ISA
