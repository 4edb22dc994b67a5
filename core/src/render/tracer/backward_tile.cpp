#include "render/tracer/backward_tile.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>

#include "render/run/run_control.h"
#include "render/sampling/microlens_frame.h"

namespace plenoflame {

template <class Real>
TileTracer<Real>::TileTracer(const BackwardPlan<Real>& plan, RayConsumer<Real>& consumer)
    : plan_(plan),
      consumer_(consumer),
      shows_drawn_(consumer.wants_drawn()),
      keeps_groups_(plan.surfaces || plan.scatter),
      queued_(kBlockRays + 1),  // a pixel has at least one ray
      pending_(kBlockRays),
      columns_(plan.scene->camera.pupil_filters().empty() ? 9 : 11),
      codes_(kPaddedBlock) {
  Real** arrays[] = {&block_.x,  &block_.y,      &block_.z,          &block_.dx,        &block_.dy,
                     &block_.dz, &block_.weight, &block_.scratch[0], &block_.scratch[1]};
  for (std::size_t i = 0; i < std::size(arrays); ++i) *arrays[i] = columns_[i];
  block_.code = codes_.data();
  if (plan.scene->camera.pupil_filters().empty()) return;
  block_.stop_x = columns_[9];
  block_.stop_y = columns_[10];
}

template <class Real>
void TileTracer<Real>::trace(int index, const PixelWindow& tile) {
  const Camera& camera = plan_.scene->camera;
  tile_ = tile;
  consumer_.begin_tile(index, tile);
  const double pairs_before = counters_.pairs;
  if (!camera.has_array()) {
    for (int row = tile.y; row < tile.y + tile.height; ++row)
      for (int column = tile.x; column < tile.x + tile.width; ++column)
        add_bare_pixel(column, row, plan_.scene->pupils.tables().front(),
                       plan_.beams ? &plan_.beams->lenses() : nullptr, 0);
  } else {
    // Upright images run opposite to camera x, y.
    const Vec2 a = camera.sensor_point(tile.x + tile.width, tile.y + tile.height);
    const Vec2 b = camera.sensor_point(tile.x, tile.y);
    const Vec2 reach{plan_.reach, plan_.reach};
    for (const LensIndex lens : camera.lattice().within(a - reach, b + reach)) add_microlens(lens);
    if (plan_.between_type >= 0)
      for (int row = tile.y; row < tile.y + tile.height; ++row)
        for (int column = tile.x; column < tile.x + tile.width; ++column)
          add_bare_pixel(column, row, plan_.scene->pupils.between()->table,
                         plan_.beams ? &*plan_.beams->between() : nullptr, plan_.between_type);
  }
  flush();
  if (counters_.pairs == pairs_before) counters_.tiles_skipped += 1;
}

template <class Real>
void TileTracer<Real>::add_bare_pixel(int column, int row, const PupilTable& table,
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
  generate_queued();
  frame_ = {};
  has_own_lens_ = false;
  const Vec2 field = h > 0 ? (1 / h) * from_foot : Vec2{1, 0};
  const Vec2 aim = foot + node.aim_centre * field;
  // Without a micro-image, its centre is far away, so that the aim line hardly turns within the
  // pixel.
  const Vec2 far = centre - 1e3 * longest * field;
  frame_.centre_x = static_cast<Real>(far.x);
  frame_.centre_y = static_cast<Real>(far.y);
  // The pupil's disc moves with the sensor point, also within the pixel.
  const double shift =
      h > longest ? node.aim_centre / h : table.nodes[1].aim_centre / table.field_step;
  frame_.origin_x = static_cast<Real>(aim.x - shift * centre.x);
  frame_.origin_y = static_cast<Real>(aim.y - shift * centre.y);
  frame_.origin_shift = static_cast<Real>(shift);
  frame_.near_radius = frame_.far_radius = static_cast<Real>(node.aim_radius);
  set_blur();
  KernelPixel<Real>& made = pixel();
  made.x_low = static_cast<Real>(centre.x - 0.5 * pitch.x);
  made.x_width = static_cast<Real>(pitch.x);
  made.y0 = static_cast<Real>(centre.y - 0.5 * pitch.y);
  made.y1 = static_cast<Real>(centre.y + 0.5 * pitch.y);
  if (frame_.blur) {
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
  lens_ = {};
  type_ = type;
  add_pair(column, row, plan_.levels.front(), random);
}

/// Sets the fields of the frame for the sensor's blur: deviations and reach.
template <class Real>
void TileTracer<Real>::set_blur() {
  if (!plan_.blur) return;
  const Vec2 pitch = plan_.scene->camera.spec().sensor.pixel();
  frame_.blur = &plan_.blur_of_pixels;
  frame_.pitch_x = static_cast<Real>(pitch.x);
  frame_.pitch_y = static_cast<Real>(pitch.y);
}

template <class Real>
void TileTracer<Real>::generate_queued() {
  if (queued_count_ == 0) return;
  const KernelMicrolens<Real>& lens =
      has_own_lens_ ? own_lens_ : plan_.microlenses[static_cast<std::size_t>(type_)];
  plan_.kernels.generate(frame_, queued_.data(), queued_count_, lens.distance, block_);
  const KernelPixel<Real>& last = queued_[static_cast<std::size_t>(queued_count_ - 1)];
  const int first = queued_.front().first;
  const int count = last.first + last.count - first;
  const bool between = type_ == plan_.between_type;
  if (shows_drawn_)
    consumer_.drawn({frame_, lens_, between || lens.kind == 0 ? -1 : type_, block_, first, count});
  if (between) end_at_microlenses(first, count);
  // Between the lenses, rays pass only the sensor's cover glass.
  plan_.optics.pass_microlens(lens, frame_.lens_x, frame_.lens_y, first, count, block_);
  queued_count_ = 0;
}

/// Ends rays that were drawn without an array and meet one of its lenses.
template <class Real>
void TileTracer<Real>::end_at_microlenses(int first, int count) {
  const Camera& camera = plan_.scene->camera;
  const int front = camera.surface_count() - (camera.ideal_array() ? 1 : 2);
  const double z = camera.array_front() + static_cast<double>(plan_.between_z);
  for (int i = first; i < first + count; ++i) {
    const Ray ray{{static_cast<double>(block_.x[i]), static_cast<double>(block_.y[i]), z},
                  {static_cast<double>(block_.dx[i]), static_cast<double>(block_.dy[i]),
                   static_cast<double>(block_.dz[i])}};
    block_.z[i] = plan_.between_z;
    if (!camera.passes_between(ray)) block_.code[i] = 4 * front + kCauseVignetted;
  }
}

/// Makes room for the rays of this pixel, which is queued afterwards.
template <class Real>
void TileTracer<Real>::flush_keeping(const KernelPixel<Real>& made) {
  const KernelPixel<Real> kept = made;
  flush();
  pixel() = kept;
}

template <class Real>
void TileTracer<Real>::flush() {
  generate_queued();
  if (count_ == 0) return;
  const int padded = (count_ + kRayPadding - 1) / kRayPadding * kRayPadding;
  for (int i = count_; i < padded; ++i) {
    block_.x[i] = block_.x[0];
    block_.y[i] = block_.y[0];
    block_.z[i] = block_.z[0];
    block_.dx[i] = block_.dx[0];
    block_.dy[i] = block_.dy[0];
    block_.dz[i] = block_.dz[0];
    block_.weight[i] = 0;
    block_.code[i] = 1;
  }
  const auto start = std::chrono::steady_clock::now();
  plan_.optics.trace_lens(plan_.camera, padded, block_);
  counters_.rays += count_;
  counters_.rays_reached += plan_.optics.count_alive(block_.code, block_.weight, count_);
  counters_.stages.optics += seconds_since(start);
  consumer_.traced({block_, count_, padded, pending(), groups_, log2_points_});
  groups_.clear();
  pending_count_ = 0;
  log2_points_ = 0;
  count_ = 0;
}

template class TileTracer<float>;
template class TileTracer<double>;

}  // namespace plenoflame
