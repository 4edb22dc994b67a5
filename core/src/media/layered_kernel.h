#pragma once

namespace plenoflame {

inline constexpr int kLayeredBlock = 256;  ///< rays handled together: their scratch stays in L1

/// Everything that the kernel of the layered medium reads and writes. Plain data: the kernel is
/// compiled once per instruction set and shares no inline code with the rest.
template <class Real>
struct LayeredTask {
  // The medium, in its local frame with the origin moved near its middle.
  int layers = 0;
  int channels = 0;
  bool nested = false;    ///< each layer lies inside the next one: intervals nest, no sorting
  bool skip = true;       ///< blocks of rays that miss everything end early
  bool rotated = true;    ///< false: `rotation` is the identity
  Real rotation[9] = {};  ///< world to local, row major
  const Real* geometry = nullptr;    ///< per layer centre/semi-axis x, y, z, 1/semi-axis [1/m]
  const Real* absorption = nullptr;  ///< per layer [1/m]; not grey: [channel * layers + layer]
  bool grey = true;                  ///< one absorption for all channels
  const Real* sources = nullptr;     ///< [channel * layers + layer], W/(m^2 sr)

  // The batch, as in RayBatch; `anchor` is its anchor in the medium's local frame.
  int size = 0;
  Real anchor[3] = {};
  const Real* position[3] = {};
  const Real* direction[3] = {};
  const Real* t_near = nullptr;
  const Real* t_far = nullptr;

  // Results, as in RadianceBatch, and counts.
  Real* radiance = nullptr;
  int stride = 0;
  Real* transmittance = nullptr;
  int transmittance_stride = 0;  ///< of the channels; 0: the first one's is kept
  long hits = 0;                 ///< rays that met a layer
  long intervals = 0;            ///< closed forms evaluated

  Real* scratch = nullptr;  ///< layered_scratch(layers) values, 64-byte aligned
};

/// Number of values of scratch memory for a medium with this number of layers.
constexpr int layered_scratch(int layers) {
  return kLayeredBlock * (8 + 5 * layers + 4);
}

namespace baseline {
void integrate_layers(LayeredTask<float>& task);
void integrate_layers(LayeredTask<double>& task);
}  // namespace baseline
namespace avx2 {
void integrate_layers(LayeredTask<float>& task);
}
namespace avx512 {
void integrate_layers(LayeredTask<float>& task);
}

}  // namespace plenoflame
