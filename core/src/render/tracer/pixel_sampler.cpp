#include "render/tracer/pixel_sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/sampling/microlens_frame.h"

namespace plenoflame {
namespace {

/// The data of the rows behind a microlens, except for the numbers of the pixels.
KernelRows survey_of(const Camera& camera, const PupilNode& node, const WorthLevels::Rings& worth,
                     double lens_x, Vec2 field) {
  const SensorSpec& sensor = camera.spec().sensor;
  KernelRows survey{};
  survey.half_columns = 0.5 * sensor.columns;
  survey.pitch = sensor.pixel().x;
  survey.pitch_y = sensor.pixel().y;
  survey.lens_x = lens_x;
  survey.centre_x = node.centre * field.x;
  survey.centre_y = node.centre * field.y;
  survey.field_x = field.x;
  survey.field_y = field.y;
  survey.blur_x = sensor.blur_reach().x;
  survey.blur_y = sensor.blur_reach().y;
  const double clear = PixelCuts::clear_of_centre(std::max(0.5 * survey.pitch + survey.blur_x,  //
                                                           0.5 * survey.pitch_y + survey.blur_y));
  survey.clear2 = clear * clear;
  static_assert(WorthLevels::kCount == kWorthRings);
  for (std::size_t k = 0; k < WorthLevels::kCount; ++k) {
    survey.rings[k] = worth.squares[k];
    survey.parts[k] = (survey.pitch + 2 * survey.blur_x) * WorthLevels::limit(k);
  }
  for (int k = 0; k < PixelCuts::kSectors; ++k)
    survey.closes[k] = std::min(node.outer_radius, static_cast<double>(node.cuts.sector(k).closes));
  return survey;
}

/// Pixels of the tile that record light of a disc around `centre` on the sensor. If there are none,
/// the width or height is not positive.
PixelWindow pixels_of(const SensorSpec& sensor, const PixelWindow& tile, Vec2 centre,
                      double radius) {
  // Upright images run opposite to camera x, y.
  const auto column_of = [&](double x) {
    return static_cast<int>(std::floor(0.5 * sensor.columns - x / sensor.pixel().x));
  };
  const auto row_of = [&](double y) {
    return static_cast<int>(std::floor(0.5 * sensor.rows - y / sensor.pixel().y));
  };
  const Vec2 reach = Vec2{radius, radius} + sensor.blur_reach();
  const int column = std::max(tile.x, column_of(centre.x + reach.x));
  const int row = std::max(tile.y, row_of(centre.y + reach.y));
  return {column, row,
          std::min(tile.x + tile.width - 1, column_of(centre.x - reach.x)) - column + 1,
          std::min(tile.y + tile.height - 1, row_of(centre.y - reach.y)) - row + 1};
}

}  // namespace

KernelRowPixels PixelRows::arrays() {
  KernelRowPixels pixels{x.data(),     y.data(),       place.data(),
                         x_low.data(), x_width.data(), far2.data(),
                         level.data(), sector.data(),  {}};
  for (std::size_t k = 0; k < random.size(); ++k) pixels.random[k] = random[k].data();
  return pixels;
}

template <class Real>
void PixelSampler<Real>::trace(int index, const PixelWindow& tile) {
  const CompiledScene& scene = *plan_.scene;
  const Camera& camera = scene.camera;
  const SceneBeams* const beams = plan_.beams;
  tile_ = tile;
  consumer_.begin_tile(index, tile);
  const double pairs_before = counters_.pairs;
  if (!camera.has_array()) {
    add_bare_pixels(scene.pupils.tables().front(), beams ? &beams->lenses() : nullptr, 0);
  } else {
    // Upright images run opposite to camera x, y.
    const Vec2 a = camera.sensor_point(tile.x + tile.width, tile.y + tile.height);
    const Vec2 b = camera.sensor_point(tile.x, tile.y);
    const Vec2 reach{plan_.reach, plan_.reach};
    for (const LensIndex lens : camera.lattice().within(a - reach, b + reach)) add_microlens(lens);
    if (plan_.between_type >= 0)
      add_bare_pixels(scene.pupils.between()->table, beams ? &*beams->between() : nullptr,
                      plan_.between_type);
  }
  generator_.flush();
  if (counters_.pairs == pairs_before) counters_.tiles_skipped += 1;
}

template <class Real>
void PixelSampler<Real>::add_microlens(LensIndex lens) {
  const Camera& camera = plan_.scene->camera;
  const Vec3 lens_place = camera.lens_place(lens);
  const Vec2 place{lens_place.x, lens_place.y}, from_foot = place - camera.foot();
  const int type = camera.lattice().type(lens);
  const PupilTable& table = plan_.scene->pupils.tables()[static_cast<std::size_t>(type)];
  const double h = std::sqrt(dot(from_foot, from_foot));
  const Vec2 field = h > 0 ? (1.0 / h) * from_foot : Vec2{1, 0};
  const auto [distance, radius] = table.micro_image(h);
  const PixelWindow pixels =
      pixels_of(camera.spec().sensor, tile_, place + distance * field, radius);
  if (pixels.width <= 0 || pixels.height <= 0) return;
  if (plan_.beams && !plan_.beams->lenses().may_meet(type, lens_place)) return;
  beam_.reset();
  if (plan_.pixel_beams) beam_ = plan_.pixel_beams->of(type, place);
  if (beam_ && beam_->is_surrounded()) beam_.reset();
  generator_.draw();
  table.look_up(h, node_);
  if (node_.dark()) return;
  whole_ = whole_aperture(table.discs.bound);
  RayTarget<Real>& target = generator_.target();
  target.frame = microlens_frame<Real>(table, node_, place, field, camera.ideal_array());
  set_blur(target.frame);
  add_faces(camera, type, target.frame);
  target.lens = lens;
  target.type = type;
  target.own.reset();
  if (camera.misaligned()) {
    target.own = plan_.microlenses[static_cast<std::size_t>(type)];
    set_lens(camera, lens, *target.own);
  }
  const std::uint64_t key =
      mix64((static_cast<std::uint64_t>(static_cast<std::uint32_t>(lens.q)) << 32 |
             static_cast<std::uint32_t>(lens.r)) ^
            plan_.settings->seed);
  KernelRows survey =
      survey_of(camera, node_, plan_.worths[static_cast<std::size_t>(type)].at(h), place.x, field);
  survey.column = static_cast<std::uint32_t>(pixels.x);
  survey.count = pixels.width;
  survey.key = key;
  static_assert(Film::kTile <= kRowsPixels);
  const int together = kRowsPixels / survey.count;
  std::array<double, kRowsPixels> y;
  survey.y = y.data();
  const KernelRowPixels arrays = rows_.arrays();
  for (int first = pixels.y; first < pixels.y + pixels.height; first += together) {
    survey.row = static_cast<std::uint32_t>(first);
    survey.rows = std::min(together, pixels.y + pixels.height - first);
    for (int row = 0; row < survey.rows; ++row)
      y[static_cast<std::size_t>(row)] = camera.sensor_point(0, first + row + 0.5).y - place.y;
    plan_.kernels.set_up_rows(survey, arrays);
    add_rows(survey);
  }
}

/// Adds the pixels of rows behind the microlens of the target. A pair needs little work and much
/// state, so the whole loop is one function for the compiler.
template <class Real>
void PixelSampler<Real>::add_rows(const KernelRows& rows) {
  const int all = rows.rows * rows.count;
  std::array<int, kRowsPixels> lit;
  int count = 0;
  for (int i = 0; i < all; ++i) {
    lit[static_cast<std::size_t>(count)] = i;
    // Without branches, which the processor could not predict.
    count += rows_.x_width[static_cast<std::size_t>(i)] > 0 ? 1 : 0;
  }
  if (beam_) {
    const auto dark = [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      return !beam_->may_meet({rows_.x[k], rows_.y[k]});
    };
    const auto end = std::remove_if(lit.begin(), lit.begin() + count, dark);
    const auto left = static_cast<int>(end - lit.begin());
    counters_.pairs_skipped += count - left;
    count = left;
  }
  const double half = 0.5 * rows.pitch_y + rows.blur_y;
  const int last_level = static_cast<int>(plan_.levels.size()) - 1;
  for (int n = 0; n < count; ++n) {
    const auto k = static_cast<std::size_t>(lit[static_cast<std::size_t>(n)]);
    const double y = rows_.y[k];
    const int sector = rows_.sector[k];
    const CutColumn& cuts = node_.cuts.sector(sector);
    KernelPixel<Real>& made = generator_.pixel();
    made.x_low = static_cast<Real>(rows_.x_low[k]);
    made.x_width = static_cast<Real>(rows_.x_width[k]);
    made.y0 = static_cast<Real>(y - half);
    made.y1 = static_cast<Real>(y + half);
    const double radius = rows.closes[sector];
    made.radius2 = static_cast<Real>(radius * radius);
    const auto opens = static_cast<double>(cuts.opens);
    made.cuts = rows_.far2[k] <= opens * opens ? &whole_ : &cuts;
    int worth = rows_.level[k];
    if (plan_.blur) [[unlikely]]
      worth = std::max(worth, spread_pixel(rows, k, radius, made));
    const SampleLevel& level = plan_.levels[static_cast<std::size_t>(std::min(worth, last_level))];
    PairRandom random;
    for (std::size_t word = 0; word < kRowWords; ++word) random[word] = rows_.random[word][k];
    const std::uint64_t place = rows_.place[k];
    generator_.add(static_cast<int>(place >> 32), static_cast<int>(place & 0xffffffffu), level,
                   random);
  }
}

/// Converts the lit columns and rows of a pixel to shares of the blur.
/// @param k number of the pixel
/// @param radius of the lit disc [m]
/// @return level of the lit share of all places from which the pixel records light
template <class Real>
int PixelSampler<Real>::spread_pixel(const KernelRows& rows, std::size_t k, double radius,
                                     KernelPixel<Real>& made) const {
  const SensorBlur& blur = *plan_.blur;
  const double x = rows_.x[k], y = rows_.y[k], reach = 0.5 * rows.pitch_y + rows.blur_y;
  const auto column = [&](double at) { return blur.share((at - x) / rows.pitch); };
  const auto row = [&](double at) { return blur.share((at - y) / rows.pitch_y); };
  const double left = column(rows_.x_low[k]), right = column(rows_.x_low[k] + rows_.x_width[k]);
  const double top = row(std::max(y - reach, rows.centre_y - radius)),
               bottom = std::max(top, row(std::min(y + reach, rows.centre_y + radius)));
  made.x_low = static_cast<Real>(left);
  made.x_width = static_cast<Real>(right - left);
  made.y0 = static_cast<Real>(top);
  made.y1 = static_cast<Real>(bottom);
  made.x = static_cast<Real>(x);
  made.y = static_cast<Real>(y);
  return WorthLevels::of((right - left) * (bottom - top));
}

/// Adds the tile's pixels, each of which looks through the pupil directly.
/// @param beams nullptr: nothing is skipped
template <class Real>
void PixelSampler<Real>::add_bare_pixels(const PupilTable& table, const BeamBounds* beams,
                                         int type) {
  for (int row = tile_.y; row < tile_.y + tile_.height; ++row)
    for (int column = tile_.x; column < tile_.x + tile_.width; ++column)
      add_bare_pixel(column, row, table, beams, type);
}

template <class Real>
void PixelSampler<Real>::add_bare_pixel(int column, int row, const PupilTable& table,
                                        const BeamBounds* beams, int type) {
  const Camera& camera = plan_.scene->camera;
  const Vec2 centre = camera.sensor_point(column + 0.5, row + 0.5);
  const Camera& own = type == plan_.between_type ? plan_.scene->pupils.between()->camera : camera;
  const Vec2 foot = own.foot();
  const Vec2 from_foot = centre - foot;
  const PupilNode node = table.at(length(from_foot));
  if (node.dark()) return;
  if (beams && !beams->may_meet(0, Vec3{centre.x, centre.y, own.sensor()})) {
    counters_.pixels_skipped += 1;
    return;
  }
  const Vec2 pitch = camera.spec().sensor.pixel();
  const Vec2 footprint = pitch + 2.0 * camera.spec().sensor.blur_reach();
  const double h = length(from_foot), longest = std::max(footprint.x, footprint.y);
  generator_.draw();
  RayTarget<Real>& target = generator_.target();
  target = {};
  target.type = type;
  KernelFrame<Real>& frame = target.frame;
  const Vec2 field = h > 0 ? (1 / h) * from_foot : Vec2{1, 0};
  const Vec2 aim = foot + node.aim_centre * field;
  // Without a micro-image, its centre is far away, so that the aim line hardly turns within the
  // pixel.
  const Vec2 far = centre - 1e3 * longest * field;
  frame.centre_x = static_cast<Real>(far.x);
  frame.centre_y = static_cast<Real>(far.y);
  // The pupil's disc moves with the sensor point, also within the pixel.
  const double shift =
      h > longest ? node.aim_centre / h : table.nodes[1].aim_centre / table.field_step;
  frame.origin_x = static_cast<Real>(aim.x - shift * centre.x);
  frame.origin_y = static_cast<Real>(aim.y - shift * centre.y);
  frame.origin_shift = static_cast<Real>(shift);
  frame.near_radius = frame.far_radius = static_cast<Real>(node.aim_radius);
  set_blur(frame);
  KernelPixel<Real>& made = generator_.pixel();
  made.x_low = static_cast<Real>(centre.x - 0.5 * pitch.x);
  made.x_width = static_cast<Real>(pitch.x);
  made.y0 = static_cast<Real>(centre.y - 0.5 * pitch.y);
  made.y1 = static_cast<Real>(centre.y + 0.5 * pitch.y);
  if (frame.blur) {
    made.x_low = made.y0 = 0;
    made.x_width = made.y1 = 1;
    made.x = static_cast<Real>(centre.x);
    made.y = static_cast<Real>(centre.y);
  }
  whole_ = whole_aperture(node.aim_radius);              // the aim disc is the pupil itself
  made.radius2 = std::numeric_limits<Real>::infinity();  // nothing cuts the pixel
  made.cuts = &whole_;
  PairRandom random;
  random[0] = mix64(((static_cast<std::uint64_t>(static_cast<std::uint32_t>(column)) << 32) |
                     static_cast<std::uint32_t>(row)) ^
                    mix64(plan_.settings->seed));
  for (std::size_t word = 1; word < kRowWords; ++word) random[word] = mix64(random[0] + word);
  generator_.add(column, row, plan_.levels.front(), random);
}

/// Sets the fields of a frame for the sensor's blur: deviations and reach.
template <class Real>
void PixelSampler<Real>::set_blur(KernelFrame<Real>& frame) const {
  if (!plan_.blur) return;
  const Vec2 pitch = plan_.scene->camera.spec().sensor.pixel();
  frame.blur = &plan_.blur_of_pixels;
  frame.pitch_x = static_cast<Real>(pitch.x);
  frame.pitch_y = static_cast<Real>(pitch.y);
}

template class PixelSampler<float>;
template class PixelSampler<double>;

}  // namespace plenoflame
