#include "ray_block_queue.h"

#include <algorithm>

#include "plenoflame/base/error.h"

namespace plenoflame::pipeline {

template <class Real>
RayTable<Real>::RayTable(const RayBlock<Real>& first, std::size_t capacity)
    : tile(first.tile),
      path(first.path),
      anchor(first.rays.anchor),
      pixel(capacity, 2),
      microlens(capacity, 2),
      type(capacity, 1),
      replicate(capacity, 1),
      status(capacity, 1),
      ended_at(capacity, 1),
      etendue(capacity, 1),
      sampled_etendue(capacity, 1),
      origin(capacity, 3),
      direction(capacity, 3),
      t_near(capacity, 1),
      t_far(capacity, 1) {
  if (first.radiance.empty()) return;
  for (std::size_t c = 0; c < first.scene->scene.channels.size(); ++c)
    channels.push_back(static_cast<int>(first.channel_of_scene(c)));
  radiance = GrowingColumn<Real>(capacity, static_cast<int>(channels.size()));
}

template <class Real>
void RayTable<Real>::add(const RayBlock<Real>& block) {
  rays += static_cast<std::size_t>(block.size);
  const RayBatch<Real>& lines = block.rays;
  for (int k = 0; k < block.size; ++k) {
    const auto i = static_cast<std::size_t>(k);
    pixel.push(block.columns[i]);
    pixel.push(block.rows[i]);
    microlens.push(block.lenses[i].q);
    microlens.push(block.lenses[i].r);
    type.push(block.types[i]);
    replicate.push(block.replicates[i]);
    status.push(static_cast<int>(block.status[i].status));
    ended_at.push(block.status[i].surface);
    etendue.push(block.etendue[i]);
    sampled_etendue.push(block.sampled_etendue[i]);
    for (const Real* column : {lines.x, lines.y, lines.z}) origin.push(column[k]);
    for (const Real* column : {lines.dx, lines.dy, lines.dz}) direction.push(column[k]);
    t_near.push(lines.t_near[k]);
    t_far.push(lines.t_far[k]);
    for (std::size_t c = 0; c < channels.size(); ++c)
      radiance.push(block.radiance[c * static_cast<std::size_t>(lines.size) + i]);
  }
}

template <class Real>
RayBlockQueue<Real>::RayBlockQueue(std::shared_ptr<const CompiledScene> scene,
                                   const RenderSettings& settings, int threads,
                                   RayStreamContent content, std::size_t rays_per_table)
    : scene_(std::move(scene)), rays_per_table_(rays_per_table) {
  tracer_ = std::thread([this, settings, threads, content] { trace(settings, threads, content); });
}

template <class Real>
RayBlockQueue<Real>::~RayBlockQueue() {
  {
    const std::lock_guard lock(mutex_);  // who waits must not miss it
    stop_.request_stop();
  }
  changed_.notify_all();
  tracer_.join();
}

template <class Real>
void RayBlockQueue<Real>::trace(const RenderSettings& settings, int threads,
                                RayStreamContent content) {
  Execution execution;
  execution.threads = threads;
  execution.stop = stop_.get_token();
  capacity_ = 2 * static_cast<std::size_t>(execution.thread_count());
  filling_.resize(static_cast<std::size_t>(execution.thread_count()));
  std::exception_ptr failure;
  try {
    stream_rays<Real>(
        *scene_, settings, execution,
        [this](const RayBlock<Real>& block, int worker) { take(block, worker); }, content);
    for (std::optional<RayTable<Real>>& table : filling_) push(table);
  } catch (const Cancelled&) {
  } catch (...) {
    failure = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  failure_ = failure;
  ended_ = true;
  changed_.notify_all();
}

template <class Real>
void RayBlockQueue<Real>::take(const RayBlock<Real>& block, int worker) {
  std::optional<RayTable<Real>>& table = filling_[static_cast<std::size_t>(worker)];
  if (table && (!table->is_of(block) ||
                table->rays + static_cast<std::size_t>(block.size) > rays_per_table_))
    push(table);
  // A block may be larger than a table is to be.
  if (!table) table.emplace(block, std::max(rays_per_table_, static_cast<std::size_t>(block.size)));
  table->add(block);
}

template <class Real>
void RayBlockQueue<Real>::push(std::optional<RayTable<Real>>& table) {
  if (!table) return;
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return ready_.size() < capacity_ || stop_.stop_requested(); });
  if (stop_.stop_requested()) throw Cancelled();
  ready_.push_back(std::move(*table));
  table.reset();
  changed_.notify_all();
}

template <class Real>
std::optional<RayTable<Real>> RayBlockQueue<Real>::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return !ready_.empty() || ended_; });
  if (ready_.empty()) {
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    return std::nullopt;
  }
  std::optional<RayTable<Real>> table(std::move(ready_.front()));
  ready_.pop_front();
  changed_.notify_all();
  return table;
}

template <class Real>
bool RayBlockQueue<Real>::is_ready() {
  const std::lock_guard lock(mutex_);
  return !ready_.empty() || ended_;
}

template struct RayTable<float>;
template struct RayTable<double>;
template class RayBlockQueue<float>;
template class RayBlockQueue<double>;

}  // namespace plenoflame::pipeline
