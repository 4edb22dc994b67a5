#pragma once
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "plenoflame/render/ray_stream.h"

namespace plenoflame::pipeline {

/// A column that is filled row by row and whose memory can be given away.
template <class T>
class GrowingColumn {
 public:
  GrowingColumn() = default;
  GrowingColumn(std::size_t capacity, int components)
      : components_(components), values_(new T[capacity * static_cast<std::size_t>(components)]) {}
  void push(T value) { values_[count_++] = value; }
  int components() const { return components_; }
  std::size_t rows() const { return count_ / static_cast<std::size_t>(components_); }
  /// Memory for delete[].
  T* release() { return values_.release(); }

 private:
  int components_ = 1;
  std::size_t count_ = 0;
  std::unique_ptr<T[]> values_;
};

/// Rays of one tile and one path through the camera, in their order.
template <class Real>
struct RayTable {
  RayTable(const RayBlock<Real>& first, std::size_t capacity);
  bool is_of(const RayBlock<Real>& block) const { return tile == block.tile && path == block.path; }
  void add(const RayBlock<Real>& block);

  int tile, path;
  Vec3 anchor;
  std::vector<int> channels;  ///< of the scene that `radiance` has; empty: no radiance
  std::size_t rays = 0;
  GrowingColumn<int> pixel, microlens, type, replicate, status, ended_at;
  GrowingColumn<Real> etendue, sampled_etendue, origin, direction, t_near, t_far, radiance;
};

/// Traces on threads of its own and keeps a few tables ahead of who takes them.
template <class Real>
class RayBlockQueue {
 public:
  RayBlockQueue(std::shared_ptr<const CompiledScene> scene, const RenderSettings& settings,
                int threads, RayStreamContent content, std::size_t rays_per_table);
  ~RayBlockQueue();
  RayBlockQueue(const RayBlockQueue&) = delete;
  RayBlockQueue& operator=(const RayBlockQueue&) = delete;

  /// Waits for the next table; none at the end. @throws what stream_rays() throws
  std::optional<RayTable<Real>> next();
  /// True if next() would not have to wait.
  bool is_ready();

 private:
  void trace(const RenderSettings& settings, int threads, RayStreamContent content);
  void take(const RayBlock<Real>& block, int worker);
  void push(std::optional<RayTable<Real>>& table);

  std::shared_ptr<const CompiledScene> scene_;
  std::size_t rays_per_table_, capacity_ = 0;
  std::vector<std::optional<RayTable<Real>>> filling_;  ///< of each worker
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<RayTable<Real>> ready_;
  bool ended_ = false;
  std::exception_ptr failure_;
  std::stop_source stop_;
  std::thread tracer_;
};

}  // namespace plenoflame::pipeline
