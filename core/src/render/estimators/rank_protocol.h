#pragma once
#include <cstdint>

#include "plenoflame/base/isa.h"
#include "plenoflame/image/image.h"
#include "plenoflame/render/render.h"

namespace plenoflame {

// First bytes of messages within a rendering, and the content that follows them.
inline constexpr char kRenderEnds = 'D';  ///< from rank 0
inline constexpr char kPassBegins = 'P';  ///< from rank 0: ranges of points
inline constexpr char kPassReady = 'W';   ///< to rank 0: number of threads
inline constexpr char kTile = 'J';        ///< from rank 0: TileJob, sums so far (none: empty)
inline constexpr char kTileDone = 'T';    ///< to rank 0: TileJob, rays, sums
inline constexpr char kPassEnds = 'E';    ///< from rank 0
inline constexpr char kPassEnded = 'C';   ///< to rank 0: WorkCounters

/// Settings on which the rays of a tile depend.
struct RankSettings {
  int replicates;
  std::uint64_t seed;
  PixelWindow window;
  bool skip, control_variate;
  Precision precision;
  Isa isa;
};

}  // namespace plenoflame
