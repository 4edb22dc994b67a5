#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/image.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/render/compiled_camera.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// A camera whose pixels are rows of the linear problem.
struct CameraView {
  const CompiledScene* scene = nullptr;
  PixelWindow window;  ///< pixels that are wanted; width 0: the whole sensor, or all compiled ones
  /// The rays that it keeps take the place of drawn ones; its two sets are replicates.
  const CompiledCamera* compiled = nullptr;
  std::string compiled_name = {};  ///< for messages
};

/// The pixels that are meant.
PixelWindow window_of(const CameraView& view);

/// Settings by which rays are drawn and pixels are put together.
struct CameraRaySettings {
  int samples = 16;    ///< rays per pixel and microlens that covers it
  int replicates = 2;  ///< randomisations that these are made of
  std::uint64_t seed = 1;
  int bin = 1;      ///< a row is the sum of bin x bin pixels
  int channel = 0;  ///< of the scene: where glasses disperse, the way of its wavelengths
};

/// A ray that a pixel sees, in world coordinates.
struct CameraRay {
  Vec3 origin, direction;  ///< [m], unit vector; the origin is on the camera
  double weight = 0;       ///< [m^2 sr] share of the etendue, times pupil_transmission()
  double end = 0;          ///< [m] where something solid ends it; infinite otherwise
  int replicate = 0;       ///< the independent randomisation that it belongs to
  int part = 0;            ///< of the stop, of PupilFilters::parts()
};

/// The rays of every pixel, or block of pixels, that sees a box: rows of the linear problem. A row
/// times radiance is a flux [W], the sum over its pixels.
struct CameraRays {
  struct Row {
    int view = 0;             ///< number of the camera
    int column = 0, row = 0;  ///< of the block's first pixel, on the whole sensor
    std::size_t begin = 0;    ///< of its rays
  };
  std::vector<Row> rows;
  std::vector<CameraRay> rays;

  std::size_t end_of(std::size_t row) const {
    return row + 1 < rows.size() ? rows[row + 1].begin : rays.size();
  }
};

/// Draws the rays that the backward estimator draws with these samples and this seed, and keeps
/// those that meet the box; of a compiled camera all of its own that do. Blocks of pixels that
/// reach beyond the window are left out. The same for any number of threads.
/// @throws UsageError for settings that render() refuses, a bin below 1, a window that a compiled
///         camera does not hold
/// @throws InputError as check_compiled(), and where the box reaches beyond its region
/// @throws Cancelled
CameraRays draw_camera_rays(const std::vector<CameraView>& views, const Box& box,
                            const CameraRaySettings& settings, const Execution& execution = {});

}  // namespace plenoflame
