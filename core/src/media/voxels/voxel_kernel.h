// Data that the voxel medium's kernels read and write: plain, no inline functions, so that kernels
// compiled for different processors may share it.
#pragma once

namespace plenoflame::voxel {

inline constexpr int kBrickSide = 8;               // cells along a brick
inline constexpr int kApronSide = kBrickSide + 1;  // samples along a brick
inline constexpr int kBrickPairs = kApronSide * kApronSide * kApronSide;
inline constexpr int kLanes = 16;  // rays that advance together
// Step codes of a brick, 4 bits per cell. The code of cell (i, j, k) is in the bits from 4 k of
// word 8 i + j. A code is kCellStep + e. For e >= 0 the aligned block of 2^e cells that holds the
// cell is constant and can be crossed in one step. For e < 0 the cell needs intervals of 2^e
// spacings.
inline constexpr int kStepWords = kBrickSide * kBrickSide;
inline constexpr int kCellStep = 8;
inline constexpr int kMaxFitTerms = 12, kTermsOfTwo = 10;
inline constexpr int kMaxExtras = 9;  // further fields on the same samples

/// Bricks of (temperature [K], absorption [1/m]) pairs and the table that finds them. Sample
/// (i, j, k) of a brick is pair (i * 9 + j) * 9 + k. Coordinates count cells from the lowest brick.
struct LatticeView {
  const float* values;
  /// Further fields of brick n of the values: sample s of field e at
  /// (n * extra_fields + e) * kBrickPairs + s.
  const float* extras;
  int extra_fields;
  const int* steps;  ///< kStepWords for each brick of the values
  const int* plain;  ///< 1 for a brick of the values all of whose codes are kCellStep, else 0
  /// table[top[block] + brick within its block]: -1 empty; 2 n: values of brick n; 2 n + 1: the
  /// constant brick n. Both run with the last axis fastest; top is -1 for a block without bricks.
  const int* top;
  const int* table;
  int blocks[3];
  int bricks[3];
  double lower[3], upper[3];  ///< box outside of which there is only background
  const int* constant_data;   ///< brick of the values that holds constant brick n
  int blank;                  ///< a brick of the values without absorption
  int one_value_per_cell;     ///< 1: a cell has the value of its lowest sample
  float background_temperature;
};

/// A channel's source function.
template <class Real>
struct SourceView {
  const Real* exponents;  ///< [K]
  const Real* weights;    ///< [W/(m^2 sr)]
  int count;              ///< 0: sigma T^4 / pi
  /// With fit_terms > 0: scale * E / (1 - occupation * E), E = e^(v p(v)), where v is 1/T -
  /// 1/hottest (MediumView), at most `last`. The last fit_terms of `fit` are the coefficients of p,
  /// highest power first, those before are 0. See source_fit.h.
  int fit_terms;
  Real fit[kMaxFitTerms];
  /// With split_terms > 0, beyond v = split: E = e^(at_split + u q(u)), u = v - split,
  /// q as p; of both polynomials the last kTermsOfTwo coefficients count.
  int split_terms;  ///< 0: none
  Real far_fit[kMaxFitTerms];
  Real split, at_split;
  Real scale, occupation, last;
};

/// The medium as the kernel sees it.
template <class Real>
struct MediumView {
  LatticeView cells;                ///< absorption, and temperature when `temperature` is null
  const LatticeView* temperature;   ///< temperature on a lattice of its own
  const Real* constant_absorption;  ///< of constant brick n [1/m]
  const Real* constant_source;      ///< of constant brick n and channel c at [c * constants + n]
  int constants;
  const SourceView<Real>* sources;
  int channels;
  Real hottest;  ///< [K] that the sources' fits go by
  /// On the absorption, per channel; nullptr: grey.
  const Real* factors;
  /// 1: the first extra field multiplies the source functions; 0: there is no such field.
  int share_fields;
  /// The other extra fields are emission lines [W/(m^3 sr)]; what channel c counts of field e is
  /// at [c * extra_fields + e].
  const Real* line_weights;
  /// Light that lines emit into channel c in constant brick n, at [c * constants + n]; nullptr: no
  /// lines.
  const Real* constant_lines;
};

/// From world to cell coordinates: cell = linear * (offset from the anchor) + origin.
struct CellMap {
  double linear[9];
  double origin[3];
};

struct Counters {
  double rays, cells, skipped_empty, skipped_constant, opaque_tails;
};

template <class Real>
struct Call {
  const MediumView<Real>* medium;
  CellMap to_cells;
  CellMap to_temperature;
  const Real *x, *y, *z, *dx, *dy, *dz, *t_near, *t_far;
  int size;
  int skip;
  Real* radiance;
  int stride;
  Real* transmittance;
  int transmittance_stride;  ///< of the channels; 0: the first one's is kept
};

}  // namespace plenoflame::voxel

#define PLENOFLAME_DECLARE_VOXEL_KERNEL(isa)                                         \
  namespace plenoflame::isa {                                                        \
  void integrate_voxels(const voxel::Call<float>& call, voxel::Counters& counters);  \
  void integrate_voxels(const voxel::Call<double>& call, voxel::Counters& counters); \
  }
PLENOFLAME_DECLARE_VOXEL_KERNEL(baseline)
PLENOFLAME_DECLARE_VOXEL_KERNEL(avx2)
PLENOFLAME_DECLARE_VOXEL_KERNEL(avx512)
#undef PLENOFLAME_DECLARE_VOXEL_KERNEL
