#include "render/backward_tile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "render/channel_sum.h"
#include "render/microlens_patch.h"
#include "render/run_control.h"

namespace plenoflame {
namespace {

constexpr int kLeastTablePoints = 8;  ///< of a replicate: with fewer every ray is integrated
/// Of so many points one corrects the table, where it is smooth and where it is fair.
constexpr int kSmoothPoints = 16, kFairPoints = 4;
constexpr std::uint64_t kScatterSeed = 0x73636174u;     ///< apart from what the rays use
constexpr int kPadding = kBlockRays + 2 * kBlockSlack;  ///< of each array of the block

}  // namespace

template <class Real>
TileTracer<Real>::TileTracer(const BackwardPlan<Real>& plan, Film& film)
    : plan_(plan), film_(film) {
  const auto nodes = static_cast<std::size_t>(plan.scene->node_count());
  // What is behind a medium needs the transmittance of every node.
  const std::size_t passes = plan.surfaces && !plan.medium->is_grey() ? nodes : 1;
  constexpr std::size_t alignment = 64 / sizeof(Real);
  storage_.resize((11 + nodes + (passes > 1 ? passes : 0)) * kPadding + alignment);
  codes_.resize(kPadding);
  sums_of_rays_.resize(kMostDoublings + 1, std::vector<Real>(kPadding));
  queued_.resize(kBlockRays + 1);  // a pixel has a ray at least
  pending_.resize(kBlockRays);
  Real* base = storage_.data();
  while (reinterpret_cast<std::uintptr_t>(base) % 64 != 0) ++base;
  Real** arrays[] = {&block_.x,  &block_.y,      &block_.z,          &block_.dx,        &block_.dy,
                     &block_.dz, &block_.weight, &block_.scratch[0], &block_.scratch[1]};
  for (Real** array : arrays) {
    *array = base;
    base += kPadding;
  }
  transmittance_ = base;
  fair_factor_ = base + kPadding;
  radiance_ = base + 2 * kPadding;
  if (passes > 1) {
    transmittance_ = radiance_ + nodes * kPadding;
    transmittance_stride_ = kPadding;
  }
  block_.code = codes_.data();
  if (plan.scatter) scatter_ = std::make_unique<ScatterWalk>(*plan.scatter);
  if (plan.surfaces)
    surfaces_ = std::make_unique<SurfaceBlock<Real>>(*plan.surfaces, plan.scene->node_count(),
                                                     scatter_.get());
}

template <class Real>
void TileTracer<Real>::render(int tile_index) {
  const Camera& camera = plan_.scene->camera;
  tile_index_ = tile_index;
  tile_ = film_.tile(tile_index);
  const PixelWindow& tile = tile_;
  const double pairs_before = counters_.pairs;
  if (!camera.has_array()) {
    for (int row = tile.y; row < tile.y + tile.height; ++row)
      for (int column = tile.x; column < tile.x + tile.width; ++column)
        add_bare_pixel(column, row, plan_.scene->pupils.tables().front(),
                       plan_.beams ? &plan_.beams->lenses() : nullptr, 0);
  } else {
    // Upright images run against camera x, y.
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
  const double h = length(from_foot), pitch = camera.spec().sensor.pixel_pitch;
  generate_queued();
  patch_ = {};
  has_own_lens_ = false;
  const Vec2 field = h > 0 ? (1 / h) * from_foot : Vec2{1, 0};
  const Vec2 aim = foot + node.aim_centre * field;
  // No micro-image: the line that aims go by shall hardly turn within the pixel.
  const Vec2 far = centre - 1e3 * pitch * field;
  patch_.centre_x = static_cast<Real>(far.x);
  patch_.centre_y = static_cast<Real>(far.y);
  // The pupil's disc moves with the sensor point, also within the pixel.
  const double shift =
      h > pitch ? node.aim_centre / h : table.nodes[1].aim_centre / table.field_step;
  patch_.origin_x = static_cast<Real>(aim.x - shift * centre.x);
  patch_.origin_y = static_cast<Real>(aim.y - shift * centre.y);
  patch_.origin_shift = static_cast<Real>(shift);
  patch_.near_radius = patch_.far_radius = static_cast<Real>(node.aim_radius);
  KernelPixel<Real>& made = pixel();
  made.x_low = static_cast<Real>(centre.x - 0.5 * pitch);
  made.x_width = static_cast<Real>(pitch);
  made.y0 = static_cast<Real>(centre.y - 0.5 * pitch);
  made.y1 = static_cast<Real>(centre.y + 0.5 * pitch);
  whole_ = whole_aperture(node.aim_radius);              // the aim disc is the pupil itself
  made.radius2 = std::numeric_limits<Real>::infinity();  // nothing cuts the pixel
  made.cuts = &whole_;
  PairRandom random;
  random[0] = mix64(((static_cast<std::uint64_t>(static_cast<std::uint32_t>(column)) << 32) |
                     static_cast<std::uint32_t>(row)) ^
                    mix64(plan_.settings->seed));
  for (std::size_t word = 1; word < kRowWords; ++word) random[word] = mix64(random[0] + word);
  type_ = type;
  add_pair(column, row, plan_.levels.front(), kAllReplicates, random);
}

template <class Real>
void TileTracer<Real>::generate_queued() {
  if (queued_count_ == 0) return;
  const KernelMicrolens<Real>& lens =
      has_own_lens_ ? own_lens_ : plan_.microlenses[static_cast<std::size_t>(type_)];
  plan_.kernels.generate(patch_, queued_.data(), queued_count_, lens.distance, block_);
  const KernelPixel<Real>& last = queued_[static_cast<std::size_t>(queued_count_ - 1)];
  const int first = queued_.front().first;
  const int count = last.first + last.count - first;
  const bool between = type_ == plan_.between_type;
  if (sink_) sink_->drawn(patch_, between ? -1 : type_, block_, first, count);
  if (between) end_at_microlenses(first, count);
  // Between the lenses only the sensor's cover glass is on the way.
  plan_.optics.pass_microlens(lens, patch_.lens_x, patch_.lens_y, first, count, block_);
  queued_count_ = 0;
}

/// Rays that were drawn as if there were no array: those that meet one of its lenses have ended.
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

template <class Real>
void TileTracer<Real>::integrate(int padded) {
  RayBatch<Real> batch;
  batch.size = padded;
  batch.anchor = plan_.anchor;
  batch.x = block_.x;
  batch.y = block_.y;
  batch.z = block_.z;
  batch.dx = block_.dx;
  batch.dy = block_.dy;
  batch.dz = block_.dz;
  MediumOptions options;
  options.isa = plan_.settings->isa;
  options.skip = plan_.settings->skip;
  RadianceBatch<Real> out;
  out.radiance = radiance_;
  out.stride = kPadding;
  out.transmittance = transmittance_;
  out.transmittance_stride = transmittance_stride_;
  if (surfaces_) batch.t_far = surfaces_->t_far();
  plan_.medium->integrate(batch, options, out, counters_.medium);
  if (surfaces_) surfaces_->add(transmittance_, transmittance_stride_, radiance_, kPadding);
  if (scatter_) add_scattered();
  sum_channels(plan_.scene->mix, radiance_, kPadding, padded);
}

/// What the medium scatters into the rays, one walk for each.
template <class Real>
void TileTracer<Real>::add_scattered() {
  std::vector<ScatterWalk::Start> starts;
  std::vector<std::vector<double>> scattered(static_cast<std::size_t>(plan_.scene->node_count()),
                                             std::vector<double>(static_cast<std::size_t>(count_)));
  for (const RayGroup& group : groups_) {
    const int points = plan_.pools()[static_cast<std::size_t>(group.level)].points();
    for (int i = group.first; i < group.first + group.count; ++i) {
      if (block_.code[i] != 0 || !(block_.weight[i] > 0)) continue;
      const int number = group.offset + i - group.first;
      const auto replicate = static_cast<std::uint64_t>(number / points);
      const auto point = (plan_.first >> group.level) + static_cast<std::uint32_t>(number % points);
      const Vec3 along{static_cast<double>(block_.dx[i]), static_cast<double>(block_.dy[i]),
                       static_cast<double>(block_.dz[i])};
      // Nearly all of a thin medium's, few where most rays are scattered anyway.
      double even = 0;
      const std::size_t nodes = transmittance_stride_ ? scattered.size() : 1;
      for (std::size_t c = 0; c < nodes; ++c) {
        const Real passes = transmittance_[c * static_cast<std::size_t>(transmittance_stride_) +
                                           static_cast<std::size_t>(i)];
        const double through = std::clamp(static_cast<double>(passes), 0.0, 1.0);
        even += through * through / static_cast<double>(nodes);
      }
      starts.push_back(
          {i,
           {plan_.anchor + Vec3{static_cast<double>(block_.x[i]), static_cast<double>(block_.y[i]),
                                static_cast<double>(block_.z[i])},
            normalize(along)},
           mix64(mix64(group.key + kScatterSeed + static_cast<std::uint64_t>(group.level)) ^
                 (replicate << 32 | point)),
           surfaces_ ? surfaces_->end(i) : std::numeric_limits<double>::infinity(),
           even});
    }
  }
  scatter_->add(starts, scattered, counters_.medium);
  for (std::size_t c = 0; c < scattered.size(); ++c)
    for (std::size_t i = 0; i < scattered[c].size(); ++i)
      radiance_[c * static_cast<std::size_t>(kPadding) + i] += static_cast<Real>(scattered[c][i]);
}

/// Of each replicate's points in a pixel the first few, well spread by themselves, correct the
/// table. @return false when there is none, or too few points for it
template <class Real>
bool TileTracer<Real>::integrate_by_table([[maybe_unused]] int padded) {
  if constexpr (std::is_same_v<Real, float>) {
    if (!plan_.table || sink_ || plan_.pools().front().points() < kLeastTablePoints) return false;
    if (!table_worker_) table_worker_ = std::make_unique<RadianceTable::Worker>(*plan_.table);
    const auto set = [&](float* factors, int per_correction) {
      std::fill_n(factors, padded, 0.F);
      for (const RaysOfPixel& pending : pending()) {
        const int points = pending.points;
        const int corrected =
            points < kLeastTablePoints ? points : (points + per_correction - 1) / per_correction;
        const float factor = static_cast<float>(points) / static_cast<float>(corrected);
        for (int i = 0; i < pending.count; ++i)
          if ((pending.offset + i) % points < corrected) factors[pending.first + i] = factor;
      }
    };
    set(transmittance_, kSmoothPoints);  // nobody else asks for it here
    set(fair_factor_, kFairPoints);
    table_worker_->integrate({&block_, padded, transmittance_, fair_factor_, radiance_, kPadding},
                             counters_.medium);
    const RadianceTableCounters& of_worker = table_worker_->counters();
    counters_.table.looked_up = of_worker.looked_up;
    counters_.table.corrected = of_worker.corrected;
    counters_.table.rough = of_worker.rough;
    counters_.table.nodes = of_worker.nodes;
    return true;
  } else {
    return false;
  }
}

/// Makes room for the rays of this pixel, which is the one to be queued afterwards.
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
  auto last = std::chrono::steady_clock::now();
  // Since it was asked before: a clock takes long beside a block of rays.
  const auto lap = [&last] {
    const auto before = std::exchange(last, std::chrono::steady_clock::now());
    return std::chrono::duration<double>(last - before).count();
  };
  plan_.optics.trace_lens(plan_.camera, padded, block_);
  counters_.rays += count_;
  counters_.rays_reached += plan_.optics.count_alive(block_.code, block_.weight, count_);
  counters_.seconds_optics += lap();
  if (surfaces_) {
    surfaces_->trace(block_, groups_, padded, counters_.medium);
    counters_.seconds_surfaces += lap();
  }
  if (!integrate_by_table(padded)) integrate(padded);
  groups_.clear();
  counters_.seconds_medium += lap();
  const auto channels = static_cast<int>(plan_.scene->scene.channels.size());
  for (int channel = 0; channel < channels; ++channel) add_to_film(channel);
  if (sink_)
    for (const RaysOfPixel& rays : pending())
      sink_->finished(rays, radiance_, kPadding, transmittance_);
  pending_count_ = 0;
  doublings_ = 0;
  count_ = 0;
}

/// A table that says too much is corrected by single rays that count for many: the sum over all of
/// them can become negative, which light cannot. What that adds is counted: it bounds the bias.
template <class Real>
double TileTracer<Real>::not_negative(double sum, double scale) {
  RadianceTableCounters& table = counters_.table;
  if (sum < 0) {
    table.clamped += 1;
    table.clamped_sum -= scale * sum;
    sum = 0;
  }
  table.total += scale * sum;
  return sum;
}

/// Of few points: which are how many could not be foretold, if every ray were added on its own.
template <class Real>
void TileTracer<Real>::sum_rays(const Real* radiance) {
  Real* sums = sums_of_rays_[0].data();
  plan_.kernels.multiply(block_.weight, radiance, count_, sums);
  for (std::size_t k = 1; k <= static_cast<std::size_t>(doublings_); ++k) {
    Real* const more = sums_of_rays_[k].data();
    plan_.kernels.add_neighbours(sums, 1 << (k - 1), count_, more);
    sums = more;
  }
}

template <class Real>
void TileTracer<Real>::add_to_film(int channel) {
  const Real* radiance = radiance_ + channel * kPadding;
  const auto replicates = static_cast<std::size_t>(film_.replicates());
  const auto width = static_cast<std::size_t>(tile_.width);
  const std::size_t stride = width * static_cast<std::size_t>(tile_.height);
  const std::vector<int>& place = plan_.scene->film_channel;
  const auto of_film =
      static_cast<std::size_t>(place.empty() ? channel : place[static_cast<std::size_t>(channel)]);
  double* const sums = film_.tile_sums(tile_index_).data() + of_film * replicates * stride;
  sum_rays(radiance);
  for (const RaysOfPixel& pending : pending()) {
    const int points = pending.points;
    const double scale = pending.scale;
    double* const pixel = sums + static_cast<std::size_t>(pending.row - tile_.y) * width +
                          static_cast<std::size_t>(pending.column - tile_.x);
    // Nearly always: all replicates, of 1, 2, 4 or 8 points.
    const bool few = pending.doublings >= 0;
    const Real* const sums_from =
        sums_of_rays_[static_cast<std::size_t>(few ? pending.doublings : 0)].data();
    if (few && pending.count == points * film_.replicates() && !plan_.table) {
      for (std::size_t r = 0; r < replicates; ++r)
        pixel[r * stride] +=
            scale * static_cast<double>(sums_from[pending.first + static_cast<int>(r) * points]);
      continue;
    }
    std::size_t replicate = static_cast<std::size_t>(pending.offset / points);
    int left = points - pending.offset % points;
    for (int i = pending.first; i < pending.first + pending.count; ++replicate, left = points) {
      const int end = std::min(pending.first + pending.count, i + left);
      // Blocks hold all points of a replicate that has few.
      static_assert(kBlockRays % (1 << kMostDoublings) == 0);
      double sum = few ? static_cast<double>(sums_from[i])
                       : plan_.kernels.sum(block_.weight + i, radiance + i, end - i);
      i = end;
      if (plan_.table) sum = not_negative(sum, scale);
      pixel[replicate * stride] += scale * sum;
    }
  }
}

template class TileTracer<float>;
template class TileTracer<double>;

}  // namespace plenoflame
