#include "render/backward_tile.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace plenoflame {
namespace {

constexpr int kLeastTablePoints = 8;  ///< of a replicate: with fewer every ray is integrated
/// Of so many points one corrects the table, where it is smooth and where it is fair.
constexpr int kSmoothPoints = 16, kFairPoints = 4;
constexpr int kPadding = kBlockRays + 2 * kBlockSlack;  ///< of each array of the block

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

template <class Real>
TileTracer<Real>::TileTracer(const BackwardPlan<Real>& plan, Film& film)
    : plan_(plan), film_(film) {
  const auto channels = static_cast<std::size_t>(film.channels());
  constexpr std::size_t alignment = 64 / sizeof(Real);
  storage_.resize((9 + channels) * kPadding + alignment);
  codes_.resize(kPadding);
  Real* base = storage_.data();
  while (reinterpret_cast<std::uintptr_t>(base) % 64 != 0) ++base;
  Real** arrays[] = {&block_.x,  &block_.y,  &block_.z,     &block_.dx,
                     &block_.dy, &block_.dz, &block_.weight};
  for (Real** array : arrays) {
    *array = base;
    base += kPadding;
  }
  transmittance_ = base;
  fair_factor_ = base + kPadding;
  radiance_ = base + 2 * kPadding;
  block_.code = codes_.data();
}

template <class Real>
void TileTracer<Real>::render(PixelWindow tile) {
  const Camera& camera = plan_.scene->camera;
  if (!camera.has_array()) {
    for (int row = tile.y; row < tile.y + tile.height; ++row)
      for (int column = tile.x; column < tile.x + tile.width; ++column) add_bare_pixel(column, row);
  } else {
    // Upright images run against camera x, y.
    const Vec2 a = camera.sensor_point(tile.x + tile.width, tile.y + tile.height);
    const Vec2 b = camera.sensor_point(tile.x, tile.y);
    const Vec2 reach{plan_.reach, plan_.reach};
    for (const LensIndex lens : camera.lattice().within(a - reach, b + reach))
      add_microlens(tile, lens);
  }
  flush();
}

/// @return the unit vector away from the optical axis
template <class Real>
Vec2 TileTracer<Real>::set_discs(const PupilTable& table, const PupilNode& node, Vec2 place) {
  generate_queued();  // what is queued belongs to the patch before
  const double h = length(place);
  const Vec2 field = h > 0 ? (1.0 / h) * place : Vec2{1, 0};
  patch_.field_x = static_cast<Real>(field.x);
  patch_.field_y = static_cast<Real>(field.y);
  patch_.centre = static_cast<Real>(node.centre);
  patch_.centre2 = static_cast<Real>(node.centre2);
  patch_.coma = static_cast<Real>(node.coma);
  for (std::size_t k = 0; k < 3; ++k) {
    patch_.coupling[k] = static_cast<Real>(node.coupling[k]);
    patch_.radius[k] = static_cast<Real>(node.radius[k]);
  }
  patch_.radius_odd = static_cast<Real>(node.radius_odd / node.aim_radius);
  patch_.flattening[0] = static_cast<Real>(node.flattening[0]);
  patch_.flattening[1] = static_cast<Real>(node.flattening[1]);
  const double coupling = node.coupling[0] + node.coupling[1] + node.coupling[2];
  patch_.coupling_sign = coupling < 0 ? Real(-1) : Real(1);
  patch_.aim_radius = static_cast<Real>(node.aim_radius);
  patch_.inverse_aim2 = static_cast<Real>(1.0 / (node.aim_radius * node.aim_radius));
  patch_.aim_x = static_cast<Real>(node.aim_centre * field.x);
  patch_.aim_y = static_cast<Real>(node.aim_centre * field.y);
  patch_.aim_shift = static_cast<Real>(table.aperture_shift);
  patch_.bound_radius = static_cast<Real>(plan_.scene->camera.has_array() ? table.bound_radius
                                                                          : 1e6 * node.aim_radius);
  patch_.cut_margin = static_cast<Real>(table.cut_margin);
  return field;
}

/// @return false when the pixel lies outside of the outer disc
template <class Real>
bool TileTracer<Real>::place_pixel(Vec2 pixel_centre, Vec2 outer_centre, double outer_radius) {
  const double half = 0.5 * plan_.scene->camera.spec().sensor.pixel_pitch;
  const double y0 = pixel_centre.y - half, y1 = pixel_centre.y + half;
  const double miss = std::clamp(outer_centre.y, y0, y1) - outer_centre.y;
  const double reach2 = outer_radius * outer_radius - miss * miss;
  if (!(reach2 > 0)) return false;
  const double reach = std::sqrt(reach2);
  const double x0 = std::max(pixel_centre.x - half, outer_centre.x - reach);
  const double x1 = std::min(pixel_centre.x + half, outer_centre.x + reach);
  if (!(x1 > x0)) return false;
  pixel_.x_low = static_cast<Real>(x0);
  pixel_.x_width = static_cast<Real>(x1 - x0);
  pixel_.y0 = static_cast<Real>(y0);
  pixel_.y1 = static_cast<Real>(y1);
  return true;
}

template <class Real>
void TileTracer<Real>::add_microlens(PixelWindow tile, LensIndex lens) {
  const Camera& camera = plan_.scene->camera;
  const Vec2 place = camera.lattice().centre(lens);
  const int type = camera.lattice().type(lens);
  const PupilTable& table = plan_.scene->pupils.tables()[static_cast<std::size_t>(type)];
  const PupilNode node = table.at(length(place));
  if (node.dark()) return;
  if (plan_.beams && !plan_.beams->may_meet(type, place)) return;
  const Vec2 centre = node.centre * set_discs(table, node, place);
  const double outer = node.outer_radius;
  patch_.outer_x = static_cast<Real>(centre.x);
  patch_.outer_y = static_cast<Real>(centre.y);
  patch_.outer_radius2 = static_cast<Real>(outer * outer);
  patch_.lens_x = static_cast<Real>(place.x);
  patch_.lens_y = static_cast<Real>(place.y);
  const SensorSpec& sensor = camera.spec().sensor;
  const double pitch = sensor.pixel_pitch;
  const double half_diagonal = pitch * std::sqrt(0.5);
  const Vec2 image = place + centre;
  const auto column_of = [&](double x) {
    return static_cast<int>(std::floor(0.5 * sensor.columns - x / pitch));
  };
  const auto row_of = [&](double y) {
    return static_cast<int>(std::floor(0.5 * sensor.rows - y / pitch));
  };
  const int column0 = std::max(tile.x, column_of(image.x + outer));
  const int column1 = std::min(tile.x + tile.width - 1, column_of(image.x - outer));
  const int row0 = std::max(tile.y, row_of(image.y + outer));
  const int row1 = std::min(tile.y + tile.height - 1, row_of(image.y - outer));
  const std::uint64_t key =
      mix64((static_cast<std::uint64_t>(static_cast<std::uint32_t>(lens.q)) << 32 |
             static_cast<std::uint32_t>(lens.r)) ^
            plan_.settings->seed);
  for (int row = row0; row <= row1; ++row)
    for (int column = column0; column <= column1; ++column) {
      const Vec2 at = camera.sensor_point(column + 0.5, row + 0.5) - place;
      if (!place_pixel(at, centre, outer)) continue;
      pixel_.open = length(at - centre) + half_diagonal < node.open_radius;
      const double distance =
          length(at - centre) / outer * (static_cast<double>(node.open.size()) - 1);
      const double open =
          node.open[std::min(static_cast<std::size_t>(distance), node.open.size() - 1)];
      add_pair(type, column, row, key,
               level_of(open * static_cast<double>(pixel_.x_width) / pitch));
    }
}

template <class Real>
void TileTracer<Real>::add_bare_pixel(int column, int row) {
  const Camera& camera = plan_.scene->camera;
  const PupilTable& table = plan_.scene->pupils.tables().front();
  const Vec2 centre = camera.sensor_point(column + 0.5, row + 0.5);
  const PupilNode node = table.at(length(centre));
  if (node.dark()) return;
  if (plan_.beams && !plan_.beams->may_meet(0, centre)) {
    counters_.pixels_skipped += 1;
    return;
  }
  set_discs(table, node, centre);
  const double pitch = camera.spec().sensor.pixel_pitch;
  place_pixel(centre, centre, 2 * pitch);  // nothing cuts the pixel
  patch_.outer_x = static_cast<Real>(centre.x);
  patch_.outer_y = static_cast<Real>(centre.y);
  patch_.outer_radius2 = static_cast<Real>(4 * pitch * pitch);
  patch_.lens_x = patch_.lens_y = 0;
  pixel_.open = true;  // without array the aim disc is the pupil itself
  add_pair(0, column, row, mix64(plan_.settings->seed), 0);
}

template <class Real>
int TileTracer<Real>::level_of(double worth) const {
  // The error is least for a given number of rays when points go as flux^(2 / (1 + 2 a)), where the
  // error falls with points^-a; a is about 3/4.
  const int level = worth > 0 ? static_cast<int>(-0.8 * std::log2(worth)) : 99;
  return std::clamp(level, 0, static_cast<int>(plan_.pools.size()) - 1);
}

template <class Real>
void TileTracer<Real>::add_pair(int type, int column, int row, std::uint64_t key, int level) {
  const SobolPool& pool = plan_.pools[static_cast<std::size_t>(level)];
  const std::uint64_t pixel =
      (static_cast<std::uint64_t>(static_cast<std::uint32_t>(column)) << 32) |
      static_cast<std::uint32_t>(row);
  const std::uint64_t h0 = mix64(pixel ^ key), h1 = mix64(h0), h2 = mix64(h1);
  const int entry = static_cast<int>(h2 % static_cast<std::uint64_t>(pool.entries()));
  pixel_.shift[0] = static_cast<std::uint32_t>(h0);
  pixel_.shift[1] = static_cast<std::uint32_t>(h0 >> 32);
  pixel_.shift[2] = static_cast<std::uint32_t>(h1);
  pixel_.shift[3] = static_cast<std::uint32_t>(h1 >> 32);
  counters_.pairs += 1;
  type_ = type;
  const int total = pool.replicates() * pool.points();
  // A pixel's rays are split only when a block cannot hold them: how they fall into blocks must not
  // depend on the neighbours, or results would depend on the window.
  if (count_ + std::min(total, kBlockRays) > kBlockRays) flush();
  for (int offset = 0; offset < total; offset += kBlockRays) {
    if (offset > 0) flush();
    const int count = std::min(total - offset, kBlockRays);
    for (int d = 0; d < SobolPool::kDimensions; ++d) {
      pixel_.fractions[d] = pool.fractions(entry, d) + offset;
      __builtin_prefetch(pixel_.fractions[d]);
    }
    pixel_.first = count_;
    pixel_.count = count;
    queued_.push_back(pixel_);
    pending_.push_back({column, row, count_, count, offset, level});
    count_ += count;
  }
}

template <class Real>
void TileTracer<Real>::generate_queued() {
  if (queued_.empty()) return;
  if (sink_) {
    // Once without a microlens, for the rays as they are drawn: the same call makes them below.
    KernelMicrolens<Real> none{};
    none.distance = plan_.microlenses[static_cast<std::size_t>(type_)].distance;
    plan_.kernels.generate(patch_, queued_.data(), static_cast<int>(queued_.size()), none, block_);
    const int first = queued_.front().first;
    sink_->drawn(patch_, block_, first, queued_.back().first + queued_.back().count - first);
  }
  plan_.kernels.generate(patch_, queued_.data(), static_cast<int>(queued_.size()),
                         plan_.microlenses[static_cast<std::size_t>(type_)], block_);
  queued_.clear();
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
  plan_.medium->integrate(batch, options, out, counters_.medium);
}

/// Of each replicate's points in a pixel the first few, well spread by themselves, correct the
/// table. @return false when there is none, or too few points for it
template <class Real>
bool TileTracer<Real>::integrate_by_table([[maybe_unused]] int padded) {
  if constexpr (std::is_same_v<Real, float>) {
    if (!plan_.table || sink_ || plan_.pools.front().points() < kLeastTablePoints) return false;
    if (!table_worker_) table_worker_ = std::make_unique<RadianceTable::Worker>(*plan_.table);
    const auto set = [&](float* factors, int per_correction) {
      std::fill_n(factors, padded, 0.F);
      for (const Pending& pending : pending_) {
        const int points = plan_.pools[static_cast<std::size_t>(pending.level)].points();
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
    counters_.table = table_worker_->counters();
    return true;
  } else {
    return false;
  }
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
  auto start = std::chrono::steady_clock::now();
  plan_.kernels.trace_lens(plan_.camera, padded, block_);
  counters_.rays += count_;
  counters_.rays_reached += plan_.kernels.count_alive(block_.code, count_);
  counters_.seconds_optics += seconds_since(start);
  start = std::chrono::steady_clock::now();
  if (!integrate_by_table(padded)) integrate(padded);
  counters_.seconds_medium += seconds_since(start);
  const int all_points = plan_.pools.front().points();
  for (const Pending& pending : pending_) {
    const int points = plan_.pools[static_cast<std::size_t>(pending.level)].points();
    const double scale = static_cast<double>(all_points) / points;
    if (sink_)
      sink_->finished(pending.column, pending.row, pending.first, pending.count, scale, radiance_,
                      kPadding, transmittance_);
    for (int channel = 0; channel < film_.channels(); ++channel) {
      const Real* radiance = radiance_ + channel * kPadding;
      for (int done = 0; done < pending.count;) {
        const int replicate = (pending.offset + done) / points;
        const int end = std::min(pending.count, (replicate + 1) * points - pending.offset);
        const int at = pending.first + done;
        film_.sum(channel, replicate, pending.column, pending.row) +=
            scale * plan_.kernels.accumulate(block_.weight + at, radiance + at, end - done);
        done = end;
      }
    }
  }
  pending_.clear();
  count_ = 0;
}

template class TileTracer<float>;
template class TileTracer<double>;

}  // namespace plenoflame
