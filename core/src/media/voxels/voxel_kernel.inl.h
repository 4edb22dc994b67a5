// Emission and absorption along rays through voxel bricks, sixteen together: brick by brick, then
// interval by interval, composed front to back. Formulas: docs/theory/emission.md.
#include "media/voxels/voxel_kernel_cells.h"
#include "media/voxels/voxel_kernel_extras.h"
#include "media/voxels/voxel_kernel_transfer.h"

namespace plenoflame::PLENOFLAME_ISA {
namespace {

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
  // From world to cell coordinates, clipped to the medium's box. In double precision, because the
  // anchor may be far from the lattice's origin and the rays far from the medium.
  void start() {
    alignas(64) double from[kLanes], to[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      from[l] = call_.t_near ? static_cast<double>(call_.t_near[first_ + l]) : -1e300;
      to[l] = call_.t_far ? static_cast<double>(call_.t_far[first_ + l]) : 1e300;
    }
    alignas(64) double origin[3][kLanes], direction[3][kLanes];
    for (int a = 0; a < 3; ++a) {
      map_to_lattice(call_, first_, call_.to_cells, a, origin[a], direction[a]);
      clip(cells_.lower[a], cells_.upper[a], origin[a], direction[a], from, to);
    }
    int met = 0;
#pragma omp simd reduction(+ : met)
    for (int l = 0; l < kLanes; ++l) {
      // A ray that is not finite, or so large that single precision could overflow, meets nothing.
      const bool sane =
          (magnitude(origin[0][l]) < kLargest) & (magnitude(origin[1][l]) < kLargest) &
          (magnitude(origin[2][l]) < kLargest) & (magnitude(direction[0][l]) < kLargest) &
          (magnitude(direction[1][l]) < kLargest) & (magnitude(direction[2][l]) < kLargest);
      const bool meets = sane & (to[l] > from[l]) & (to[l] - from[l] < kLargest);
      from[l] = meets ? from[l] : 0;
      end_[l] = static_cast<Real>(meets ? to[l] - from[l] : 0);
      searching_[l] = meets;
      t_[l] = 0;
      transmittance_[l] = kAllPasses;
      met += meets;
    }
    counters_.rays += met;
    Real* const origins[3] = {line_.origin.x, line_.origin.y, line_.origin.z};
    Real* const directions[3] = {line_.direction.x, line_.direction.y, line_.direction.z};
    int* const bricks[3] = {brick_.x, brick_.y, brick_.z};
    for (int a = 0; a < 3; ++a) {
      const double limit = 8.0 * cells_.bricks[a];
      const int last = cells_.bricks[a] - 1;
      Real* __restrict o = origins[a];
      Real* __restrict d = directions[a];
      int* __restrict b = bricks[a];
#pragma omp simd
      for (int l = 0; l < kLanes; ++l) {
        const bool meets = searching_[l];
        const double at = clamp(origin[a][l] + from[l] * direction[a][l], 0.0, limit);
        o[l] = static_cast<Real>(meets ? at : 0);
        d[l] = static_cast<Real>(meets ? direction[a][l] : 0);
        b[l] = least(static_cast<int>(o[l] * Real(0.125)), last);
      }
    }
    set_planes(line_, end_);
#pragma omp simd
    for (int l = 0; l < kLanes; ++l) {
      const Real fastest =
          greatest(greatest(magnitude(line_.direction.x[l]), magnitude(line_.direction.y[l])),
                   magnitude(line_.direction.z[l]));
      // A little more, so that rounding does not leave a sliver of a whole cell.
      spacing_[l] = Real(1.001) / (fastest > 0 ? fastest : Real(1));
    }
    // Lanes that never search keep these.
    for (int l = 0; l < kLanes; ++l) {
      segment_brick_.x[l] = segment_brick_.y[l] = segment_brick_.z[l] = 0;
      segment_begin_[l] = segment_end_[l] = 0;
      segment_entry_[l] = -1;
    }
    for (int c = 0; c < channels_; ++c)
      for (int l = 0; l < kLanes; ++l) radiance_[c][l] = 0;
    for (int c = 0; c < channels_ && medium_.factors; ++c)
      for (int l = 0; l < kLanes; ++l) passed_[c][l] = kAllPasses;
    if (medium_.temperature) start_temperature(from);
  }

  void start_temperature(const double* from) {
    Real* const origins[3] = {temperature_line_.origin.x, temperature_line_.origin.y,
                              temperature_line_.origin.z};
    Real* const directions[3] = {temperature_line_.direction.x, temperature_line_.direction.y,
                                 temperature_line_.direction.z};
    alignas(64) double origin[kLanes], direction[kLanes];
    for (int a = 0; a < 3; ++a) {
      map_to_lattice(call_, first_, call_.to_temperature, a, origin, direction);
      for (int l = 0; l < kLanes; ++l) {
        origins[a][l] = static_cast<Real>(origin[l] + from[l] * direction[l]);
        directions[a][l] = static_cast<Real>(direction[l]);
      }
    }
    set_planes(temperature_line_, end_);
  }

  // Steps every searching ray to its next brick that must be crossed cell by cell. Empty blocks and
  // bricks are crossed in one step, constant bricks in closed form.
  // @return false when no ray has any left
  bool next_bricks() {
    for (int l = 0; l < kLanes; ++l) found_[l] = 0;
    const int skip = call_.skip, close = call_.skip && !medium_.temperature;
    const int* top = cells_.top;
    const int* table = cells_.table;
    const int bricks_x = cells_.bricks[0], bricks_y = cells_.bricks[1], bricks_z = cells_.bricks[2],
              blocks_y = cells_.blocks[1], blocks_z = cells_.blocks[2];
    for (;;) {
      int left = 0, constants = 0, empties = 0;
      alignas(64) int constant[kLanes];
#pragma omp simd reduction(+ : left, constants, empties)
      for (int l = 0; l < kLanes; ++l) {
        const int x = brick_.x[l], y = brick_.y[l], z = brick_.z[l];
        const bool inside = (x >= 0) & (x < bricks_x) & (y >= 0) & (y < bricks_y) & (z >= 0) &
                            (z < bricks_z) & (t_[l] < end_[l]);
        const int searching = searching_[l] & (inside ? 1 : 0);
        // Masks instead of choices keep the two look-ups gathers.
        const int at = ((x >> 3) * blocks_y + (y >> 3)) * blocks_z + (z >> 3);
        const int block = top[at & -searching];
        const int missing = block >> 31;  // -1 in an empty block
        const int in_block = (x & 7) << 6 | (y & 7) << 3 | (z & 7);
        const int entry = table[(block + in_block) & ~missing] | missing;
        // Out of the brick, or out of the whole block of 8^3 bricks when that is empty.
        const int rest = skip ? missing & 7 : 0;
        const int low_x = x & ~rest, low_y = y & ~rest, low_z = z & ~rest;
        const bool up_x = line_.direction.x[l] > 0, up_y = line_.direction.y[l] > 0,
                   up_z = line_.direction.z[l] > 0;
        const Real t_x =
            plane(8 * (low_x + (up_x ? rest + 1 : 0)), line_.inverse.x[l], line_.offset.x[l]);
        const Real t_y =
            plane(8 * (low_y + (up_y ? rest + 1 : 0)), line_.inverse.y[l], line_.offset.y[l]);
        const Real t_z =
            plane(8 * (low_z + (up_z ? rest + 1 : 0)), line_.inverse.z[l], line_.offset.z[l]);
        const Real exit = least(t_x, least(t_y, t_z));
        const Real begin = t_[l], until = clamp(exit, begin, end_[l]);
        const int passes = until > begin ? searching : 0;
        const int skips_empty = entry < 0 ? passes & skip : 0;
        const int closed = entry < 0 ? 0 : passes & entry & close;
        const int found = passes & ~skips_empty & ~closed;
        segment_begin_[l] = searching ? begin : segment_begin_[l];
        segment_end_[l] = searching ? until : segment_end_[l];
        segment_brick_.x[l] = searching ? x : segment_brick_.x[l];
        segment_brick_.y[l] = searching ? y : segment_brick_.y[l];
        segment_brick_.z[l] = searching ? z : segment_brick_.z[l];
        segment_entry_[l] = searching ? entry : segment_entry_[l];
        constant[l] = (entry >> 1) | (closed - 1);
        // One axis at a time: where faces meet, the others follow at the same t.
        const bool cross_x = exit == t_x, cross_y = !cross_x & (exit == t_y),
                   cross_z = !cross_x & !cross_y;
        const Real p_x = line_.origin.x[l] + until * line_.direction.x[l];
        const Real p_y = line_.origin.y[l] + until * line_.direction.y[l];
        const Real p_z = line_.origin.z[l] + until * line_.direction.z[l];
        const int next_x = next_brick(x, low_x, rest, cross_x, up_x, p_x);
        const int next_y = next_brick(y, low_y, rest, cross_y, up_y, p_y);
        const int next_z = next_brick(z, low_z, rest, cross_z, up_z, p_z);
        brick_.x[l] = searching ? next_x : x;
        brick_.y[l] = searching ? next_y : y;
        brick_.z[l] = searching ? next_z : z;
        t_[l] = searching ? until : begin;
        found_[l] = found_[l] | found;
        // 1: searches on; 2: has a brick to cross, searches after that; 0: done.
        searching_[l] = found ? 2 : searching | (searching_[l] & 2);
        left += searching & ~found;
        constants += closed;
        empties += skips_empty;
      }
      counters_.skipped_empty += empties;
      if (constants > 0) {
        counters_.skipped_constant += constants;
        add_constants(constant);
      }
      if (left == 0) break;
    }
    int any = 0;
    for (int l = 0; l < kLanes; ++l) {
      any |= found_[l];
      searching_[l] = searching_[l] != 0;
    }
    return any != 0;
  }

  // @param constant the constant brick that a lane has passed, or -1
  void add_constants(const int* constant) {
    for (int l = 0; l < kLanes; ++l) {
      if (constant[l] < 0) continue;
      for (int c = 0; c < channels_ && medium_.constant_lines; ++c)
        radiance_[c][l] += (medium_.factors ? passed_[c][l] : transmittance_[l]) *
                           constant_line(medium_, first_channel_ + c, constant[l],
                                         segment_end_[l] - segment_begin_[l]);
      const auto a = attenuation(medium_.constant_absorption[constant[l]] *
                                 (segment_end_[l] - segment_begin_[l]));
      for (int c = 0; c < channels_ && !medium_.factors; ++c) {
        const long row = static_cast<long>(first_channel_ + c) * medium_.constants;
        radiance_[c][l] +=
            transmittance_[l] * a.emissivity * medium_.constant_source[row + constant[l]];
      }
      transmittance_[l] *= a.transmittance;
      for (int c = 0; c < channels_ && medium_.factors; ++c) {
        const long row = static_cast<long>(first_channel_ + c) * medium_.constants;
        const auto own = attenuation(medium_.factors[first_channel_ + c] *
                                     medium_.constant_absorption[constant[l]] *
                                     (segment_end_[l] - segment_begin_[l]));
        radiance_[c][l] +=
            passed_[c][l] * own.emissivity * medium_.constant_source[row + constant[l]];
        passed_[c][l] *= own.transmittance;
      }
      if (medium_.factors) transmittance_[l] = clearest(l);
      if (transmittance_[l] < kOpaque) {
        counters_.opaque_tails += searching_[l];
        searching_[l] = 0;
      }
    }
  }

  // One brick per lane, in coordinates that count from its lowest cell.
  struct Crossing {
    Triple<Real> origin, offset;
    Triple<int> cell, own_cell;  // own_cell: of the temperature's lattice
    Triple<int> up;              // -1: the line ascends along this axis; 0
    alignas(64) Real t[kLanes];
    alignas(64) Real last[kLanes];
    alignas(64) int steps[kLanes];  // first word of the brick's step codes
    const float* values[kLanes];
    const float* extras[kLanes];
  };

  // Crosses the bricks that were found, all lanes in step. The next interval is laid out, and its
  // samples are fetched, before the present one is composed: neither waits for memory then.
  template <bool kOwnTemperature>
  void cross_bricks() {
    Crossing at;
    if (enter_bricks<kOwnTemperature>(at))
      cross_cells<kOwnTemperature, true>(at);
    else
      cross_cells<kOwnTemperature, false>(at);
  }

  // @tparam kPlain every cell of the bricks takes one interval
  template <bool kOwnTemperature, bool kPlain>
  void cross_cells(Crossing& at) {
    Intervals<Real> intervals[2], own[2];
    for (int n = 0; n < 2; ++n)
      for (int l = 0; l < 2 * kLanes; ++l)
        intervals[0].fields[n][l] = intervals[1].fields[n][l] = 0;
    int active = advance<kOwnTemperature, kPlain>(at, intervals[0], own[0]);
    for (int turn = 0; active > 0; turn ^= 1) {
      counters_.cells += active;
      interpolate_fields(at, intervals[turn]);
      if (kOwnTemperature) interpolate_temperature(own[turn], intervals[turn]);
      if (cells_.extras) interpolate_extras(cells_, at.extras, intervals[turn], extras_);
      active = advance<kOwnTemperature, kPlain>(at, intervals[turn ^ 1], own[turn ^ 1]);
      if (active > 0) fetch(at, intervals[turn ^ 1]);
      if (cells_.extras)
        compose_with_extras(medium_, first_channel_, channels_, intervals[turn], extras_, radiance_,
                            passed_, transmittance_);
      else
        compose(intervals[turn]);
    }
  }

  // @return whether every cell of these bricks takes one interval
  template <bool kOwnTemperature>
  bool enter_bricks(Crossing& at) {
    int special = 0;
    for (int l = 0; l < kLanes; ++l) {
      const int data = found_[l] ? data_of(cells_, segment_entry_[l]) : cells_.blank;
      at.values[l] = cells_.values + static_cast<long>(data) * (2 * kBrickPairs);
      at.extras[l] = cells_.extras + static_cast<long>(data) * (cells_.extra_fields * kBrickPairs);
      at.steps[l] = data * voxel::kStepWords;
      special |= found_[l] & ~cells_.plain[data];
      at.t[l] = found_[l] ? segment_begin_[l] : Real(0);
      at.last[l] = found_[l] ? segment_end_[l] : Real(0);
    }
    enter(line_.origin.x, line_.direction.x, line_.inverse.x, line_.offset.x, segment_brick_.x,
          at.t, at.origin.x, at.offset.x, at.cell.x, at.up.x);
    enter(line_.origin.y, line_.direction.y, line_.inverse.y, line_.offset.y, segment_brick_.y,
          at.t, at.origin.y, at.offset.y, at.cell.y, at.up.y);
    enter(line_.origin.z, line_.direction.z, line_.inverse.z, line_.offset.z, segment_brick_.z,
          at.t, at.origin.z, at.offset.z, at.cell.z, at.up.z);
    if (kOwnTemperature) {
      const Lines<Real>& line = temperature_line_;
      for (int l = 0; l < kLanes; ++l) {
        at.own_cell.x[l] = floor_of(line.origin.x[l] + at.t[l] * line.direction.x[l]);
        at.own_cell.y[l] = floor_of(line.origin.y[l] + at.t[l] * line.direction.y[l]);
        at.own_cell.z[l] = floor_of(line.origin.z[l] + at.t[l] * line.direction.z[l]);
      }
    }
    return special == 0;
  }

  // Lays out the next interval of every lane. It ends at the next face of its cell (or of the
  // constant block around it), or earlier if the cell is cut.
  // @return lanes that still have a part of their brick before them; the others get length 0
  template <bool kOwnTemperature, bool kPlain>
  int advance(Crossing& at, Intervals<Real>& now, Intervals<Real>& own) {
    const int most = call_.skip ? 7 : 0;
    const int* steps = cells_.steps;
    int active = 0;
#pragma omp simd reduction(+ : active)
    for (int l = 0; l < kLanes; ++l) {
      const Real begin = at.t[l], last = at.last[l];
      active += begin < last ? 1 : 0;
      const int x = at.cell.x[l], y = at.cell.y[l], z = at.cell.z[l];
      const int code =
          kPlain ? voxel::kCellStep : steps[at.steps[l] + (x << 3 | y)] >> (z << 2) & 15;
      const int rest = ((1 << greatest(code - voxel::kCellStep, 0)) - 1) & most;
      const int low_x = x & ~rest, low_y = y & ~rest, low_z = z & ~rest;
      const Real t_x = plane(low_x + ((rest + 1) & at.up.x[l]), line_.inverse.x[l], at.offset.x[l]);
      const Real t_y = plane(low_y + ((rest + 1) & at.up.y[l]), line_.inverse.y[l], at.offset.y[l]);
      const Real t_z = plane(low_z + ((rest + 1) & at.up.z[l]), line_.inverse.z[l], at.offset.z[l]);
      // Whole cells and blocks are shorter than this, parts of cells are not. A part that t cannot
      // resolve is not one.
      const Real step =
          begin + spacing_[l] * static_cast<Real>(power_of_two(code - voxel::kCellStep));
      const Real part = step > begin ? step : Limits<Real>::huge;
      Real next = least(least(t_x, kPlain ? t_x : part), least(t_y, t_z));
      Real s_x = 0, s_y = 0, s_z = 0;
      if (kOwnTemperature) {
        const Lines<Real>& line = temperature_line_;
        s_x = plane(at.own_cell.x[l] + (line.direction.x[l] > 0 ? 1 : 0), line.inverse.x[l],
                    line.offset.x[l]);
        s_y = plane(at.own_cell.y[l] + (line.direction.y[l] > 0 ? 1 : 0), line.inverse.y[l],
                    line.offset.y[l]);
        s_z = plane(at.own_cell.z[l] + (line.direction.z[l] > 0 ? 1 : 0), line.inverse.z[l],
                    line.offset.z[l]);
        next = least(next, least(s_x, least(s_y, s_z)));
      }
      const Real o_x = at.origin.x[l], o_y = at.origin.y[l], o_z = at.origin.z[l];
      const Real d_x = line_.direction.x[l], d_y = line_.direction.y[l], d_z = line_.direction.z[l];
      const int next_x = next_cell<kPlain>(low_x, rest, t_x <= next, at.up.x[l], o_x + next * d_x);
      const int next_y = next_cell<kPlain>(low_y, rest, t_y <= next, at.up.y[l], o_y + next * d_y);
      const int next_z = next_cell<kPlain>(low_z, rest, t_z <= next, at.up.z[l], o_z + next * d_z);
      // Out of the brick: the rest of the segment after rounding belongs to its last interval.
      const bool leaves = ((next_x | next_y | next_z) & ~7) != 0;
      const Real until = leaves ? last : clamp(next, begin, last);
      const Real h = until - begin;
      now.length[l] = h;
      const Real node0 = begin + kNode0 * h, node1 = begin + kNode1 * h;
      // Rounding may put a node 1e-5 of a spacing outside of its cell. Extrapolation over this
      // distance is harmless, and compose() keeps absorption from falling below 0.
      const Real c_x = o_x - static_cast<Real>(x), c_y = o_y - static_cast<Real>(y),
                 c_z = o_z - static_cast<Real>(z);
      now.at[0].x[l] = c_x + node0 * d_x;
      now.at[0].y[l] = c_y + node0 * d_y;
      now.at[0].z[l] = c_z + node0 * d_z;
      now.at[1].x[l] = c_x + node1 * d_x;
      now.at[1].y[l] = c_y + node1 * d_y;
      now.at[1].z[l] = c_z + node1 * d_z;
      now.pair[l] = 2 * ((x * kApronSide + y) * kApronSide + z);
      at.cell.x[l] = next_x & 7;
      at.cell.y[l] = next_y & 7;
      at.cell.z[l] = next_z & 7;
      at.t[l] = until;
      if (kOwnTemperature) {
        const Lines<Real>& line = temperature_line_;
        const Real p_x = line.origin.x[l], p_y = line.origin.y[l], p_z = line.origin.z[l];
        const Real e_x = line.direction.x[l], e_y = line.direction.y[l], e_z = line.direction.z[l];
        const int own_x = at.own_cell.x[l], own_y = at.own_cell.y[l], own_z = at.own_cell.z[l];
        own.length[l] = h;
        own.at[0].x[l] = within_cell(p_x + node0 * e_x, own_x);
        own.at[0].y[l] = within_cell(p_y + node0 * e_y, own_y);
        own.at[0].z[l] = within_cell(p_z + node0 * e_z, own_z);
        own.at[1].x[l] = within_cell(p_x + node1 * e_x, own_x);
        own.at[1].y[l] = within_cell(p_y + node1 * e_y, own_y);
        own.at[1].z[l] = within_cell(p_z + node1 * e_z, own_z);
        own.cell.x[l] = own_x;
        own.cell.y[l] = own_y;
        own.cell.z[l] = own_z;
        at.own_cell.x[l] = own_x + (s_x <= next ? (e_x > 0 ? 1 : -1) : 0);
        at.own_cell.y[l] = own_y + (s_y <= next ? (e_y > 0 ? 1 : -1) : 0);
        at.own_cell.z[l] = own_z + (s_z <= next ? (e_z > 0 ? 1 : -1) : 0);
      }
    }
    return active;
  }

  // The Gauss nodes of an interval, in lengths: 1/2 -+ 1/(2 sqrt 3).
  static constexpr Real kNode0 = Real(0.21132486540518711775);
  static constexpr Real kNode1 = Real(0.78867513459481288225);

  // Loads the samples of the next interval.
  PLENOFLAME_INLINE void fetch(const Crossing& at, const Intervals<Real>& next) {
    for (int l = 0; l < kLanes; ++l) {
      const float* corner = at.values[l] + next.pair[l];
      __builtin_prefetch(corner);
      __builtin_prefetch(corner + 2 * kApronSide * kApronSide);
    }
  }

  void interpolate_fields(const Crossing& at, Intervals<Real>& now) {
    if (cells_.one_value_per_cell) {
      for (int l = 0; l < kLanes; ++l)
        for (int n = 0; n < 2; ++n) {
          now.fields[n][2 * l] = at.values[l][now.pair[l]];
          now.fields[n][2 * l + 1] = at.values[l][now.pair[l] + 1];
        }
      return;
    }
    for (int l = 0; l < kLanes; ++l) {
      if (!(now.length[l] > 0)) continue;
      Real out[2][2];
      interpolate(at.values[l] + now.pair[l], now.at, l, out);
      for (int n = 0; n < 2; ++n) {
        now.fields[n][2 * l] = out[n][0];
        now.fields[n][2 * l + 1] = out[n][1];
      }
    }
  }

  // Temperature from its own lattice.
  void interpolate_temperature(const Intervals<Real>& own, Intervals<Real>& now) {
    const LatticeView& lattice = *medium_.temperature;
    for (int l = 0; l < kLanes; ++l) {
      if (!(own.length[l] > 0)) continue;
      const int x = own.cell.x[l], y = own.cell.y[l], z = own.cell.z[l];
      const int entry = find_brick(lattice, x >> 3, y >> 3, z >> 3);
      Real out[2][2];
      out[0][0] = out[1][0] = lattice.background_temperature;
      if (entry >= 0) {
        const float* corner = lattice.values +
                              static_cast<long>(data_of(lattice, entry)) * (2 * kBrickPairs) +
                              2 * (((x & 7) * kApronSide + (y & 7)) * kApronSide + (z & 7));
        if (lattice.one_value_per_cell)
          out[0][0] = out[1][0] = corner[0];
        else
          interpolate(corner, own.at, l, out);
      }
      for (int n = 0; n < 2; ++n) now.fields[n][2 * l] = out[n][0];
    }
  }

  PLENOFLAME_INLINE bool use_thin(int thick) {
    return sizeof(Real) == sizeof(float) && !thick;
  }

  Real clearest(int l) const {
    Real most = passed_[0][l];
    for (int c = 1; c < channels_; ++c) most = greatest(most, passed_[c][l]);
    return most;
  }

  // The same where each channel has an absorption of its own.
  void compose_spectral(const Intervals<Real>& now) {
    alignas(64) Real tau[2][kLanes];
    alignas(64) Real temperature[2 * kLanes], above[2 * kLanes], source[2 * kLanes];
    const Real* __restrict factors = medium_.factors + first_channel_;
    Real thickest = 0;
    for (int c = 0; c < channels_; ++c) thickest = greatest(thickest, factors[c]);
    const int thick = split_at_nodes(now, Real(kThin) / thickest, temperature, tau);
    inverse_above(medium_.hottest, temperature, above);
    for (int c = 0; c < channels_; ++c) {
      source_of(medium_.sources[first_channel_ + c], temperature, above, source);
      pass_interval(factors[c], use_thin(thick), tau, source, radiance_[c], passed_[c]);
    }
  }

  // Adds one interval of every lane behind what was already passed.
  void compose(const Intervals<Real>& now) {
    if (medium_.factors) {
      compose_spectral(now);
      return;
    }
    alignas(64) Real near[kLanes], far[kLanes], tau[2][kLanes];
    alignas(64) Real temperature[2 * kLanes], above[2 * kLanes], source[2 * kLanes];
    const int thick = split_at_nodes(now, Real(kThin), temperature, tau);
    inverse_above(medium_.hottest, temperature, above);
    if (use_thin(thick)) {
#pragma omp simd
      for (int l = 0; l < kLanes; ++l) {
        const auto w =
            thin_interval_weights(static_cast<float>(tau[0][l]), static_cast<float>(tau[1][l]));
        near[l] = transmittance_[l] * w.near;
        far[l] = transmittance_[l] * w.far;
        transmittance_[l] *= w.transmittance;
      }
    } else {
#pragma omp simd
      for (int l = 0; l < kLanes; ++l) {
        const auto w = interval_weights(tau[0][l], tau[1][l]);
        near[l] = transmittance_[l] * w.near;
        far[l] = transmittance_[l] * w.far;
        transmittance_[l] *= w.transmittance;
      }
    }
    for (int c = 0; c < channels_; ++c) {
      source_of(medium_.sources[first_channel_ + c], temperature, above, source);
#pragma omp simd
      for (int l = 0; l < kLanes; ++l)
        radiance_[c][l] += near[l] * source[l] + far[l] * source[kLanes + l];
    }
  }

  void cut_opaque() {
    if (!call_.skip) return;
    if (medium_.factors)
      for (int l = 0; l < kLanes; ++l) transmittance_[l] = clearest(l);
    for (int l = 0; l < kLanes; ++l) {
      const int opaque = found_[l] & searching_[l] & (transmittance_[l] < kOpaque);
      counters_.opaque_tails += opaque;
      searching_[l] = opaque ? 0 : searching_[l];
    }
  }

  void finish() {
    for (int c = 0; c < channels_; ++c) {
      Real* out = call_.radiance + static_cast<long>(first_channel_ + c) * call_.stride + first_;
      for (int l = 0; l < kLanes; ++l) out[l] = radiance_[c][l] * (Real(1) / kAllPasses);
    }
    if (!call_.transmittance_stride && first_channel_ > 0) return;
    for (int c = 0; c < (call_.transmittance_stride ? channels_ : 1); ++c) {
      const Real* passed = medium_.factors ? passed_[c] : transmittance_;
      Real* out = call_.transmittance +
                  static_cast<long>(first_channel_ + c) * call_.transmittance_stride + first_;
      for (int l = 0; l < kLanes; ++l) out[l] = passed[l] * (Real(1) / kAllPasses);
    }
  }

  // Light and transmittance are in units of 2^-60. Light of cold gas in the first cells is then no
  // denormal number, which would cost a hundred times as much.
  static constexpr Real kAllPasses = Real(0x1p60), kOpaque = Real(1e-7) * kAllPasses;

  const voxel::Call<Real>& call_;
  const voxel::MediumView<Real>& medium_;
  const LatticeView cells_;
  voxel::Counters& counters_;
  const int first_, first_channel_, channels_;

  Lines<Real> line_, temperature_line_;
  alignas(64) Real t_[kLanes], end_[kLanes], spacing_[kLanes], transmittance_[kLanes];
  alignas(64) Real radiance_[kMaxChannels][kLanes];
  alignas(64) Real passed_[kMaxChannels][kLanes];  // transmittance of each channel, not grey
  alignas(64) Real extras_[voxel::kMaxExtras][2 * kLanes];  // of the present intervals
  Triple<int> brick_, segment_brick_;
  alignas(64) int searching_[kLanes], found_[kLanes], segment_entry_[kLanes];
  alignas(64) Real segment_begin_[kLanes], segment_end_[kLanes];
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
