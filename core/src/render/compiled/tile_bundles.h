#pragma once
#include <cstdint>
#include <vector>

#include "plenoflame/render/compiled_camera.h"
#include "plenoflame/render/ray_stream.h"
#include "render/compiled/bundle_rule.h"

namespace plenoflame {

/// Gathers the rays of a tile and reduces them to few. One object for each worker.
class TileBundles {
 public:
  /// @param camera its frame, window and seed @param parts of the stop
  TileBundles(const CompiledCamera& camera, int paths, int parts, BundleReducer reducer);

  void begin(const PixelWindow& tile) { tile_ = tile, keys_.clear(), rays_.clear(); }
  void add(const RayBlock<float>& block);
  CompiledContent finish();
  double rays() const { return traced_; }  ///< added so far, in all tiles

 private:
  void add_group(std::uint32_t key, std::span<const BundleRay> first,
                 std::span<const BundleRay> second, CompiledContent& tile);

  const CompiledCamera& camera_;
  std::uint32_t paths_, parts_;
  BundleReducer reducer_;
  PixelWindow tile_;
  std::vector<std::uint32_t> keys_;       ///< of each ray: pixel, path, part, set
  std::vector<BundleRay> rays_, sorted_;  ///< reused for all tiles: about 100 MB
  double traced_ = 0;
};

}  // namespace plenoflame
