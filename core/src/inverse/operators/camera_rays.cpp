#include "plenoflame/inverse/camera_rays.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "plenoflame/base/available_memory.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/part_of_progress.h"
#include "plenoflame/film/film.h"
#include "plenoflame/lightfield/pixel_bins.h"
#include "plenoflame/render/ray_stream.h"
#include "plenoflame/scene/pupil_transmission.h"

namespace plenoflame {
namespace {

/// A ray, and the place of its pixel among those of all rows.
struct DrawnRay {
  std::size_t place;
  CameraRay ray;
};

/// A square of neighbouring pixels with this side is a piece, unless it has too many rows or rays.
constexpr int kPieceSide = 64;
constexpr std::size_t kRowsOfPiece = 512, kRaysOfPiece = std::size_t{1} << 18;

/// [byte] that a ray takes while all are drawn: it is there twice for a moment.
constexpr double kBytesOfRay = sizeof(CameraRay) + sizeof(DrawnRay);
/// Usual largest number of microlenses that cover a pixel.
constexpr double kMostLenses = 4;
/// Rays of each replicate for estimating the number of all rays.
constexpr int kCountedSamples = 4;

bool meets(const Box& box, const CameraRay& ray) {
  double from = 0, to = ray.end;
  const auto clip = [&](double lower, double upper, double o, double d) {
    if (d == 0) {
      if (o < lower || o > upper) to = -1;
      return;
    }
    from = std::max(from, std::min((lower - o) / d, (upper - o) / d));
    to = std::min(to, std::max((lower - o) / d, (upper - o) / d));
  };
  clip(box.lower.x, box.upper.x, ray.origin.x, ray.direction.x);
  clip(box.lower.y, box.upper.y, ray.origin.y, ray.direction.y);
  clip(box.lower.z, box.upper.z, ray.origin.z, ray.direction.z);
  return to > from;
}

/// Weight in a channel of light on one path through the camera and one part of its stop.
class RayShares {
 public:
  RayShares(const CompiledScene& scene, std::size_t channel)
      : transmission_(pupil_transmission(scene.scene, channel)) {
    for (const CompiledScene& path : scene.paths()) {
      const auto& of_path = path.film_channel;
      const bool has_all = of_path.empty();  // the only path
      std::vector<char> shows(transmission_.size(), has_all ? 1 : 0);
      if (std::find(of_path.begin(), of_path.end(), static_cast<int>(channel)) != of_path.end())
        for (std::size_t p = 0; p < shows.size(); ++p)
          shows[p] = path.part_mixes.empty() || path.part_mixes[p].weight(0, 0) > 0;
      shown_.push_back(std::move(shows));
    }
  }

  /// If glasses disperse, all wavelengths of the channel behind the part count alike.
  double of(int path, int part) const {
    const auto p = static_cast<std::size_t>(part);
    if (!shown_[static_cast<std::size_t>(path)][p]) return 0;
    const auto ways = std::count_if(shown_.begin(), shown_.end(),
                                    [p](const std::vector<char>& shows) { return shows[p] != 0; });
    return transmission_[p] / static_cast<double>(ways);
  }

 private:
  std::vector<double> transmission_;      ///< of each part of the stop
  std::vector<std::vector<char>> shown_;  ///< of each spectral path, by part
};

/// Groups of pixels of one camera: blocks, or cells of micro-images. Each pixel has a place, block
/// after block and line by line within each.
class Blocks {
 public:
  Blocks(const CameraView& view, const CameraRaySettings& settings)
      : window_(window_of(view)),
        bin_(settings.bin),
        across_(window_.width / bin_),
        down_(window_.height / bin_) {
    if (settings.cells == 0) return;
    const CameraSpec& camera = view.scene->scene.camera;
    if (!camera.array.present)
      throw UsageError("a camera without microlenses has no micro-images: take blocks of pixels");
    const PixelBins cells =
        micro_image_bins(MicroImages(Camera(camera), false), window_, settings.cells);
    ends_.assign(cells.count, 0);
    for (const std::int32_t cell : cells.of_pixel)
      if (cell >= 0) ++ends_[static_cast<std::size_t>(cell)];
    std::size_t sum = 0;
    for (std::size_t& end : ends_) sum += std::exchange(end, sum);
    pixels_.resize(sum);
    for (std::size_t p = 0; p < cells.of_pixel.size(); ++p) {
      const std::int32_t cell = cells.of_pixel[p];
      place_.push_back(cell < 0 ? sum : ends_[static_cast<std::size_t>(cell)]++);
      if (cell < 0) continue;
      const auto width = static_cast<std::size_t>(window_.width);
      pixels_[place_.back()] = {window_.x + static_cast<int>(p % width),
                                window_.y + static_cast<int>(p / width)};
    }
    of_cells_ = true;
  }

  const PixelWindow& window() const { return window_; }
  std::size_t count() const {
    return of_cells_ ? ends_.size()
                     : static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_);
  }
  std::size_t places() const { return begin_of(count()); }
  /// The first place of a block.
  std::size_t begin_of(std::size_t block) const {
    if (of_cells_) return block == 0 ? 0 : ends_[block - 1];
    return block * static_cast<std::size_t>(bin_) * static_cast<std::size_t>(bin_);
  }
  /// Place of a pixel on the whole sensor; places() for one that is in no row.
  std::size_t place(int column, int row) const {
    const int x = column - window_.x, y = row - window_.y;
    if (of_cells_)
      return place_[static_cast<std::size_t>(y) * static_cast<std::size_t>(window_.width) +
                    static_cast<std::size_t>(x)];
    const int i = x / bin_, j = y / bin_;
    if (i >= across_ || j >= down_) return places();
    return begin_of(static_cast<std::size_t>(j) * static_cast<std::size_t>(across_) +
                    static_cast<std::size_t>(i)) +
           static_cast<std::size_t>(y % bin_ * bin_ + x % bin_);
  }

  /// Adds the row of a block. @param begin of its rays
  void add_row(int view, std::size_t block, std::size_t begin, CameraRays& result) const {
    if (of_cells_) {
      const auto first = static_cast<std::ptrdiff_t>(begin_of(block)),
                 end = static_cast<std::ptrdiff_t>(ends_[block]);
      const CameraRays::Pixel pixel = pixels_[begin_of(block)];
      result.rows.push_back({view, pixel.column, pixel.row, begin});
      result.pixels.insert(result.pixels.end(), pixels_.begin() + first, pixels_.begin() + end);
      result.pixel_ends.push_back(result.pixels.size());
      return;
    }
    const auto across = static_cast<std::size_t>(across_);
    result.rows.push_back({view, window_.x + static_cast<int>(block % across) * bin_,
                           window_.y + static_cast<int>(block / across) * bin_, begin});
  }

 private:
  PixelWindow window_;
  int bin_, across_, down_;
  bool of_cells_ = false;
  std::vector<CameraRays::Pixel> pixels_;  ///< of the cells, by place
  std::vector<std::size_t> ends_;          ///< of each cell's places
  std::vector<std::size_t> place_;         ///< of each pixel of the window
};

/// Takes a ray of a tile; called from several threads, for different tiles.
using TakeRay = std::function<void(std::size_t tile, const DrawnRay& drawn)>;

/// Hands out rays of one camera. The order of a tile's rays does not depend on threads; the order
/// of a pixel's rays does not depend on the window either.
void draw(const CompiledScene& scene, const Blocks& blocks, const Box& box,
          const CameraRaySettings& settings, const Execution& execution, const TakeRay& take) {
  RenderSettings render;
  render.samples = settings.samples;
  render.replicates = settings.replicates;
  render.seed = settings.seed;
  render.window = blocks.window();
  const RayShares shares(scene, static_cast<std::size_t>(settings.channel));
  const auto use = [&](const RayBlock<double>& rays, int) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(rays.size); ++i) {
      const std::size_t place = blocks.place(rays.columns[i], rays.rows[i]);
      const int part = rays.pupil_parts.empty() ? 0 : rays.pupil_parts[i];
      const double share = shares.of(rays.path, part);
      if (!(share * rays.etendue[i] > 0) || place >= blocks.places()) continue;
      CameraRay ray;
      ray.part = part;
      ray.direction = {rays.rays.dx[i], rays.rays.dy[i], rays.rays.dz[i]};
      ray.origin = rays.rays.anchor + Vec3{rays.rays.x[i], rays.rays.y[i], rays.rays.z[i]} +
                   rays.rays.t_near[i] * ray.direction;
      ray.weight = share * rays.etendue[i];
      ray.end = rays.rays.t_far[i] - rays.rays.t_near[i];
      ray.replicate = rays.replicates[i];
      if (meets(box, ray)) take(static_cast<std::size_t>(rays.tile), {place, ray});
    }
  };
  if (!stream_rays<double>(scene, render, execution, use, RayStreamContent::rays, {box}))
    throw Cancelled();
}

/// Adds the rows of one camera, and their rays if they are kept. Returns how many rays there are.
std::size_t add_rows(const CameraView& view, int number, const Box& box,
                     const CameraRaySettings& settings, const Execution& execution,
                     CameraRays& result) {
  const std::size_t first = result.ray_count();
  const Blocks blocks(view, settings);
  const std::size_t tiles = static_cast<std::size_t>(Film(blocks.window(), 1, 1).tile_count());
  std::vector<std::vector<DrawnRay>> groups(settings.keep ? tiles : 0);
  std::vector<std::size_t> begin(blocks.places() + 1, 0);
  const auto take = [&](std::size_t tile, const DrawnRay& drawn) {
    if (settings.keep)
      groups[tile].push_back(drawn);
    else
      ++begin[drawn.place + 1];  // all rays of a pixel are of the same tile
  };
  draw(*view.scene, blocks, box, settings, execution, take);
  // Rays are put in order by place, and at a place in the order of the groups.
  for (const auto& group : groups)
    for (const DrawnRay& drawn : group) ++begin[drawn.place + 1];
  for (std::size_t p = 0; p < blocks.places(); ++p) begin[p + 1] += begin[p];
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    const std::size_t from = begin[blocks.begin_of(b)], to = begin[blocks.begin_of(b + 1)];
    if (to > from) blocks.add_row(number, b, first + from, result);
  }
  const std::size_t rays = begin.back();
  if (!settings.keep) return rays;
  result.rays.resize(first + rays);
  // Each group gives back its memory as soon as it is copied.
  for (auto& group : groups) {
    for (const DrawnRay& drawn : group) result.rays[first + begin[drawn.place]++] = drawn.ray;
    group = {};
  }
  return rays;
}

}  // namespace

PixelWindow window_around(const CameraRays& rays, std::span<const std::size_t> rows, int bin) {
  int left = std::numeric_limits<int>::max(), top = left, right = 0, bottom = 0;
  for (const std::size_t row : rows)
    rays.for_each_pixel(row, bin, [&](int column, int line) {
      left = std::min(left, column), right = std::max(right, column + 1);
      top = std::min(top, line), bottom = std::max(bottom, line + 1);
    });
  return {left, top, right - left, bottom - top};
}

std::size_t CameraRays::ray_count() const {
  return source ? source->rays : rays.size();
}

PixelWindow window_of(const CameraView& view) {
  if (view.window.width != 0) return view.window;
  const SensorSpec& sensor = view.scene->scene.camera.sensor;
  return {0, 0, sensor.columns, sensor.rows};
}

RowPieces pieces_of(const CameraRays& rays) {
  if (rays.source && rays.source->pieces.count() > 0) return rays.source->pieces;
  const auto square = [&](std::size_t i) {
    const CameraRays::Row& row = rays.rows[i];
    return std::tuple(row.view, row.row / kPieceSide, row.column / kPieceSide);
  };
  RowPieces pieces;
  pieces.rows.resize(rays.rows.size());
  std::iota(pieces.rows.begin(), pieces.rows.end(), std::size_t{0});
  std::stable_sort(pieces.rows.begin(), pieces.rows.end(),
                   [&](std::size_t a, std::size_t b) { return square(a) < square(b); });
  std::size_t count = 0, held = 0;
  for (std::size_t k = 0; k < pieces.rows.size(); ++k) {
    const std::size_t row = pieces.rows[k], own = rays.end_of(row) - rays.rows[row].begin;
    if (k > 0 && (count == kRowsOfPiece || held + own > kRaysOfPiece ||
                  square(row) != square(pieces.rows[k - 1]))) {
      pieces.ends.push_back(k);
      count = held = 0;
    }
    ++count;
    held += own;
  }
  if (count > 0) pieces.ends.push_back(pieces.rows.size());
  return pieces;
}

std::span<const CameraRay> RowRays::of(std::size_t row) {
  const std::size_t begin = all_.rows[row].begin, count = all_.end_of(row) - begin;
  if (!all_.source) return std::span(all_.rays).subspan(begin, count);
  const RaySource& source = *all_.source;
  const std::size_t piece = source.piece_of[row];
  const CameraView& view = source.views[piece];
  const PixelWindow& window = view.window;
  const auto place = [&](const CameraRays::Row& at) {
    return static_cast<std::size_t>(at.row - window.y) * static_cast<std::size_t>(window.width) +
           static_cast<std::size_t>(at.column - window.x);
  };
  if (piece != piece_) {
    drawn_ = {};
    Execution alone;
    alone.threads = 1;
    add_rows(view, 0, source.box, source.settings, alone, drawn_);
    at_.assign(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height),
               -1);
    for (std::size_t i = 0; i < drawn_.rows.size(); ++i)
      at_[place(drawn_.rows[i])] = static_cast<std::int32_t>(i);
    piece_ = piece;
  }
  const std::int32_t own = at_[place(all_.rows[row])];
  if (own < 0) throw Error("the rays of a row were not drawn as they were before");
  const std::size_t from = drawn_.rows[static_cast<std::size_t>(own)].begin;
  return std::span(drawn_.rays).subspan(from, count);
}

void draw_again(const std::vector<CameraView>& views, const Box& box,
                const CameraRaySettings& settings, std::size_t count, CameraRays& rays) {
  const auto source = std::make_shared<RaySource>(RaySource{box, settings, count, {}, {}, {}});
  source->settings.keep = true;
  rays.source = source;
  source->pieces = pieces_of(rays);
  source->piece_of.resize(rays.rows.size());
  for (std::size_t p = 0; p < source->pieces.count(); ++p) {
    const std::span<const std::size_t> rows = source->pieces.of(p);
    source->views.push_back(views[static_cast<std::size_t>(rays.rows[rows[0]].view)]);
    source->views.back().window = window_around(rays, rows, settings.bin);
    for (const std::size_t row : rows) source->piece_of[row] = static_cast<std::uint32_t>(p);
  }
}

CameraRays draw_camera_rays(const std::vector<CameraView>& views, const Box& box,
                            const CameraRaySettings& settings, const Execution& execution) {
  if (settings.bin < 1) throw UsageError("blocks of pixels must be at least one pixel wide");
  if (settings.cells < 0) throw UsageError("a micro-image is parted into at least 1 cell");
  CameraRays result;
  const auto source = std::make_shared<RaySource>();
  if (!settings.keep) result.source = source;
  for (std::size_t v = 0; v < views.size(); ++v)
    source->rays += add_rows(views[v], static_cast<int>(v), box, settings, execution, result);
  if (!settings.keep) draw_again(views, box, settings, source->rays, result);
  return result;
}

CameraRays counted_camera_rays(const std::vector<CameraView>& views, const Box& box,
                               CameraRaySettings settings, const Execution& execution) {
  settings.keep = false;
  const Execution quiet = without_reports(execution);
  return draw_camera_rays(views, box, settings, quiet);
}

double estimated_rays(const std::vector<CameraView>& views, const Box& box,
                      const CameraRaySettings& settings, const Execution& execution) {
  CameraRaySettings few = settings;
  few.samples = std::min(settings.samples, kCountedSamples * settings.replicates);
  double rays = 0;
  for (const CameraView& view : views)
    rays += static_cast<double>(counted_camera_rays({view}, box, few, execution).ray_count());
  return rays * settings.samples / few.samples;
}

CameraRaySettings kept_or_drawn(OperatorForm form, const std::vector<CameraView>& views,
                                const Box& box, CameraRaySettings settings,
                                const Execution& execution, int processes) {
  settings.keep = form != OperatorForm::drawn;
  if (!settings.keep) return settings;
  const double room = available_memory() / (form == OperatorForm::automatic ? 2 : 1);
  const double bytes = kBytesOfRay * processes;
  double most = 0;
  for (const CameraView& view : views)
    most += bytes * kMostLenses * settings.samples * window_of(view).width *
            static_cast<double>(window_of(view).height);
  if (most <= room) return settings;
  const double rays = estimated_rays(views, box, settings, execution);  // there may be too many
  if (form == OperatorForm::automatic)
    settings.keep = bytes * rays <= room;
  else
    require_memory(bytes * rays, "some " + std::to_string(std::llround(rays)) + " rays",
                   "take the form 'drawn', which keeps none, or fewer rays");
  return settings;
}

CameraRays rays_of_form(OperatorForm form, const std::vector<CameraView>& views, const Box& box,
                        CameraRaySettings settings, const Execution& execution) {
  settings = kept_or_drawn(form, views, box, settings, execution);
  return draw_camera_rays(views, box, settings, execution);
}

}  // namespace plenoflame
