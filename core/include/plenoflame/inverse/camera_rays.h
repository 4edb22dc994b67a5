#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/image.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// A camera whose pixels are rows of the linear problem.
struct CameraView {
  const CompiledScene* scene = nullptr;
  PixelWindow window;  ///< requested pixels; width 0: the whole sensor
};

/// The pixels that are meant.
PixelWindow window_of(const CameraView& view);

/// Settings for drawing rays and grouping pixels.
struct CameraRaySettings {
  int samples = 16;    ///< rays per pixel and microlens that covers it
  int replicates = 2;  ///< number of replicates that the samples are divided into
  std::uint64_t seed = 1;
  int bin = 1;  ///< a row is the sum of bin x bin pixels
  /// Above 0 rows are cells of micro-images in place of blocks: of cells x cells over the square
  /// around each (micro_image_bins()). With 1 a row is all light of a microlens, with several a
  /// pixel of a view. Pixels between micro-images are in no row.
  int cells = 0;
  int channel = 0;  ///< of the scene: where glasses disperse, the way of its wavelengths
  /// Rays are kept. Otherwise they are counted, and drawn again by whoever follows them (RowRays).
  bool keep = true;
};

/// A ray that a pixel sees, in world coordinates.
struct CameraRay {
  Vec3 origin, direction;  ///< [m], unit vector; the origin is on the camera
  double weight = 0;       ///< [m^2 sr] share of the etendue, times pupil_transmission()
  double end = 0;          ///< [m] where something solid ends it; infinite otherwise
  int replicate = 0;       ///< the replicate that it belongs to
  int part = 0;            ///< of the stop, of PupilFilters::parts()
};

struct RaySource;

/// The rays of every pixel, or block of pixels, that sees a box: rows of the linear problem. A row
/// times radiance is a flux [W], the sum over its pixels.
struct CameraRays {
  struct Row {
    int view = 0;             ///< number of the camera
    int column = 0, row = 0;  ///< of the first of its pixels, on the whole sensor
    std::size_t begin = 0;    ///< of its rays
  };
  struct Pixel {
    int column = 0, row = 0;  ///< on the whole sensor
  };
  std::vector<Row> rows;
  /// The rays of a row are those of its pixels line by line. Empty if `source` draws them.
  std::vector<CameraRay> rays;
  std::shared_ptr<const RaySource> source;  ///< nullptr where rays are kept
  /// The pixels of rows that are cells of micro-images, row after row, and the end of each row's.
  /// Empty for blocks.
  std::vector<Pixel> pixels;
  std::vector<std::size_t> pixel_ends;

  std::size_t ray_count() const;
  std::size_t end_of(std::size_t row) const {
    return row + 1 < rows.size() ? rows[row + 1].begin : ray_count();
  }
  /// Calls use(column, row) for each pixel of a row. @param bin of the settings
  template <class Use>
  void for_each_pixel(std::size_t row, int bin, const Use& use) const {
    if (!pixel_ends.empty()) {
      for (std::size_t p = row == 0 ? 0 : pixel_ends[row - 1]; p < pixel_ends[row]; ++p)
        use(pixels[p].column, pixels[p].row);
      return;
    }
    for (int j = 0; j < bin; ++j)
      for (int i = 0; i < bin; ++i) use(rows[row].column + i, rows[row].row + j);
  }
};

/// The smallest window around the pixels of some rows of one view. @param bin of the settings
PixelWindow window_around(const CameraRays& rays, std::span<const std::size_t> rows, int bin);

/// Rows in an order in which neighbours on the sensor are together, piece after piece. A piece has
/// some hundred rows and a quarter of a million rays at most, unless a single row has more.
struct RowPieces {
  std::vector<std::size_t> rows, ends;
  std::size_t count() const { return ends.size(); }
  std::span<const std::size_t> of(std::size_t piece) const {
    const std::size_t begin = piece == 0 ? 0 : ends[piece - 1];
    return std::span(rows).subspan(begin, ends[piece] - begin);
  }
};

/// The same whether rays are kept or not.
RowPieces pieces_of(const CameraRays& rays);

/// Draws rays again, a piece at a time. Only a few pieces are in memory.
struct RaySource {
  Box box;
  CameraRaySettings settings;
  std::size_t rays = 0;  ///< of all rows
  RowPieces pieces;
  /// The camera of each piece, with the window around its pixels. The objects that the views point
  /// to must outlive this.
  std::vector<CameraView> views;
  std::vector<std::uint32_t> piece_of;  ///< of each row
};

/// Gives rows a source that draws their rays. @param views by the numbers in the rows
/// @param count of the rays
void draw_again(const std::vector<CameraView>& views, const Box& box,
                const CameraRaySettings& settings, std::size_t count, CameraRays& rays);

/// Hands out the rays of rows, for one thread, whether they are kept or drawn again. Read rows
/// piece by piece: a row of another piece than the previous one causes all of its piece to be
/// drawn.
class RowRays {
 public:
  /// @param all must outlive it
  explicit RowRays(const CameraRays& all) : all_(all) {}
  /// Valid until the next call.
  std::span<const CameraRay> of(std::size_t row);

 private:
  const CameraRays& all_;
  std::size_t piece_ = static_cast<std::size_t>(-1);
  CameraRays drawn_;
  std::vector<std::int32_t> at_;  ///< row of drawn_ that begins at a pixel of the window; -1: none
};

/// Draws the rays of the backward estimator with these samples and this seed, and keeps those that
/// meet the box. Blocks of pixels that reach beyond the window are skipped. The result does not
/// depend on the number of threads.
/// @throws UsageError for settings that render() rejects, a bin below 1, cells of a camera without
///         microlenses
/// @throws Cancelled
CameraRays draw_camera_rays(const std::vector<CameraView>& views, const Box& box,
                            const CameraRaySettings& settings, const Execution& execution = {});

/// How the rows of the linear problem are stored, from fast to small.
enum class OperatorForm {
  automatic,  ///< the first of those that follow for which there is memory
  matrix,     ///< stored
  rays,       ///< rays are kept, and followed again in each product
  drawn,      ///< rays are drawn again, too: memory does not depend on their number
};

/// Rays that are counted and not kept.
CameraRays counted_camera_rays(const std::vector<CameraView>& views, const Box& box,
                               CameraRaySettings settings, const Execution& execution = {});

/// The number of rays that will be drawn, estimated from as few as 4 for each replicate. It is some
/// per cent too large, because each pair of pixel and microlens counts at least one ray.
double estimated_rays(const std::vector<CameraView>& views, const Box& box,
                      const CameraRaySettings& settings, const Execution& execution = {});

/// Decides whether the rays of this form are kept or drawn again. The automatic form draws them
/// again if they would take more than half of the machine's free memory. estimated_rays() gives
/// their number.
/// @param processes of this machine that keep as many
/// @throws InputError: the form keeps the rays, and they do not fit into memory
CameraRaySettings kept_or_drawn(OperatorForm form, const std::vector<CameraView>& views,
                                const Box& box, CameraRaySettings settings,
                                const Execution& execution = {}, int processes = 1);

/// draw_camera_rays() by kept_or_drawn().
CameraRays rays_of_form(OperatorForm form, const std::vector<CameraView>& views, const Box& box,
                        CameraRaySettings settings, const Execution& execution = {});

}  // namespace plenoflame
